"""What a problem tells the page and the pictures about itself."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from app.frame.planar import PlanarStage
from app.frame.slow_motion.stage import SlowStage
from app.frame.stage import Stage
from app.language.translation import lazy, localised_path
from app.problems.suggestion import Suggestion
from app.state import State


@dataclass(frozen=True)
class Reach:
    """Ends of a problem's sliders: whole numbers (low, high, step), and (low, high) of those whose steps are factors.

    The speed is in periods a second. Some reach beyond what a scene can be: the page then says why not, and that is
    worth reading.
    """

    cells: tuple[int, int, int]
    ppc: tuple[int, int]
    amplitude: tuple[float, float]
    modulus: tuple[float, float]
    speed: tuple[float, float]


#: (label, low, high, step, hint) of a slider whose steps are even.
LinearSlider = tuple[str, float, float, float, str]


@dataclass(frozen=True)
class Regions:
    """``names`` of the regions, and for each of P particles the ``number`` of the one where it was at rest."""

    names: tuple[str, ...]
    number: np.ndarray

    def errors(self, sizes: np.ndarray) -> np.ndarray:
        """The root of the mean square of sizes (P,) in each region; NaN where there is no particle."""
        with np.errstate(all="ignore"):  # a region may be empty, and a run gone bad holds anything
            squares = np.bincount(self.number, sizes.astype(float) ** 2, len(self.names))
            return np.sqrt(squares / np.bincount(self.number, minlength=len(self.names)))


@dataclass(frozen=True)
class Motion:
    """How the page lets one choose what a problem does: ``hint`` of the choice, and ``change(scene, motion, usual)``,
    the scene in which that happens, with the ``usual`` estimators where its own would say nothing. ``sliders`` are the
    fields that only a motion without swings has; ``speed`` and ``quantity`` is what such a motion begins with."""

    hint: str
    change: Callable[[Any, str, tuple[str, ...]], Any]
    sliders: Mapping[str, LinearSlider]
    speed: float
    quantity: str


class Body(NamedTuple):
    """How all plane problems of one kind of body are shown; what each is says :class:`ProblemView`."""

    stage: type[PlanarStage[Any]]
    draw: Callable[..., None]
    regions: Callable[[np.ndarray], Regions]
    division: str
    picture: tuple[float, float]


@dataclass(frozen=True)
class ProblemView:
    """How one problem is shown. Its words are put into the visitor's language where they are said.

    ``stage`` makes marks of its frames, ``slow`` of one step in slow motion. ``draw(figure, space, particles, result)``
    draws a run's error in space into the axes ``space`` and the particles at its end into the place ``particles``; it
    imports matplotlib, which takes long, when it is called. ``regions`` divides the material by where particles were at
    rest (P, D), and ``division`` says how in words: "the bar into 20 lengths". ``picture`` is the height of a run's
    picture in inches, and that of its lower row over the upper one. ``speed`` is what the page begins with, in periods
    a second. ``details`` are the fields of the scene among the "Method details", each with its hint. ``motion`` is
    there where the scene has several motions, ``material`` are fields of the material beside the modulus;
    ``formula`` is a field that is typed, with a label and a hint.
    ``estimators`` are those that the page begins with, the first of them drawn, where they are not the scene's own.
    ``sparks`` are the questions that go with a state (:mod:`app.problems.suggestion`).
    ``prices`` are the shares of the running time that estimators take in the problem's usual scene, each alone on one
    thread, as ``mpm-lab run`` says them (median of three).
    """

    problem: str
    stage: type[Stage[Any]]
    slow: type[SlowStage]
    draw: Callable[..., None]
    regions: Callable[[np.ndarray], Regions]
    division: str
    picture: tuple[float, float]
    reach: Reach
    amplitude_hint: str
    speed: float
    details: Mapping[str, str]
    motion: Motion | None = None
    formula: tuple[str, str, str] | None = None
    modulus_hint: str = lazy("Young's modulus: a stiffer body vibrates faster")
    material: Mapping[str, LinearSlider] = field(default_factory=dict)
    estimators: tuple[str, ...] = ()
    sparks: Callable[[State], tuple[Suggestion, ...]] = lambda _: ()
    prices: Mapping[str, float] = field(default_factory=dict)

    @property
    def about(self) -> str:
        """Html on what moves: ``about/PROBLEM.html``, if there is one."""
        path = localised_path(Path(__file__).parent / "about" / f"{self.problem}.html")
        return path.read_text(encoding="utf-8") if path.exists() else ""
