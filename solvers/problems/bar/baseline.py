"""The bar's step with nothing optional in it.

The phases of the method by themselves, with every effect off, without the hooks and the memory of estimators, without
samples; the look for a run gone bad stays, for that is no effect. The bench measures the solver against it, and a test
that both give the same numbers.
"""

import taichi as ti

from solvers.problems.bar.method.phases import nodes_to_particles, update_grid
from solvers.problems.bar.solver import BarSolver
from solvers.problems.bar.state import WatchedBar
from solvers.problems.bar.step import check_it
from solvers.scene.switches import bare
from solvers.solver.arrays import part_of, part_types
from solvers.solver.base import SOUND
from solvers.solver.loop import CHECK_EVERY

BaselineState = part_types(WatchedBar, (
    "particles", "cells", "cells_per_length", "dt", "modulus", "density", "volume", "unstretched", "half_width",
    "farthest", "drift_velocity", "angular_frequency", "force_scale", "material_position", "position", "velocity",
    "deformation_gradient", "sine", "first_node", "weights", "node_sums", "node_motion", "totals",
    "table_sizes", "tables", "verdict"))


@ti.kernel
def advance(start: ti.i32, steps: ti.i32, bar: BaselineState, on: ti.template()):
    ti.loop_config(serialize=True)
    for k in range(steps):
        if bar.verdict[0] == SOUND:
            step = start + k
            update_grid(bar, step * bar.dt, on)
            nodes_to_particles(bar, step + 1, on)
            if (step + 1) % CHECK_EVERY == 0:
                check_it(bar, step + 1)


class BarBaseline(BarSolver):
    """A bar that takes the baseline steps; its rows of samples hold nothing."""

    def __init__(self, scene):
        super().__init__(scene)
        self._baseline = part_of(self._pack, BaselineState)

    def _run(self, steps: int) -> None:
        advance(self.step, steps, self._baseline, bare(self._switches))
