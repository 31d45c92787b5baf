"""The ring as one object: its scene, and where the rest is, which waits until it is asked for."""

from __future__ import annotations

from typing import TYPE_CHECKING

from solvers.problems.descriptor import OnDemand, Problem
from solvers.problems.ring.scene import RingScene

if TYPE_CHECKING:
    from solvers.problems.reference import ProblemReference
    from solvers.solver.base import Solver


class RingProblem(Problem):
    scene = RingScene

    @property
    def solver(self) -> type[Solver]:
        from solvers.problems.ring.solver import RingSolver

        return RingSolver

    @property
    def baseline(self) -> type[Solver]:
        from solvers.problems.planar.baseline import baseline

        return baseline(self.solver, "material_position", "farthest_move", "radial_force")

    @property
    def reference(self) -> ProblemReference:
        from solvers.problems.ring.reference import REFERENCE

        return REFERENCE

    @property
    def budget(self) -> OnDemand:
        from solvers.problems.planar.budget.on_demand import PlanarBudget
        from solvers.problems.ring.exact import moment
        from solvers.problems.ring.solver import RingSolver

        return PlanarBudget(RingSolver, moment)
