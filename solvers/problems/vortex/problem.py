"""The vortex as one object: its scene, and where the rest is, which waits until it is asked for."""

from __future__ import annotations

from typing import TYPE_CHECKING

from solvers.problems.descriptor import OnDemand, Problem
from solvers.problems.vortex.scene import VortexScene

if TYPE_CHECKING:
    from solvers.problems.reference import ProblemReference
    from solvers.solver.base import Solver


class VortexProblem(Problem):
    scene = VortexScene

    @property
    def solver(self) -> type[Solver]:
        from solvers.problems.vortex.solver import VortexSolver

        return VortexSolver

    @property
    def baseline(self) -> type[Solver]:
        from solvers.problems.planar.baseline import baseline

        return baseline(self.solver, "lame_modulus", "volumetric", "polar_force")

    @property
    def reference(self) -> ProblemReference:
        from solvers.problems.vortex.reference import REFERENCE

        return REFERENCE

    @property
    def budget(self) -> OnDemand:
        from solvers.problems.planar.budget.on_demand import PlanarBudget
        from solvers.problems.vortex.exact import moment
        from solvers.problems.vortex.solver import VortexSolver

        return PlanarBudget(VortexSolver, moment)
