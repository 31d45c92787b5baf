"""Descriptor of a problem, the object in its ``problem.py`` through which all other code uses it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Protocol

from solvers.scene.scene import Scene

if TYPE_CHECKING:  # solvers bring Taichi, which takes a second
    import numpy as np

    from solvers.problems.judging_reference import JudgingReference
    from solvers.solver.base import Solver


class BudgetProvider(Protocol):
    """Provider of a problem's error budget (the error split by causes) on demand, where it is no diagnostic of runs."""

    def require_budget(self, scene: Any, take_away: str) -> None:
        """Raises ``solvers.scene.validation.SceneError`` where a scene has no budget, or where the cause ``take_away``
        ("" for none) cannot be removed from its run."""

    def budget_series(self, scene: Any, steps: np.ndarray, take_away: str,
                      on_progress: Callable[[float], None] | None) -> tuple[dict[str, np.ndarray], Solver]:
        """Returns the budget's samples (T,) by key (``solvers.solver.samples.BUDGET``) after the numbers of ``steps``
        (T,), NaN once the run is unstable, without the cause ``take_away`` ("": the run as it is); and the solver at
        the end. ``on_progress`` is called with the part done, 0 to 1."""


class Problem(ABC):
    """A problem: its ``scene`` class, and its other parts, which are imported on first use because a scene, a flag or a
    list of problems needs no Taichi."""

    scene: type[Scene]

    @property
    @abstractmethod
    def solver(self) -> type[Solver]:
        """Class of the solver that runs the problem's scenes."""

    @property
    def baseline(self) -> type[Solver]:
        """Class of a solver whose step has no diagnostics, estimators or stabilisations, to compare speed with."""
        from solvers.solver.bare_method_solver import bare_method_solver_class

        return bare_method_solver_class(self.solver)

    @property
    @abstractmethod
    def reference(self) -> JudgingReference:
        """Description of the problem for other codes: particles, texts, exact values."""

    @property
    def budget(self) -> BudgetProvider | None:
        """Provider of error budgets on demand; None where the diagnostic ``budget`` of a run exists, or neither."""
        return None

    @property
    def estimators(self) -> tuple[str, ...]:
        """Names of the problem's estimators."""
        return self.scene.choices("estimators")

    def predicted_life(self, scene: Any) -> float | None:
        """Returns the periods that a run of the scene will last by theory alone; None where unknown."""
        return None
