"""What a problem is to everybody else, described in its ``problem.py`` by an object of one class."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Protocol

from solvers.scene.scene import Scene

if TYPE_CHECKING:  # solvers bring Taichi, which takes a second
    import numpy as np

    from solvers.problems.reference import ProblemReference
    from solvers.solver.base import Solver


class OnDemand(Protocol):
    """What finds the error budget of a run beside it, where it is no effect."""

    def check(self, scene: Any, take_away: str) -> None:
        """:class:`~solvers.scene.validation.SceneError` where there is none of a scene, or not without that cause."""

    def series(self, scene: Any, steps: np.ndarray, take_away: str,
               on_progress: Callable[[float], None] | None) -> tuple[dict[str, np.ndarray], Solver]:
        """Its samples (``solvers.solver.samples.BUDGET``) after so many ``steps`` (T,), NaN from where the run has gone
        bad, of the run as it is or without a cause; and the solver at the end."""


class Problem(ABC):
    """A problem: its ``scene``, and what else there is of it, imported when it is first asked for: a scene, a flag or a
    list of problems needs no Taichi."""

    scene: type[Scene]

    @property
    @abstractmethod
    def solver(self) -> type[Solver]:
        """What steps a scene."""

    @property
    def baseline(self) -> type[Solver]:
        """A solver whose step has nothing optional in it, to compare rates with."""
        from solvers.solver.baseline import baseline

        return baseline(self.solver)

    @property
    @abstractmethod
    def reference(self) -> ProblemReference:
        """The problem as another code sees it."""

    @property
    def budget(self) -> OnDemand | None:
        """What finds the error budget of a run on demand; None where the effect of that name does, or nothing."""
        return None

    @property
    def estimators(self) -> tuple[str, ...]:
        """The names of the estimators that it has."""
        return self.scene.choices("estimators")

    def predicted_life(self, scene: Any) -> float | None:
        """Periods that a run will hold by theory alone; None where none is known."""
        return None
