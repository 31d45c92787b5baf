"""A plane problem as one object, from its scene class."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple

from solvers.problems.descriptor import BudgetProvider, Problem
from solvers.problems.planar.scene import PlanarScene

if TYPE_CHECKING:
    from solvers.problems.judging_reference import JudgingReference
    from solvers.problems.planar.solver import PlanarSolver


class ViewSettings(NamedTuple):
    """Display of a problem on the page: the ranges of its sliders, (low, high, step) or (low, high), and their hints.

    ``prices`` are each estimator's share of the running time, alone on one thread; ``speed`` is the first one in
    periods a second; ``details`` fields of the method, each with its hint; ``sparks`` names of suggested experiments
    (``app/problems/planar_suggested_experiments.py``); ``breaking`` a run that will not last: a hint, other fields of
    its scene, and how many periods it may hold.
    """

    cells: tuple[int, int, int]
    ppc: tuple[int, int]
    amplitude: tuple[float, float]
    modulus: tuple[float, float]
    amplitude_hint: str
    prices: Mapping[str, float]
    speed: float = 0.2
    details: Mapping[str, str] = MappingProxyType({"body_force": "whether the force acts"})
    modulus_hint: str = "Young's modulus: a stiffer body vibrates faster"
    poisson_hint: str = "resistance to a change of volume"
    sparks: tuple[str, ...] = ("halve", "tile", "break")
    breaking: tuple[str, Mapping[str, Any], float] = ("hat functions", MappingProxyType({"method": "mpm"}), 1.0)


class PlanarProblem(Problem):
    """A plane problem, from its scene class and how the page shows it; other parts are imported on first use."""

    scene: type[PlanarScene]

    def __init__(self, scene: type[PlanarScene], showing: ViewSettings):
        self.scene, self.showing = scene, showing

    @property
    def solver(self) -> type[PlanarSolver]:
        from solvers.problems.planar.solver import make_solver_class

        return make_solver_class(self.scene)

    @property
    def reference(self) -> JudgingReference:
        from solvers.problems.planar.judging_reference import PlanarJudgingReference

        return PlanarJudgingReference(self.scene)

    @property
    def budget(self) -> BudgetProvider:
        from solvers.problems.planar.budget.on_demand_budget import PlanarBudget

        return PlanarBudget(self.solver)
