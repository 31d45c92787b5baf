"""The vortex as one object: its scene, and where the rest is, which waits until it is asked for."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from solvers.problems.descriptor import OnDemand
from solvers.problems.manufactured.problem import ManufacturedProblem, Showing
from solvers.problems.vortex.scene import VortexScene

if TYPE_CHECKING:
    from solvers.problems.reference import ProblemReference
    from solvers.solver.base import Solver


class VortexProblem(ManufacturedProblem):
    def __init__(self) -> None:
        super().__init__(VortexScene, Showing(  # type: ignore[arg-type]
            cells=(12, 96, 2), ppc=(1, 3), amplitude=(0.01, 0.5 * math.pi), modulus=(100.0, 10_000.0),
            amplitude_hint="angle in radians by which the middle circle turns against the rims, which rest; the "
                           "largest shear is seven times as much",
            prices={"transport": 0.07, "recovered": 0.24, "companion": 0.05}, speed=(0.01, 0.1, 2.0),
            estimators=("companion", "transport"),  # transport alone would show only an estimate that fails
            details={"layout": "where particles begin: Cartesian rims are staircases",
                     "body_force": "which force acts"},
            modulus_hint="Young's modulus: the body force sees to it that the motion stays the same, the errors do not",
            poisson_hint="resistance to a change of volume: not in the exact motion, which has none, but in the "
                         "errors and, with the speed of waves, in the time step",
            sparks=("widen", "staircase", "break"),
            breaking=("hat functions bear no shear", {"method": "mpm"}, 0.4)))

    @property
    def solver(self) -> type[Solver]:  # type: ignore[override]
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
