"""The interface of a problem for the page and the pictures."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from app.frame.planar_stage import PlanarStage
from app.frame.slow_motion.stage import SlowMotionStage
from app.frame.stage import Stage
from app.language.translation import lazy, localised_path
from app.problems.suggested_experiment import SuggestedExperiment
from app.shareable_state import State


@dataclass(frozen=True)
class SliderRanges:
    """Ranges of a problem's sliders: of ``cells`` along a side (low, high, step), of particles per cell in a direction
    (low, high), and of logarithmic ones (low, high): amplitude in m, modulus in Pa. Some ranges exceed what
    is valid; the page then shows the instructive reason."""

    cells: tuple[int, int, int]
    ppc: tuple[int, int]
    amplitude: tuple[float, float]
    modulus: tuple[float, float]


#: (label, low, high, step, hint) of a linear slider.
LinearSlider = tuple[str, float, float, float, str]


@dataclass(frozen=True)
class BodyRegions:
    """Regions into which a body's material is divided: their translated ``names``, and for each particle the ``number``
    (P,) of the region, an index into the names, in which it was at rest."""

    names: tuple[str, ...]
    number: np.ndarray

    def rms_errors(self, sizes: np.ndarray) -> np.ndarray:
        """Returns the root mean square of errors of the sizes (P,) in each region, (regions,); NaN for empty ones."""
        with np.errstate(all="ignore"):  # a region may be empty, and a run gone bad holds anything
            squares = np.bincount(self.number, sizes.astype(float) ** 2, len(self.names))
            return np.sqrt(squares / np.bincount(self.number, minlength=len(self.names)))


@dataclass(frozen=True)
class MotionSelector:
    """Choice of a problem's motion: ``hint`` is the widget's; ``change_motion(scene, motion, usual)`` returns the scene
    with that motion, and the ``usual`` estimators unless the motion restricts them. ``sliders`` are those of fields
    that only a motion without oscillation has; ``speed`` (periods per second) and ``quantity`` (key) are the initial
    ones of such a motion."""

    hint: str
    change_motion: Callable[[Any, str, tuple[str, ...]], Any]
    sliders: Mapping[str, LinearSlider]
    speed: float
    quantity: str


class PlanarBodyKindView(NamedTuple):
    """View common to all plane problems of one kind of body; :class:`ProblemView` has the details."""

    stage: type[PlanarStage[Any]]
    draw_picture: Callable[..., None]
    regions: Callable[[np.ndarray], BodyRegions]
    division: str
    picture: tuple[float, float]


@dataclass(frozen=True)
class ProblemView:
    """View of the ``problem`` of this name. Its texts are translated where they are used.

    ``stage`` draws its frames, ``slow_motion_stage`` one step in slow motion. ``draw_picture(figure, space, particles,
    result)`` draws a result's field along a line into the axes ``space`` and its particles into the subplot
    ``particles``; it imports the slow matplotlib when called. ``regions`` divides the material by positions at rest
    (P, D) in m, as in ``division``: "the bar into 20 lengths". ``picture`` is the height of a run's picture in inches,
    and its lower row over the upper one. ``speed`` is initial, in periods per second. ``details`` has the hint of each
    scene field among the "Method details", ``material`` the sliders beside the modulus, ``formula`` the name, label and
    hint of a text field; ``motion`` is None if the scene has one motion only.

    ``suggestions`` returns the suggestions for a state of the page. ``prices`` are the estimators' shares of the run
    time in the usual scene, each alone on one thread, as ``mpm-lab run`` reports them (median of three)."""

    problem: str
    stage: type[Stage[Any]]
    slow_motion_stage: type[SlowMotionStage]
    draw_picture: Callable[..., None]
    regions: Callable[[np.ndarray], BodyRegions]
    division: str
    picture: tuple[float, float]
    slider_ranges: SliderRanges
    amplitude_hint: str
    speed: float
    details: Mapping[str, str]
    motion: MotionSelector | None = None
    formula: tuple[str, str, str] | None = None
    modulus_hint: str = lazy("Young's modulus: a stiffer body vibrates faster")
    material: Mapping[str, LinearSlider] = field(default_factory=dict)
    suggestions: Callable[[State], tuple[SuggestedExperiment, ...]] = lambda _: ()
    prices: Mapping[str, float] = field(default_factory=dict)

    @property
    def about(self) -> str:
        """Text in html on the problem's motion, from ``about/PROBLEM.html`` in the visitor's language; "" if none."""
        path = localised_path(Path(__file__).parent / "about" / f"{self.problem}.html")
        return path.read_text(encoding="utf-8") if path.exists() else ""
