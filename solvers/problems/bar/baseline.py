"""The bar's step with nothing optional in it: uGIMP with the material body force, written out by hand.

What :mod:`solvers.problems.bar.method.phases` does with every effect off, without the switches, without the hooks and
the memory of estimators, without samples; the look for a run gone bad stays, for that is no effect. The bench measures
the solver against it, and a test that both give the same numbers.
"""

import taichi as ti

from solvers.kernels.lanes import LANES, read
from solvers.kernels.shapes import gimp
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
    for block in range((bar.particles + LANES - 1) // LANES):
        p, per = ti.min(block * LANES, bar.particles - LANES), bar.cells_per_length
        x = read(bar.position, p)
        first, left, right, slope_left, slope_right = gimp((x - ti.floor(x)) * per, bar.half_width)
        slope_left, slope_right = slope_left * per, slope_right * per
        node = ti.min(ti.max(first, -1.0), float(bar.cells)) + 1
        for k in ti.static(range(LANES)):
            bar.first_node[p + k] = ti.cast(node[k], ti.i32)
            bar.weights[p + k] = ti.Vector([left[k], right[k], slope_left[k], slope_right[k]])


@ti.func
def particles_to_nodes(bar: ti.template(), t):
    size = bar.force_scale * ti.sin(bar.angular_frequency * t)
    for i in range(bar.cells + GHOSTS):
        bar.node_sums[i] = ti.Vector([0.0, 0.0, 0.0, 0.0])
    at = bar.first_node[0]
    left, middle, right = bar.node_sums[at], bar.node_sums[at + 1], bar.node_sums[at + 2]
    for p in range(bar.particles):
        S, dS = stencil_of(bar, p)
        volume = bar.deformation_gradient[p] * bar.volume
        stress = bar.modulus * (bar.deformation_gradient[p] - bar.unstretched)
        carried = ti.Vector([1.0, bar.velocity[p], -volume * stress, size * bar.sine[p]])
        i = bar.first_node[p]
        if i != at:
            bar.node_sums[at], bar.node_sums[at + 1], bar.node_sums[at + 2] = left, middle, right
            left, middle, right = bar.node_sums[i], bar.node_sums[i + 1], bar.node_sums[i + 2]
            at = i
        left = left + ti.Vector([S[0], S[0], dS[0], S[0]]) * carried
        middle = middle + ti.Vector([S[1], S[1], dS[1], S[1]]) * carried
        right = right + ti.Vector([S[2], S[2], dS[2], S[2]]) * carried
    bar.node_sums[at], bar.node_sums[at + 1], bar.node_sums[at + 2] = left, middle, right
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
        v_a_L = ti.Vector([S[0], S[0], dS[0], dS[0]]) * ti.Vector([n0[0], n0[1], n0[0], n0[1]]) \
            + ti.Vector([S[1], S[1], dS[1], dS[1]]) * ti.Vector([n1[0], n1[1], n1[0], n1[1]]) \
            + ti.Vector([S[2], S[2], dS[2], dS[2]]) * ti.Vector([n2[0], n2[1], n2[0], n2[1]])
        bar.velocity[p] += bar.dt * v_a_L[1]
        bar.position[p] += bar.dt * v_a_L[0]
        bar.deformation_gradient[p] *= 1 + bar.dt * v_a_L[2]


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
