"""State of the bar: its body and its diagnostics."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import taichi as ti

from solvers.estimators.estimator_arrays import packing
from solvers.problems.bar.budget.budget_arrays import BUDGET, initial_budget_arrays
from solvers.problems.bar.estimators import companion, recovered, transport, two_grid
from solvers.problems.bar.method.body import BarBody, initial_body
from solvers.problems.bar.scene import BarScene
from solvers.scene import estimator_registry
from solvers.scene.kernel_options import KernelOptions
from solvers.solver.state_arrays import DiagnosticsState, initial_diagnostics

#: What the solver calls of each estimator that the bar has, by name.
HOOKS = estimator_registry.hooks_of("bar", {"companion": companion.HOOKS, "recovered": recovered.HOOKS,
                                            "transport": transport.HOOKS, "two-grid": two_grid.HOOKS})


@dataclass
class InstrumentedBar(DiagnosticsState, BarBody):
    """State of a run of the bar: the members of its body (the method) and of its diagnostics, in SI."""

    @property
    def cause_errors(self) -> np.ndarray:
        """Errors of x (m), v (m/s) and F of P particles by cause (3, P, causes), a view; needs the effect
        ``budget``."""
        return BUDGET.unpack(self.memory)["cause_errors"][:3 * self.particles].reshape(3, self.particles, -1)


#: Numbers and arrays as one kernel argument: nothing of a scene is baked into compiled code but its switches.
BarState = ti.types.argpack(**InstrumentedBar.types(), **packing(HOOKS).types, **BUDGET.types)


def initial_state(scene: BarScene, on: KernelOptions) -> dict[str, Any]:
    """Returns the members of an :class:`InstrumentedBar` by name before the first step of a scene's run. ``on``:
    compile-time options."""
    watched = initial_diagnostics(scene, on, scene.particles, escape_distance(scene), HOOKS)
    watched["memory"] |= initial_budget_arrays(scene, on)
    return {**initial_body(scene, on), **watched}


def escape_distance(scene: BarScene) -> float:
    """Returns the displacement in m from which on a run is unstable: half the bar, or twenty times the exact one."""
    return min(0.5, 20 * scene.motion_amplitude)
