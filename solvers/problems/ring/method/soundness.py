"""Contradictions within a ring, seen without its exact solution (see ``solvers.solver.soundness``).

The loads are radial and the same all around, so motion around the centre and differences along a material circle are
errors, whatever the true motion is.
"""

import taichi as ti

from solvers.problems.planar.method.records import scatter_add
from solvers.problems.planar.method.soundness import look_at_neighbours, moments, write_moments
from solvers.problems.ring.exact import INNER, OUTER
from solvers.scene.balance import MODES
from solvers.solver.samples import column


@ti.func
def look(ring: ti.template(), row):
    """Write how far neighbours are from where they should stand, and the ring is out of shape, in metres."""
    look_at_neighbours(ring, row)
    around = 0.0
    for k in range(ring.radius_count):
        ring.circles[k] = ti.Vector([0.0, 0.0, 0.0, 0.0])
    for p in range(ring.particles):
        X, e, motion = ring.material_position[p], ring.direction[p], ring.position_velocity[p]
        u = ti.Vector([motion[0] - X[0], motion[1] - X[1]])
        radial, hoop = u[0] * e[0] + u[1] * e[1], u[1] * e[0] - u[0] * e[1]
        around += hoop * hoop
        scatter_add(ring.circles, ring.radius[p], ti.Vector([1.0, radial, radial * radial, hoop]))
    scatter, squares, motion = 0.0, around, ti.Vector([0.0] * MODES)
    for k in range(ring.radius_count):  # a cartesian layout has next to no two particles on a circle
        sums = ring.circles[k]
        scatter += ti.max(0.0, sums[2] - sums[1] * sums[1] / sums[0])
        squares += sums[2]
        motion += moments(ring, k, sums[1], sums[3], INNER, OUTER)
    write_moments(ring, row, squares, motion)
    ring.samples[row, ti.static(column("out_of_shape"))] = ti.sqrt((around + scatter) / ring.particles)
