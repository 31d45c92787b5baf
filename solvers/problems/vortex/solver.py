"""VortexSolver: one vortex in memory, ready to be stepped, sampled and looked at."""

import numpy as np

from solvers.problems.planar.errors import Fields
from solvers.problems.planar.solver import PlanarSolver
from solvers.problems.vortex.errors import true_fields
from solvers.problems.vortex.field import field
from solvers.problems.vortex.method.body import farthest
from solvers.problems.vortex.scene import VortexScene
from solvers.problems.vortex.state import HOOKS, VortexState, WatchedVortex, allocate
from solvers.problems.vortex.step import KERNELS
from solvers.problems.vortex.step_breakdown import breakdown, carried
from solvers.scene.remedies import FILTER
from solvers.solver.step_breakdown import Carried, StepBreakdown

ENOUGH = 3  # particles per cell and direction, with which GIMP keeps its rim up to A = 1


class VortexSolver(PlanarSolver):
    """Owns the arrays of one vortex."""

    HOOKS, KERNELS, STATE = HOOKS, KERNELS, VortexState
    scene: VortexScene
    _arrays: WatchedVortex

    def _allocate(self, slabs: int) -> WatchedVortex:
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
