"""RingSolver: one ring in memory, ready to be stepped, sampled and looked at."""

import numpy as np

from solvers.problems.planar.errors import Fields
from solvers.problems.planar.solver import PlanarSolver
from solvers.problems.ring.errors import true_fields
from solvers.problems.ring.field import field
from solvers.problems.ring.method.body import FARTHEST_MOVE, farthest
from solvers.problems.ring.scene import RESONANCE, RingScene
from solvers.problems.ring.state import HOOKS, RingState, WatchedRing, allocate
from solvers.problems.ring.step import KERNELS
from solvers.problems.ring.step_breakdown import breakdown, carried
from solvers.scene.remedies import COUPLED, FILTER, FROZEN
from solvers.solver.step_breakdown import Carried, StepBreakdown


class RingSolver(PlanarSolver):
    """Owns the arrays of one ring."""

    HOOKS, KERNELS, STATE = HOOKS, KERNELS, RingState
    scene: RingScene
    _arrays: WatchedRing

    def _allocate(self, slabs: int) -> WatchedRing:
        return allocate(self.scene, slabs)

    def _true_fields(self) -> Fields:
        return true_fields(self.scene, self._arrays, self.step, self._switches.acceleration)

    def _field(self, quantity: str) -> np.ndarray:
        return field(self.scene, self._arrays, quantity, self.time)

    def _carried_now(self) -> Carried:
        return carried(self._arrays)

    def _break_down_now(self, particle: int, before: Carried) -> StepBreakdown:
        return breakdown(self.scene, self._arrays, particle, self.step, before)

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
