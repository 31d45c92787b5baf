"""Contradictions within a plane body, seen without its exact solution (see ``solvers.solver.soundness``).

Neighbours on a lattice of particles should stand (F_p + F_q)/2 (X_q - X_p) from each other, and circles of them where
the balance of momentum brings them. Loads are the same all around, seen from each particle, so that every circle of
particles stays a circle: differences along it are errors, whatever the true motion is. Sums are Python lists because of
CUDA (see ``error_and_energy_sums``).
"""

from collections.abc import Callable

import taichi as ti

from solvers.kernels import runtime
from solvers.problems.planar.method.node_records import scatter_add
from solvers.scene.displacement_moments import MODES
from solvers.solver import separable_field_tables
from solvers.solver.samples import column_index
from solvers.solver.separable_field_tables import MOTION, table_size

SAME = 1e-12  # relative difference of a distance computed twice, in loops compiled differently


def make_circle_contradiction_kernel(inner: float, outer: float, turns: bool) -> Callable:
    """Returns the Taichi function (body, row) that samples contradictions within a body between two radii in m. Circles
    move along the radius only, so that motion around the centre is an error too, unless each ``turns`` as a whole.

    Displacements in the frame of each particle at rest are the same along a circle; their scatter is a strict lower
    bound of the error. A cartesian layout has next to no two particles on a circle, and shows little of it.
    """
    @ti.func
    def record_contradictions(body: ti.template(), row):
        """Writes the gaps between neighbours and the distortion of circles, in m, to sample ``row``."""
        record_neighbour_gaps(body, row)
        turning = 0.0
        for k in range(body.orbits):
            body.exact[3 * k] = ti.Vector([0.0, 0.0, 0.0, 0.0])  # room that the sample needs no more
        for p in range(body.particles):
            X, e, motion = body.material_position[p], body.direction[p], body.position_velocity[p]
            u = ti.Vector([motion[0] - X[0], motion[1] - X[1]])
            along, around = u[0] * e[0] + u[1] * e[1], u[1] * e[0] - u[0] * e[1]
            square = along * along
            if ti.static(turns):
                square = u[0] * u[0] + u[1] * u[1]
            else:
                turning += around * around
            scatter_add(body.exact, 3 * body.orbit[p], ti.Vector([1.0, along, around, square]))
        scatter, squares, moments = 0.0, turning, [0.0 for _ in ti.static(range(MODES))]
        for k in range(body.orbits):
            sums = body.exact[3 * k]
            mean = sums[1] * sums[1]
            if ti.static(turns):
                mean += sums[2] * sums[2]
            squares += sums[3]
            added = circle_moments(body, k, sums[1], sums[2], inner, outer)
            for n in ti.static(range(MODES)):
                moments[n] += added[n]
            scatter += ti.max(0.0, sums[3] - mean / sums[0])
        body.samples[row, ti.static(column_index("motion_square"))] = squares
        for n in ti.static(range(MODES)):
            body.samples[row, ti.static(column_index("motion_0")) + n] = moments[n]
        body.samples[row, ti.static(column_index("out_of_shape"))] = ti.sqrt((turning + scatter) / body.particles)

    return record_contradictions


@ti.func
def record_mode_moments(body: ti.template(), row):
    """Writes the gaps between neighbours in m, and the moments of the displacement with the modes of the exact motion
    (``BoxScene.momentum_balance_moments``), to sample ``row``, for a body without a known symmetry."""
    record_neighbour_gaps(body, row)
    squares, sums = 0.0, [0.0 for _ in ti.static(range(MODES))]
    rank = table_size(body, MOTION, separable_field_tables.RANK)
    modes = table_size(body, MOTION, separable_field_tables.MODES)
    for p in range(body.particles):
        X, q = body.material_position[p], body.position_velocity[p]
        u = ti.Vector([q[0] - X[0], q[1] - X[1]])
        squares += u[0] * u[0] + u[1] * u[1]
        for k in ti.static(range(MODES)):
            if k < rank:
                m = body.tables[modes + 2 * (p * rank + k)]
                sums[k] += u[0] * m[0] + u[1] * m[1]
    body.samples[row, ti.static(column_index("motion_square"))] = squares
    for k in ti.static(range(MODES)):
        body.samples[row, ti.static(column_index("motion_0")) + k] = sums[k]
    body.samples[row, ti.static(column_index("out_of_shape"))] = 0.0


@ti.func
def record_neighbour_gaps(body: ti.template(), row):
    """Writes the RMS gap between neighbours, in m, and the particle with the worst one to sample ``row``."""
    squares, pairs, worst, place = 0.0, 0, -1.0, 0
    for p in range(body.particles):
        for side in ti.static(range(2)):
            q = body.neighbours[2 * p + side]
            if q >= 0:
                miss = squared_neighbour_gap(body, p, q)
                squares += miss
                pairs += 1
                if ti.static(runtime.runs_on_cpu()):
                    if miss > worst:
                        worst, place = miss, p
                elif miss > worst:  # for fewer atomic operations
                    ti.atomic_max(worst, miss)
    if ti.static(not runtime.runs_on_cpu()):  # find the particle again, because all are checked in parallel
        place = body.particles
        for p in range(body.particles):
            for side in ti.static(range(2)):
                q = body.neighbours[2 * p + side]
                if q >= 0:
                    if squared_neighbour_gap(body, p, q) >= worst * (1 - SAME):
                        ti.atomic_min(place, p)
        place = place % body.particles  # none where nothing is a number
    body.samples[row, ti.static(column_index("neighbour_gap"))] = ti.sqrt(squares / ti.max(pairs, 1))
    body.samples[row, ti.static(column_index("place"))] = place


@ti.func
def squared_neighbour_gap(body: ti.template(), p, q):
    """Returns |x_q - x_p - (F_p + F_q)/2 (X_q - X_p)|^2 in m^2, for particles p and q."""
    dx = body.position_velocity[q] - body.position_velocity[p]
    dX = body.material_position[q] - body.material_position[p]
    F = 0.5 * (body.deformation_gradient[p] + body.deformation_gradient[q])
    miss_x = dx[0] - F[0] * dX[0] - F[1] * dX[1]
    miss_y = dx[1] - F[2] * dX[0] - F[3] * dX[1]
    return miss_x * miss_x + miss_y * miss_y


@ti.func
def circle_moments(body: ti.template(), k, along, around, inner, outer):
    """Returns what circle k adds to the moments of ``solvers.problems.planar.circle_momentum_balance`` (MODES,): its
    displacements in m ``along`` e_R and ``around``, summed over particles, times Legendre polynomials of its radius
    between the radii ``inner`` and ``outer``."""
    half = ti.static(MODES // 2)
    s = (2 * body.orbit_point[k][0] - inner - outer) / (outer - inner)
    sums = ti.Vector([0.0] * MODES)
    older, value = 0.0, 1.0
    for n in ti.static(range(half)):
        sums[n], sums[half + n] = value * along, value * around
        older, value = value, ((2 * n + 1) * s * value - n * older) / (n + 1)
    return sums
