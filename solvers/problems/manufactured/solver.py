"""ManufacturedSolver: the solver of every manufactured problem between the same symmetry planes."""

import functools
from dataclasses import dataclass

from solvers.problems.manufactured.method.body import ManufacturedBody, body, farthest
from solvers.problems.manufactured.method.measures import kernels_between
from solvers.problems.manufactured.scene import ManufacturedScene
from solvers.problems.manufactured.snapshot import SNAPSHOT
from solvers.problems.planar.estimators import companion, transport
from solvers.problems.planar.method.body import WatchedBody
from solvers.problems.planar.parts import PlanarParts
from solvers.problems.planar.plans.step import kernels
from solvers.problems.planar.solver import PlanarSolver
from solvers.scene import registry


@dataclass
class WatchedManufactured(WatchedBody, ManufacturedBody):
    """A manufactured body and those who watch it."""


class ManufacturedSolver(PlanarSolver):
    """Owns the arrays of one body; :func:`solver_of` makes the class of a problem."""

    scene: ManufacturedScene

    def _escape(self) -> str:
        return "left the square (it is a cell or more beyond a plane)"

    def _other_advice(self) -> str:
        if self.scene.method == "mpm":
            return "hat functions do not hold such a motion: choose CPDI"
        return "choose more particles per cell, a smaller amplitude or fewer periods"


@functools.cache
def solver_of(kind: type[ManufacturedScene]) -> type[ManufacturedSolver]:
    """The solver of a problem by its scene."""
    made = kernels_between(kind.problem, *kind.PLANES)
    hooks = registry.hooks_of(kind.problem, {"companion": companion.HOOKS, "transport": transport.hooks(made.traits)})
    parts = PlanarParts(hooks, WatchedManufactured, body, farthest, made.traits, made.measures, SNAPSHOT,
                        made.has_escaped)
    return type("ManufacturedSolver", (ManufacturedSolver,),
                {"HOOKS": hooks, "PARTS": parts, "KERNELS": kernels(parts)})
