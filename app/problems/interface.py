"""What a problem tells the page and the pictures about itself."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import viser

    from app.problems.slow import SlowStage
    from app.problems.stage import Stage


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


@dataclass(frozen=True)
class ProblemView:
    """How one problem is shown.

    ``regions`` divides the material by where particles were at rest (P, D), and ``division`` says how in words: "the
    bar into 20 lengths". ``picture`` is the height of a run's picture in inches, and that of its lower row over the
    upper one. ``speed`` is what the page begins with, in periods a second. ``details`` are the fields of the scene
    among the "Method details", each with its hint. ``domains_hint`` goes with a stage that can outline domains.
    ``motion`` is there where the scene has several motions, ``material`` are fields of the material beside the modulus.
    ``estimators`` are those that the page begins with, the first of them drawn, where they are not the scene's own.
    """

    problem: str
    regions: Callable[[np.ndarray], Regions]
    division: str
    picture: tuple[float, float]
    reach: Reach
    amplitude_hint: str
    speed: float
    details: Mapping[str, str]
    domains_hint: str = ""
    motion: Motion | None = None
    modulus_hint: str = "Young's modulus: what is stiffer vibrates faster"
    material: Mapping[str, LinearSlider] = field(default_factory=dict)
    estimators: tuple[str, ...] = ()

    @property
    def about(self) -> str:
        """Html on what moves: the folder's ``about.html``, if it has one."""
        path = Path(__file__).parent / self.problem / "about.html"
        return path.read_text(encoding="utf-8") if path.exists() else ""

    @property
    def stage(self) -> type[Stage[Any]]:
        """The ``STAGE`` of the folder's ``stage.py``, imported when it is asked for: a picture needs no viewer."""
        return self._module("stage").STAGE

    @property
    def domains(self) -> Callable[[Any, np.ndarray], np.ndarray] | None:
        """Half the edge vectors (P, 2, 2) in metres of the particles' domains for deformation gradients (P, 2, 2), of a
        problem whose stage outlines them: ``domains(scene, F)`` of the folder's ``stage.py``."""
        return self._module("stage").domains if self.domains_hint else None

    @property
    def mirrors(self) -> tuple[tuple[int, int], ...]:
        """Signs of x and y in each image of the body on the stage; of a problem in one dimension none."""
        return getattr(self._module("stage").STAGE, "MIRRORS", ())

    def outermost(self, scene: Any) -> float | None:
        """How far from the middle a particle should come, in metres; of a problem in one dimension None."""
        return self._module("stage").outermost(scene) if self.mirrors else None

    @property
    def slow(self) -> Callable[[viser.ClientHandle], SlowStage]:
        """The ``STAGE`` of the folder's ``slow.py``: one step in slow motion."""
        return self._module("slow").STAGE

    @property
    def draw(self) -> Callable:
        """``draw(figure, space, particles, result)`` of the folder's ``pictures.py``: the error in space into the axes
        ``space``, the particles at the end into the place ``particles``. Matplotlib takes long to import."""
        return self._module("pictures").draw

    def _module(self, name: str) -> Any:
        return importlib.import_module(f"app.problems.{self.problem}.{name}")
