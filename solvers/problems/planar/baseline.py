"""A step in the plane with nothing optional in it: CPDI with the material body force, written out by hand.

See :mod:`solvers.problems.bar.baseline`. The mappings, which have no switches but the force's kind, are the solvers'
own.
"""

from typing import Any, NamedTuple

import taichi as ti

from solvers.problems.planar.method import cpdi
from solvers.problems.planar.method.check import check
from solvers.problems.planar.method.phases import EMPTY, find_weights, fold_sums
from solvers.problems.planar.solver import PlanarSolver
from solvers.scene.scene import Scene
from solvers.solver.arrays import part_of, part_types
from solvers.solver.base import SOUND
from solvers.solver.loop import CHECK_EVERY

MEMBERS = ("particles", "row", "active", "radius_count", "spacing", "origin", "cells_per_length", "dt", "shear_modulus",
           "density", "farthest", "amplitude", "angular_frequency", "position_velocity", "deformation_gradient", "mass",
           "direction", "radius", "edges", "weights", "radii", "node_sums", "node_motion", "verdict")


class NoSwitches(NamedTuple):
    """What the mappings ask of the switches."""

    body_force: str = "material"
    frozen: bool = False
    coupled: bool = False
    method: str = "cpdi"


def baseline(Own: type[PlanarSolver], *members: str) -> type[PlanarSolver]:
    """The problem's own solver with the baseline step; its rows of samples hold nothing. Its part of the step asks for
    ``members`` of the state beside :data:`MEMBERS`."""
    TRAITS, has_escaped = Own.PARTS.traits, Own.PARTS.has_escaped
    State = part_types(Own.PARTS.arrays, (*MEMBERS, *members))

    @ti.kernel
    def advance(start: ti.i32, steps: ti.i32, body: State, on: ti.template()):
        ti.loop_config(serialize=True)
        for k in range(steps):
            if body.verdict[0] == SOUND:
                step = start + k
                TRAITS.forces(body, step * body.dt, on)
                particles_to_nodes(body, TRAITS, on)
                update_nodes(body, TRAITS)
                nodes_to_particles(body, on)
                if (step + 1) % CHECK_EVERY == 0:
                    check(body, step + 1, has_escaped)

    class Baseline(Own):
        def __init__(self, scene: Scene):
            super().__init__(scene)
            self._baseline: Any = part_of(self._pack, State)

        def _run(self, steps: int) -> None:
            advance(self.step, steps, self._baseline, NoSwitches())

    return Baseline


@ti.func
def particles_to_nodes(body: ti.template(), traits: ti.template(), on: ti.template()):
    for j in range(body.active):
        for node in range(j * body.row, j * body.row + body.active):
            body.node_sums[node] = ti.Vector([0.0] * 8)
    find_weights(body, 0, body.particles, on)
    traits.prepare(body, 0, body.particles)
    cpdi.particles_to_nodes(body, 0, body.particles, 0, traits, on)
    traits.fold(body, fold_sums)


@ti.func
def update_nodes(body: ti.template(), traits: ti.template()):
    least = EMPTY * body.density * body.spacing * body.spacing
    for j in range(traits.first, body.active):
        for i in range(traits.first, body.active):
            node = j * body.row + i
            sums = body.node_sums[node]
            motion = ti.Vector([0.0, 0.0, 0.0, 0.0])
            if sums[4] > least:
                q = ti.Vector([sums[0], sums[1], sums[2], sums[3]]) / sums[4]
                motion = traits.pin(i, j, ti.Vector([q[0] + body.dt * q[2], q[1] + body.dt * q[3], q[2], q[3]]))
            body.node_motion[node] = motion
    traits.mirror(body, body.node_motion)


@ti.func
def nodes_to_particles(body: ti.template(), on: ti.template()):
    dt = body.dt
    for p in range(body.particles):
        here, by_x, by_y = cpdi.gather(body, p, body.node_motion, on)
        F = body.deformation_gradient[p]
        body.position_velocity[p] = body.position_velocity[p] + dt * here
        body.deformation_gradient[p] = F + dt * (
            ti.Vector([by_x[0], by_x[0], by_x[1], by_x[1]]) * ti.Vector([F[0], F[1], F[0], F[1]])
            + ti.Vector([by_y[0], by_y[0], by_y[1], by_y[1]]) * ti.Vector([F[2], F[3], F[2], F[3]]))
