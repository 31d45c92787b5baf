"""What a problem is to everybody else, described in its ``problem.py`` by an object of one class."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any

from solvers.scene.scene import Scene

if TYPE_CHECKING:  # solvers bring Taichi, which takes a second
    from solvers.problems.reference import ProblemReference
    from solvers.solver.base import Solver


class Problem(ABC):
    """A problem: its ``scene``, and what else there is of it, imported when it is first asked for: a scene, a flag or a
    list of problems needs no Taichi."""

    scene: type[Scene]

    @property
    @abstractmethod
    def solver(self) -> type[Solver]:
        """What steps a scene."""

    @property
    @abstractmethod
    def baseline(self) -> type[Solver]:
        """A solver whose step has nothing optional in it, written out by hand, to compare rates with."""

    @property
    @abstractmethod
    def reference(self) -> ProblemReference:
        """The problem as another code sees it."""

    @property
    def estimators(self) -> tuple[str, ...]:
        """The names of the estimators that it has."""
        return self.scene.choices("estimators")

    def predicted_life(self, scene: Any) -> float | None:
        """Periods that a run will hold by theory alone; None where none is known."""
        return None
