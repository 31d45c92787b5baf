"""The bar's step with nothing optional in it: uGIMP with the material body force, written out by hand.

What :mod:`solvers.problems.bar.method.phases` does with every effect off, without the switches, without the hooks and
the memory of estimators, without samples; the look for a run gone bad stays, for that is no effect. The bench measures
the solver against it, and a test that both give the same numbers.
"""

import taichi as ti

from solvers.kernels.shapes import gimp, stencil
from solvers.problems.bar.method.nodes import EMPTY, GHOSTS, fold, spread, stencil_of
from solvers.problems.bar.solver import BarSolver
from solvers.problems.bar.state import WatchedBar
from solvers.problems.bar.step import check
from solvers.solver.arrays import part_of, part_types
from solvers.solver.base import SOUND
from solvers.solver.loop import CHECK_EVERY

BaselineState = part_types(WatchedBar, (
    "particles", "cells", "cells_per_length", "dt", "modulus", "density", "volume", "unstretched", "half_width",
    "farthest", "drift_velocity", "angular_frequency", "force_scale", "material_position", "position", "velocity",
    "deformation_gradient", "sine", "first_node", "weights", "node_sums", "node_motion", "verdict"))


@ti.func
def find_weights(bar: ti.template()):
    for p in range(bar.particles):
        x = bar.position[p]
        first, left, right, slope_left, slope_right = gimp((x - ti.floor(x)) * bar.cells_per_length, bar.half_width)
        S, dS = stencil(left, right, slope_left, slope_right)
        bar.first_node[p] = ti.cast(ti.min(ti.max(first, -1.0), bar.cells), ti.i32) + 1
        bar.weights[p] = ti.Vector([S[0], S[2], dS[0] * bar.cells_per_length, dS[2] * bar.cells_per_length])


@ti.func
def particles_to_nodes(bar: ti.template(), t):
    size = bar.force_scale * ti.sin(bar.angular_frequency * t)
    for i in range(bar.cells + GHOSTS):
        bar.node_sums[i] = ti.Vector([0.0, 0.0, 0.0, 0.0])
    for p in range(bar.particles):
        S, dS = stencil_of(bar, p)
        i = bar.first_node[p]
        volume = bar.deformation_gradient[p] * bar.volume
        stress = bar.modulus * (bar.deformation_gradient[p] - bar.unstretched)
        interpolated = ti.Vector([1.0, bar.velocity[p], 0.0, size * bar.sine[p]])
        force = ti.Vector([0.0, 0.0, -volume * stress, 0.0])
        for k in ti.static(range(3)):
            bar.node_sums[i + k] += S[k] * interpolated + dS[k] * force
    fold(bar.node_sums, bar.cells)


@ti.func
def update_nodes(bar: ti.template()):
    for i in range(1, bar.cells + 1):
        sums = bar.node_sums[i]
        v, a = 0.0, 0.0
        if sums[0] > EMPTY:
            a = sums[2] / (bar.density * bar.volume * sums[0]) + sums[3] / sums[0]
            v = sums[1] / sums[0] + bar.dt * a
        bar.node_motion[i] = ti.Vector([v, a])
    spread(bar.node_motion, bar.cells)


@ti.func
def nodes_to_particles(bar: ti.template()):
    for p in range(bar.particles):
        S, dS = stencil_of(bar, p)
        i = bar.first_node[p]
        n0, n1, n2 = bar.node_motion[i], bar.node_motion[i + 1], bar.node_motion[i + 2]
        motion = S[0] * n0 + S[1] * n1 + S[2] * n2
        L = dS[0] * n0[0] + dS[1] * n1[0] + dS[2] * n2[0]
        bar.velocity[p] += bar.dt * motion[1]
        bar.position[p] += bar.dt * motion[0]
        bar.deformation_gradient[p] *= 1 + bar.dt * L


@ti.kernel
def advance(start: ti.i32, steps: ti.i32, bar: BaselineState):
    ti.loop_config(serialize=True)
    for k in range(steps):
        if bar.verdict[0] == SOUND:
            step = start + k
            find_weights(bar)
            particles_to_nodes(bar, step * bar.dt)
            update_nodes(bar)
            nodes_to_particles(bar)
            if (step + 1) % CHECK_EVERY == 0:
                check(bar, step + 1)


class BarBaseline(BarSolver):
    """A bar that takes the baseline steps; its rows of samples hold nothing."""

    def __init__(self, scene):
        super().__init__(scene)
        self._baseline = part_of(self._pack, BaselineState)

    def _run(self, steps: int) -> None:
        advance(self.step, steps, self._baseline)
