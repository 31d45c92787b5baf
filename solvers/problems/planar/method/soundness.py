"""Neighbours on a lattice of particles should stand (F_p + F_q)/2 (X_q - X_p) from each other, and circles of them
where the balance of momentum brings them; see ``solvers.solver.soundness``."""

import taichi as ti

from solvers.kernels import runtime
from solvers.scene.balance import MODES
from solvers.solver.samples import column

SAME = 1e-12  # of itself, by which a distance may differ when it is found twice, in loops that are compiled otherwise


@ti.func
def look_at_neighbours(body: ti.template(), row):
    """Write how far neighbours are from where they should stand, in metres, and the particle where that is worst."""
    squares, pairs, worst, place = 0.0, 0, -1.0, 0
    for p in range(body.particles):
        for side in ti.static(range(2)):
            q = body.neighbours[2 * p + side]
            if q >= 0:
                miss = neighbour_gap(body, p, q)
                squares += miss
                pairs += 1
                if ti.static(runtime.on_processor()):
                    if miss > worst:
                        worst, place = miss, p
                elif miss > worst:  # for fewer atomic operations
                    ti.atomic_max(worst, miss)
    if ti.static(not runtime.on_processor()):  # which of those that are all looked at at once it was
        place = body.particles
        for p in range(body.particles):
            for side in ti.static(range(2)):
                q = body.neighbours[2 * p + side]
                if q >= 0:
                    if neighbour_gap(body, p, q) >= worst * (1 - SAME):
                        ti.atomic_min(place, p)
        place = place % body.particles  # none where nothing is a number
    body.samples[row, ti.static(column("neighbour_gap"))] = ti.sqrt(squares / ti.max(pairs, 1))
    body.samples[row, ti.static(column("place"))] = place


@ti.func
def neighbour_gap(body: ti.template(), p, q):
    """|x_q - x_p - (F_p + F_q)/2 (X_q - X_p)| squared."""
    dx = body.position_velocity[q] - body.position_velocity[p]
    dX = body.material_position[q] - body.material_position[p]
    F = 0.5 * (body.deformation_gradient[p] + body.deformation_gradient[q])
    miss_x = dx[0] - F[0] * dX[0] - F[1] * dX[1]
    miss_y = dx[1] - F[2] * dX[0] - F[3] * dX[1]
    return miss_x * miss_x + miss_y * miss_y


@ti.func
def moments(body: ti.template(), k, along, around, inner, outer):
    """What a circle adds to the sums that ``solvers.problems.planar.circles`` knows: its displacements ``along`` e_R
    and ``around``, summed over its particles, times the Legendre polynomials of the radius from rim to rim."""
    half = ti.static(MODES // 2)
    s = (2 * body.radii[k][0] - inner - outer) / (outer - inner)
    sums = ti.Vector([0.0] * MODES)
    older, value = 0.0, 1.0
    for n in ti.static(range(half)):
        sums[n], sums[half + n] = value * along, value * around
        older, value = value, ((2 * n + 1) * s * value - n * older) / (n + 1)
    return sums


@ti.func
def write_moments(body: ti.template(), row, squares, sums):
    """Write the sum of |u|^2 over particles and those of all circles."""
    body.samples[row, ti.static(column("motion_square"))] = squares
    for n in ti.static(range(MODES)):
        body.samples[row, ti.static(column("motion_0")) + n] = sums[n]
