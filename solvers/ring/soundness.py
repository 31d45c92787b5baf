"""Contradictions within a ring, seen without its exact solution (see ``solvers.soundness``).

Neighbours on the lattice should stand (F_p + F_q)/2 (X_q - X_p) from each other. The loads are radial and the same all
around, so motion around the centre and differences along a material circle are errors, whatever the true motion is.
"""

import taichi as ti

from solvers.samples import column


@ti.func
def look(ring: ti.template(), row):
    """Write how far neighbours are apart and the ring is out of shape, in metres."""
    squares, pairs, worst, place = 0.0, 0, -1.0, 0
    around = 0.0
    for k in range(ring.radius_count):
        ring.circles[k] = ti.Vector([0.0, 0.0, 0.0, 0.0])
    for p in range(ring.particles):
        for side in ti.static(range(2)):
            q = ring.neighbours[2 * p + side]
            if q >= 0:
                miss = apart(ring, p, q)
                squares += miss
                pairs += 1
                if miss > worst:
                    worst, place = miss, p
        X, e, motion = ring.material_position[p], ring.direction[p], ring.motion[p]
        u = ti.Vector([motion[0] - X[0], motion[1] - X[1]])
        radial, hoop = u[0] * e[0] + u[1] * e[1], u[1] * e[0] - u[0] * e[1]
        around += hoop * hoop
        k = ring.radius[p]
        ring.circles[k] = ring.circles[k] + ti.Vector([1.0, radial, radial * radial, 0.0])
    scatter = 0.0
    for k in range(ring.radius_count):  # a cartesian layout has next to no two particles on a circle
        sums = ring.circles[k]
        scatter += ti.max(0.0, sums[2] - sums[1] * sums[1] / sums[0])
    out = ti.static(ring.samples)
    out[row, ti.static(column("apart"))] = ti.sqrt(squares / ti.max(pairs, 1))
    out[row, ti.static(column("out_of_shape"))] = ti.sqrt((around + scatter) / ring.particles)
    out[row, ti.static(column("place"))] = place


@ti.func
def apart(ring: ti.template(), p, q):
    """|x_q - x_p - (F_p + F_q)/2 (X_q - X_p)| squared."""
    dx = ring.motion[q] - ring.motion[p]
    dX = ring.material_position[q] - ring.material_position[p]
    F = 0.5 * (ring.deformation_gradient[p] + ring.deformation_gradient[q])
    miss_x = dx[0] - F[0] * dX[0] - F[1] * dX[1]
    miss_y = dx[1] - F[2] * dX[0] - F[3] * dX[1]
    return miss_x * miss_x + miss_y * miss_y
