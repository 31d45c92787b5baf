"""VortexSolver: one vortex in memory, ready to be stepped, sampled and looked at."""

from dataclasses import dataclass

from solvers.problems.planar.estimators import transport
from solvers.problems.planar.method.body import WatchedBody
from solvers.problems.planar.parts import PlanarParts
from solvers.problems.planar.plans.step import kernels
from solvers.problems.planar.solver import PlanarSolver
from solvers.problems.vortex.estimators import companion, recovered
from solvers.problems.vortex.method.body import VortexBody, body, farthest
from solvers.problems.vortex.method.phases import TRAITS, has_escaped
from solvers.problems.vortex.method.samples import MEASURES
from solvers.problems.vortex.scene import VortexScene
from solvers.problems.vortex.snapshot import SNAPSHOT
from solvers.scene import registry
from solvers.scene.remedies import FILTER

ENOUGH = 3  # particles per cell and direction, with which GIMP keeps its rim up to A = 1


@dataclass
class WatchedVortex(WatchedBody, VortexBody):
    """A vortex and those who watch it."""


HOOKS = registry.hooks_of("vortex", {
    "companion": companion.HOOKS, "recovered": recovered.HOOKS, "transport": transport.hooks(TRAITS)})


class VortexSolver(PlanarSolver):
    """Owns the arrays of one vortex."""

    HOOKS = HOOKS
    PARTS = PlanarParts(HOOKS, WatchedVortex, body, farthest, TRAITS, MEASURES, SNAPSHOT, has_escaped)
    KERNELS = kernels(PARTS)
    scene: VortexScene

    def _escape(self) -> str:
        return f"was thrown off (it is {farthest(self.scene):.3g} m or more from the centre, at an edge of the grid)"

    def _other_advice(self) -> str:
        scene = self.scene
        if scene.method == "mpm":
            return "hat functions do not hold such a shear: choose CPDI"
        if scene.method != "cpdi":
            more = f"give {ENOUGH} or more particles per cell and direction, " * (scene.ppc < ENOUGH)
            filtered = f"call for the remedy {FILTER}, " * (not scene.remedies)
            return f"{more}{filtered}{'or ' * bool(more or filtered)}choose CPDI" \
                + ", or the polar layout" * (scene.layout == "cartesian")
        return "choose more cells, more particles per cell or a smaller amplitude"
