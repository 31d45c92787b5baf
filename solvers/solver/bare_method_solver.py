"""A step without anything optional, as a baseline for speed.

The bare phases of the method: all effects off, no memory of estimators, no samples; only the check for an unstable run
remains, which is no effect. The benchmark compares the solver with it, and a test checks that they agree.
"""

import functools
from typing import Any

import taichi as ti

from solvers.scene.kernel_options import method_options
from solvers.scene.scene import Scene
from solvers.solver.base import SOUND, Solver
from solvers.solver.serial_stepping import CHECK_EVERY
from solvers.solver.state_arrays import DiagnosticsState


@functools.cache
def bare_method_solver_class(Own: type[Solver]) -> type[Solver]:
    """Returns a subclass of a problem's solver class ``Own`` with the baseline step; its rows of samples are empty."""
    phases, watching = Own.PHASES, DiagnosticsState.types().keys() - {"farthest", "verdict"}
    types = {name: kind for name, kind in Own.STATE.types().items() if name not in watching}
    State = ti.types.argpack(**types)

    @ti.kernel
    def advance(start: ti.i32, steps: ti.i32, state: State, on: ti.template()):
        ti.loop_config(serialize=True)
        for k in range(steps):
            if state.verdict[0] == SOUND:
                step = start + k + 1
                phases.one_step(state, step, on)
                if step % CHECK_EVERY == 0:
                    phases.check(state, step)

    class Baseline(Own):
        def _start(self, scene: Scene) -> None:
            super()._start(scene)
            self._baseline: Any = State(**{name: self._stepping.pack[name] for name in types})

        def _run(self, steps: int) -> None:
            advance(self.step, steps, self._baseline, method_options(self._switches))

    return Baseline
