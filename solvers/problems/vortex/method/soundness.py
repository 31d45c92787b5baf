"""Contradictions within a vortex, seen without its exact solution (see ``solvers.solver.soundness``).

The loads are the same all around, seen from each particle, so that every circle of particles stays a circle and turns
as a whole: differences along it are errors, whatever the true motion is.
"""

import taichi as ti

from solvers.problems.planar.method.records import scatter_add
from solvers.problems.planar.method.soundness import look_at_neighbours, moments, write_moments
from solvers.problems.vortex.exact import INNER, OUTER
from solvers.scene.balance import MODES
from solvers.solver.samples import column


@ti.func
def look(vortex: ti.template(), row):
    """Write how far neighbours are from where they should stand, and circles are out of shape, in metres.

    Displacements in the frame of each particle at rest are the same along a circle; their scatter is a strict lower
    bound of the error. A cartesian layout has next to no two particles on a circle, and shows little of it.
    """
    look_at_neighbours(vortex, row)
    for k in range(vortex.radius_count):
        vortex.circles[k] = ti.Vector([0.0, 0.0, 0.0, 0.0])
    for p in range(vortex.particles):
        X, e, motion = vortex.material_position[p], vortex.direction[p], vortex.position_velocity[p]
        u = ti.Vector([motion[0] - X[0], motion[1] - X[1]])
        scatter_add(vortex.circles, vortex.radius[p], ti.Vector([
            1.0, u[0] * e[0] + u[1] * e[1], u[1] * e[0] - u[0] * e[1], u[0] * u[0] + u[1] * u[1]]))
    scatter, squares, motion = 0.0, 0.0, ti.Vector([0.0] * MODES)
    for k in range(vortex.radius_count):
        sums = vortex.circles[k]
        squares += sums[3]
        motion += moments(vortex, k, sums[1], sums[2], INNER, OUTER)
        scatter += ti.max(0.0, sums[3] - (sums[1] * sums[1] + sums[2] * sums[2]) / sums[0])
    write_moments(vortex, row, squares, motion)
    vortex.samples[row, ti.static(column("out_of_shape"))] = ti.sqrt(scatter / vortex.particles)
