"""The bar as one object: its scene, and its other parts, which are imported on first use."""

from __future__ import annotations

from typing import TYPE_CHECKING

from solvers.problems.bar import step_bound
from solvers.problems.bar.scene import BarScene
from solvers.problems.descriptor import Problem

if TYPE_CHECKING:
    from solvers.problems.judging_reference import JudgingReference
    from solvers.solver.base import Solver


class BarProblem(Problem):
    """Descriptor of the vibrating bar and its patch test: scene, solver, reference and predicted life."""

    scene = BarScene

    @property
    def solver(self) -> type[Solver]:
        from solvers.problems.bar.solver import BarSolver

        return BarSolver

    @property
    def reference(self) -> JudgingReference:
        from solvers.problems.bar.judging_reference import REFERENCE

        return REFERENCE

    def predicted_life(self, scene: BarScene) -> float | None:
        return step_bound.predicted_life_in_periods(scene)
