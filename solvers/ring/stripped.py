"""The ring's step with nothing optional in it: CPDI with the material body force, written out by hand.

See :mod:`solvers.bar.stripped`. The mappings, which have no switches but the force's kind, are the solver's own.
"""

from typing import NamedTuple

import taichi as ti

from solvers.arrays import part_of, part_types
from solvers.planar import cpdi
from solvers.planar.check import check
from solvers.planar.phases import EMPTY, fold_sums
from solvers.ring.layout import GHOSTS
from solvers.ring.material import radial_force_at
from solvers.ring.phases import TRAITS, fold, mirror_records
from solvers.ring.solver import RingSolver
from solvers.ring.state import WatchedRing
from solvers.ring.step import outside
from solvers.solver import SOUND
from solvers.turn import CHECK_EVERY


class Bare(NamedTuple):
    """What the mappings ask of the switches."""

    body_force: str = "material"
    frozen: bool = False


StrippedRingState = part_types(WatchedRing, (
    "particles", "row", "active", "radius_count", "spacing", "origin", "cells_per_length", "dt", "shear_modulus",
    "density", "material_position", "farthest_move",
    "farthest", "amplitude", "angular_frequency", "motion", "deformation_gradient", "mass", "direction", "radius",
    "edges", "weights", "corner_nodes", "radii", "radial_force", "node_sums", "node_motion", "verdict"))


@ti.func
def particles_to_nodes(ring: ti.template(), t, on: ti.template()):
    for k in range(ring.radius_count):
        ring.radial_force[k] = radial_force_at(ring, ring.radii[k], t, on)
    for j in range(ring.active):
        for node in range(j * ring.row, j * ring.row + ring.active):
            ring.node_sums[node] = ti.Vector([0.0] * 8)
    for p in range(ring.particles):
        cpdi.find_weights(ring, p, on)
    cpdi.particles_to_nodes(ring, 0, ring.particles, 0, TRAITS, on)
    fold(ring, fold_sums)


@ti.func
def update_nodes(ring: ti.template()):
    least = EMPTY * ring.density * ring.spacing * ring.spacing
    for j in range(GHOSTS, ring.active):
        for i in range(GHOSTS, ring.active):
            node = j * ring.row + i
            sums = ring.node_sums[node]
            motion = ti.Vector([0.0, 0.0, 0.0, 0.0])
            if sums[4] > least:
                q = ti.Vector([sums[0], sums[1], sums[2], sums[3]]) / sums[4]
                motion = ti.Vector([q[0] + ring.dt * q[2], q[1] + ring.dt * q[3], q[2], q[3]])
                if i == GHOSTS:
                    motion[0], motion[2] = 0.0, 0.0
                if j == GHOSTS:
                    motion[1], motion[3] = 0.0, 0.0
            ring.node_motion[node] = motion
    mirror_records(ring, ring.node_motion)


@ti.func
def nodes_to_particles(ring: ti.template(), on: ti.template()):
    dt = ring.dt
    for p in range(ring.particles):
        here, by_x, by_y = cpdi.gather(ring, p, ring.node_motion, on)
        F = ring.deformation_gradient[p]
        ring.motion[p] = ring.motion[p] + dt * here
        ring.deformation_gradient[p] = F + dt * (
            ti.Vector([by_x[0], by_x[0], by_x[1], by_x[1]]) * ti.Vector([F[0], F[1], F[0], F[1]])
            + ti.Vector([by_y[0], by_y[0], by_y[1], by_y[1]]) * ti.Vector([F[2], F[3], F[2], F[3]]))


@ti.kernel
def advance(start: ti.i32, steps: ti.i32, ring: StrippedRingState, on: ti.template()):
    ti.loop_config(serialize=True)
    for k in range(steps):
        if ring.verdict[0] == SOUND:
            step = start + k
            particles_to_nodes(ring, step * ring.dt, on)
            update_nodes(ring)
            nodes_to_particles(ring, on)
            if (step + 1) % CHECK_EVERY == 0:
                check(ring, step + 1, outside)


class StrippedRing(RingSolver):
    """A ring that takes the stripped steps; its rows of samples hold nothing."""

    def __init__(self, scene):
        super().__init__(scene)
        self._stripped = part_of(self._pack, StrippedRingState)

    def _run(self, steps: int) -> None:
        advance(self.step, steps, self._stripped, Bare())


SOLVER = StrippedRing
