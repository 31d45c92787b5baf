"""Descriptor of a problem, the object in its ``problem.py`` through which all other code uses it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Protocol

from solvers.scene.scene import Scene

if TYPE_CHECKING:  # solvers bring Taichi, which takes a second
    import numpy as np

    from solvers.problems.reference import ProblemReference
    from solvers.solver.base import Solver


class BudgetProvider(Protocol):
    """Provider of a problem's error budget on demand, where it is not an effect."""

    def require_budget(self, scene: Any, take_away: str) -> None:
        """Raises ``solvers.scene.validation.SceneError`` where a scene has no budget, or none without this cause."""

    def budget_series(self, scene: Any, steps: np.ndarray, take_away: str,
                      on_progress: Callable[[float], None] | None) -> tuple[dict[str, np.ndarray], Solver]:
        """Returns the budget's samples (``solvers.solver.samples.BUDGET``) after the ``steps`` (T,), NaN once the run
        is unstable, for the run as it is or without a cause; and the solver at the end."""


class Problem(ABC):
    """A problem: its ``scene``, and its other parts, which are imported on first use because a scene, a flag or a list
    of problems needs no Taichi."""

    scene: type[Scene]

    @property
    @abstractmethod
    def solver(self) -> type[Solver]:
        """Class of the solver of its scenes."""

    @property
    def baseline(self) -> type[Solver]:
        """Class of a solver whose step has nothing optional, to compare speed with."""
        from solvers.solver.bare_method_solver import bare_method_solver_class

        return bare_method_solver_class(self.solver)

    @property
    @abstractmethod
    def reference(self) -> ProblemReference:
        """Reference of the problem for other codes."""

    @property
    def budget(self) -> BudgetProvider | None:
        """Provider of error budgets on demand; None where the effect ``budget`` exists, or neither."""
        return None

    @property
    def estimators(self) -> tuple[str, ...]:
        """Names of its estimators."""
        return self.scene.choices("estimators")

    def predicted_life(self, scene: Any) -> float | None:
        """Returns the periods that a run will last by theory alone; None where unknown."""
        return None
