"""RingSolver: one ring in memory, ready to be stepped, sampled and looked at."""

from dataclasses import dataclass

from solvers.problems.planar.estimators import transport
from solvers.problems.planar.method.body import WatchedBody
from solvers.problems.planar.parts import PlanarParts
from solvers.problems.planar.plans.step import kernels
from solvers.problems.planar.solver import PlanarSolver
from solvers.problems.ring.estimators import companion, recovered, two_grid
from solvers.problems.ring.method.body import FARTHEST_MOVE, RingBody, body, farthest
from solvers.problems.ring.method.phases import TRAITS, has_escaped
from solvers.problems.ring.method.samples import MEASURES
from solvers.problems.ring.scene import RESONANCE, RingScene
from solvers.problems.ring.snapshot import SNAPSHOT
from solvers.scene import registry
from solvers.scene.remedies import COUPLED, FILTER, FROZEN


@dataclass
class WatchedRing(WatchedBody, RingBody):
    """A ring and those who watch it."""


HOOKS = registry.hooks_of("ring", {
    "companion": companion.HOOKS, "recovered": recovered.HOOKS, "transport": transport.hooks(TRAITS),
    "two-grid": two_grid.HOOKS})


class RingSolver(PlanarSolver):
    """Owns the arrays of one ring."""

    HOOKS = HOOKS
    PARTS = PlanarParts(HOOKS, WatchedRing, body, farthest, TRAITS, MEASURES, SNAPSHOT, has_escaped)
    KERNELS = kernels(PARTS)
    scene: RingScene

    def _escape(self) -> str:
        return (f"left the ring's place (it is {farthest(self.scene):.3g} m or more from the centre, beyond a plane, "
                f"or {FARTHEST_MOVE:g} amplitudes from where it began)")

    def _other_advice(self) -> str:
        scene = self.scene
        if scene.amplitude >= RESONANCE:
            return (f"from A = {RESONANCE} on the ring's own motion is unstable (parametric resonance) and no remedy "
                    "helps: choose a smaller amplitude or fewer periods")
        if scene.method == "mpm" and not scene.frozen:
            return f"hat functions hold only with the remedy {FROZEN}; or choose CPDI"
        if scene.method != "cpdi" and not scene.remedies:
            return f"call for the remedies {FILTER},{COUPLED}, or choose CPDI"
        return "choose more particles per cell, a smaller amplitude or fewer periods"
