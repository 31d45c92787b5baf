"""A plane problem as one object, from its scene class."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple

from solvers.problems.descriptor import BudgetProvider, Problem
from solvers.problems.planar.scene import PlanarScene

if TYPE_CHECKING:
    from solvers.problems.planar.solver import PlanarSolver
    from solvers.problems.reference import ProblemReference


class ViewSettings(NamedTuple):
    """Display of a problem: the ranges of its sliders (low, high, step) and (low, high), the hint at the amplitude, and
    each estimator's share of the running time in the usual scene, alone on one thread.

    ``speed`` is the lowest, the first and the highest, in periods a second. ``estimators`` are those that the page
    begins with, the first of them drawn. ``details`` are fields of the method, each with its hint. ``sparks`` are the
    questions that the page asks, by name (``app/problems/planar_suggestions.py``); ``breaking`` is the run that will
    not last: a hint, what is otherwise in its scene, and for how many periods it may hold.
    """

    cells: tuple[int, int, int]
    ppc: tuple[int, int]
    amplitude: tuple[float, float]
    modulus: tuple[float, float]
    amplitude_hint: str
    prices: Mapping[str, float]
    speed: tuple[float, float, float] = (0.01, 0.2, 10.0)
    estimators: tuple[str, ...] = ("companion",)
    details: Mapping[str, str] = MappingProxyType({"body_force": "whether the force acts"})
    modulus_hint: str = "Young's modulus: a stiffer body vibrates faster"
    poisson_hint: str = "resistance to a change of volume"
    sparks: tuple[str, ...] = ("halve", "tile", "break")
    breaking: tuple[str, Mapping[str, Any], float] = ("hat functions", MappingProxyType({"method": "mpm"}), 1.0)


class PlanarProblem(Problem):
    """A problem's scene class, and its other parts, which are imported on first use."""

    scene: type[PlanarScene]

    def __init__(self, scene: type[PlanarScene], showing: ViewSettings):
        self.scene, self.showing = scene, showing

    @property
    def solver(self) -> type[PlanarSolver]:
        from solvers.problems.planar.solver import make_solver_class

        return make_solver_class(self.scene)

    @property
    def reference(self) -> ProblemReference:
        from solvers.problems.planar.reference import PlanarReference

        return PlanarReference(self.scene)

    @property
    def budget(self) -> BudgetProvider:
        from solvers.problems.planar.budget.on_demand_budget import PlanarBudget

        return PlanarBudget(self.solver)
