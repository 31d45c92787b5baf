"""The ring as one object: its scene, and where the rest is, which waits until it is asked for."""

from __future__ import annotations

from typing import TYPE_CHECKING

from solvers.problems.descriptor import OnDemand
from solvers.problems.manufactured.problem import ManufacturedProblem, Showing
from solvers.problems.ring.scene import RingScene

if TYPE_CHECKING:
    from solvers.problems.reference import ProblemReference
    from solvers.solver.base import Solver


class RingProblem(ManufacturedProblem):
    def __init__(self) -> None:
        super().__init__(RingScene, Showing(  # type: ignore[arg-type]
            cells=(12, 96, 6), ppc=(1, 6), amplitude=(1e-3, 0.4), modulus=(1e5, 1e8),
            amplitude_hint="largest displacement of the outer rim; from 0.115 m on the motion itself is unstable, "
                           "above 0.198 m a real ring wrinkles, from 0.386 m on the exact one turns inside out",
            prices={"transport": 0.06, "recovered": 0.11, "companion": 0.06, "two-grid": 0.08},
            estimators=("companion",),  # transport says three to twelve times the error here
            details={"layout": "where particles begin: the Cartesian rim is a staircase",
                     "body_force": "where the force is evaluated"},
            sparks=("halve", "transport", "break"),
            breaking=("hat functions, A = 250 mm", {"method": "mpm", "amplitude": 0.25}, 1.2)))

    @property
    def solver(self) -> type[Solver]:  # type: ignore[override]
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
