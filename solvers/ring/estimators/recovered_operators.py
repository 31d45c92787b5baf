"""The recovered estimator's operators on the ring: each along the radius first, then along the angle, or back.

Particle (i, j), the j-th along the i-th radius, is number i K + j, K = ``radius_count``; node (a, b) of the error grid
is number a B + b, B = ``across``. Fields are two vectors side by side, (x, y, x, y). Weights along the angle
come for x and y, because a symmetry plane mirrors them differently: (value x, value y, slope x, slope y).
"""

import taichi as ti

from solvers.estimators.packing import part
from solvers.estimators.recovery import ROUGH, SIZE, fourth_factor, row_of
from solvers.ring.material import radial_force_at

# Tables. Along the radius their weights are (value, slope, value over R, nothing).
TABLES = tuple(f"recovered_{way}_{what}_" for way in ("angular", "radial")
               for what in ("fit", "spread", "gather", "smoothing"))
ANGULAR_FIT, ANGULAR_SPREAD, ANGULAR_GATHER, ANGULAR_SMOOTHING = TABLES[:4]
RADIAL_FIT, RADIAL_SPREAD, RADIAL_GATHER, RADIAL_SMOOTHING = TABLES[4:]

#: Blocks of the nodal array: U and w in the middle of the next H; a and the one before; errors as gathered; smoothed
#: along the radius; unsmoothed; M b along the radius, with unit direction; M e_R along the angle.
MOTION, RATE, GATHERED, HALF_SMOOTHED, ERRORS, FORCE, DIRECTION = 0, 1, 2, 3, 4, 5, 6
NODE_BLOCKS = 7
#: Blocks of the particle array: two vector fields; what was fitted to them along the radius, and its slope.
FIELD, FITTED, FITTED_SLOPE = 0, 1, 2
PARTICLE_BLOCKS = 3
VALUES, SLOPES = 0, 1  # blocks behind these, of radii with nodes on them: values, and slopes around
STRESS = 1  # P e_R and P e_angle, in the place of what is fitted only for reports

#: Which of a weight's four numbers two vectors (x, y, x, y) are taken times.
VALUE, SLOPE, SLOPE_AND_OVER_R = (0, 0, 0, 0), (1, 1, 1, 1), (1, 1, 2, 2)  # along the radius
ANGULAR_VALUES, ANGULAR_SLOPES, EACH = (0, 1, 0, 1), (2, 3, 2, 3), (0, 1, 2, 3)


@ti.func
def node_at(ring: ti.template(), block: ti.template(), i):
    return block * ring.recovered_count + i


@ti.func
def line_at(ring: ti.template(), block: ti.template(), line, b):
    radii = ring.particles // ring.radius_count
    return PARTICLE_BLOCKS * ring.particles + (block * radii + line) * ring.recovered_across + b


@ti.func
def particle_at(ring: ti.template(), block: ti.template(), p):
    return block * ring.particles + p


@ti.func
def values_of(weight):
    """The angular weights of two vector fields."""
    x, y = weight[0], weight[1]
    return ti.Vector([x, y, x, y])


@ti.func
def slopes_of(weight):
    x, y = weight[2], weight[3]
    return ti.Vector([x, y, x, y])


@ti.func
def picked(weight, pick: ti.template()):
    """The four of a weight's numbers that ``pick`` names."""
    ready = weight
    if ti.static(pick != EACH):
        first, third = weight[pick[0]], weight[pick[2]]
        if ti.static(pick[0] == pick[1]):
            ready = ti.Vector([first, first, third, third])
        else:
            second = weight[pick[1]]
            ready = ti.Vector([first, second, first, second])
    return ready


@ti.func
def row_sum(ring: ti.template(), table: ti.template(), row, pick: ti.template(), field: ti.template(), start, stride):
    """The sum over a row of a table: entry ``start + stride i`` of ``field`` times the four of the row's i-th weights
    that ``pick`` names."""
    total = ti.Vector([0.0, 0.0, 0.0, 0.0])
    first, begin, end = row_of(ring, table, row, row)
    entry = start + stride * first
    for k in range(begin, end):
        total += picked(part(ring, table).weights[k], pick) * field[entry]
        entry += stride
    return total


@ti.func
def radial_gather(ring: ti.template(), block: ti.template(), pick: ti.template()):
    """Integrals along each radius of a block of the particles' fields, over that of N_b R.

    With ``VALUE`` those of N_b f R; with ``SLOPE_AND_OVER_R`` of N_b' R P e_R and of N_b P e_angle, side by side.
    """
    for line in range(ring.particles // ring.radius_count):
        for b in range(ring.recovered_across):
            ring.recovered_particles[line_at(ring, VALUES, line, b)] = row_sum(
                ring, RADIAL_GATHER, b, pick, ring.recovered_particles,
                particle_at(ring, block, line * ring.radius_count), 1)


@ti.func
def angular_gather(ring: ti.template(), a, b, pick: ti.template()):
    """At node (a, b), from what the radii gathered: M f with ``ANGULAR_VALUES``; with ``EACH`` the two parts of D P,
    the first vector with N_a and the second with N_a'."""
    return row_sum(ring, ANGULAR_GATHER, a, pick, ring.recovered_particles, line_at(ring, VALUES, 0, b),
                   ring.recovered_across)


@ti.func
def gather_force(ring: ti.template(), t, on: ti.template()):
    """M b along the radius; the force at the particles' radii waits where the radii will gather."""
    if ti.static(on.body_force != "none"):
        for j in range(ring.radius_count):
            b_j = radial_force_at(ring, ring.radii[j], t, on)
            ring.recovered_particles[particle_at(ring, FITTED_SLOPE, j)] = ti.Vector([b_j, b_j, b_j, b_j])
        for b in range(ring.recovered_across):
            ring.recovered_nodes[node_at(ring, FORCE, b)] = row_sum(
                ring, RADIAL_GATHER, b, VALUE, ring.recovered_particles, particle_at(ring, FITTED_SLOPE, 0), 1)


@ti.func
def radial_smoothing(ring: ti.template()):
    """The radial half of C."""
    B = ring.recovered_across
    for a in range(ring.recovered_count // B):
        for b in range(B):
            ring.recovered_nodes[node_at(ring, HALF_SMOOTHED, a * B + b)] = row_sum(
                ring, RADIAL_SMOOTHING, b, VALUE, ring.recovered_nodes, node_at(ring, GATHERED, a * B), 1)


@ti.func
def angular_smoothing(ring: ti.template(), a, b):
    """C of the gathered nodal values at node (a, b), from the radial half."""
    return row_sum(ring, ANGULAR_SMOOTHING, a, ANGULAR_VALUES, ring.recovered_nodes, node_at(ring, HALF_SMOOTHED, b),
                   ring.recovered_across)


@ti.func
def angular_spread(ring: ti.template()):
    """The nodal errors interpolated along the angle, and their slopes: the angular half of sum N_i e_i."""
    for line in range(ring.particles // ring.radius_count):
        a, begin, _ = row_of(ring, ANGULAR_SPREAD, line, line)
        for b in range(ring.recovered_across):
            value, slope = ti.Vector([0.0, 0.0, 0.0, 0.0]), ti.Vector([0.0, 0.0, 0.0, 0.0])
            for k in range(3):
                w = part(ring, ANGULAR_SPREAD).weights[begin + k]
                e = ring.recovered_nodes[node_at(ring, ERRORS, (a + k) * ring.recovered_across + b)]
                value += values_of(w) * e
                slope += slopes_of(w) * e
            ring.recovered_particles[line_at(ring, VALUES, line, b)] = value
            ring.recovered_particles[line_at(ring, SLOPES, line, b)] = slope


@ti.func
def radial_spread(ring: ti.template(), i, j):
    """The errors at particle (i, j) with their slopes along the radius and the angle, from the angular half."""
    value, along, around = ti.Vector([0.0] * 4), ti.Vector([0.0] * 4), ti.Vector([0.0] * 4)
    b, begin, _ = row_of(ring, RADIAL_SPREAD, j, j)
    for k in range(3):
        w, e = part(ring, RADIAL_SPREAD).weights[begin + k], ring.recovered_particles[line_at(ring, VALUES, i, b + k)]
        at_value, at_slope = w[0], w[1]
        value += at_value * e
        along += at_slope * e
        around += at_value * ring.recovered_particles[line_at(ring, SLOPES, i, b + k)]
    return value, along, around


@ti.func
def line_slopes(ring: ti.template(), i, j):
    """Slopes of the fields along the radius and the angle, each recovered on one line through particle (i, j)."""
    K = ring.radius_count
    return (row_sum(ring, RADIAL_FIT, j, SLOPE, ring.recovered_particles, particle_at(ring, FIELD, i * K), 1),
            row_sum(ring, ANGULAR_FIT, i, ANGULAR_SLOPES, ring.recovered_particles, particle_at(ring, FIELD, j), K))


@ti.func
def radial_fit(ring: ti.template()):
    """The fields recovered along each radius, and their slopes: the radial half of a fit over a patch."""
    K = ring.radius_count
    for line in range(ring.particles // K):
        for j in range(K):
            value, slope = ti.Vector([0.0, 0.0, 0.0, 0.0]), ti.Vector([0.0, 0.0, 0.0, 0.0])
            other, begin, end = row_of(ring, RADIAL_FIT, j, j)
            p = particle_at(ring, FIELD, line * K + other)
            for k in range(begin, end):
                w, field = part(ring, RADIAL_FIT).weights[k], ring.recovered_particles[p]
                value += w[0] * field
                slope += w[1] * field
                p += 1
            ring.recovered_particles[particle_at(ring, FITTED, line * K + j)] = value
            ring.recovered_particles[particle_at(ring, FITTED_SLOPE, line * K + j)] = slope


@ti.func
def angular_fit(ring: ti.template(), i, j):
    """The fields recovered over a patch around particle (i, j), with slopes along the radius and the angle."""
    K = ring.radius_count
    value, along, around = ti.Vector([0.0] * 4), ti.Vector([0.0] * 4), ti.Vector([0.0] * 4)
    other, begin, end = row_of(ring, ANGULAR_FIT, i, i)
    p = other * K + j
    for k in range(begin, end):
        w, fitted = part(ring, ANGULAR_FIT).weights[k], ring.recovered_particles[particle_at(ring, FITTED, p)]
        value += values_of(w) * fitted
        along += values_of(w) * ring.recovered_particles[particle_at(ring, FITTED_SLOPE, p)]
        around += slopes_of(w) * fitted
        p += K
    return value, along, around


@ti.func
def remember_sizes(ring: ti.template(), nodes: ti.template()):
    """Add this turn's fourth differences of U along both lines, and e, to the sums that the verdict looks at."""
    B, rough, size = ring.recovered_across, 0.0, 0.0
    A = ring.recovered_count // B
    for a in range(A):
        for b in range(B):
            around, along = ti.Vector([0.0, 0.0]), ti.Vector([0.0, 0.0])
            for k in range(5):
                i, j = a + k - 2, ti.min(ti.max(b + k - 2, 0), B - 1)
                x, y = 1.0, 1.0  # signs beyond a plane
                if i < 0:
                    i, y = -1 - i, -1.0
                if i >= A:
                    i, x = 2 * A - 1 - i, -1.0
                U, V = nodes[node_at(ring, MOTION, i * B + b)], nodes[node_at(ring, MOTION, a * B + j)]
                factor = fourth_factor(k)
                around += factor * ti.Vector([x * U[0], y * U[1]])
                along += factor * ti.Vector([V[0], V[1]])
            rough += around.dot(around)
            if b > 1 and b < B - 2:  # nothing lies beyond the free ends
                rough += along.dot(along)
            e = nodes[node_at(ring, GATHERED, a * B + b)]
            size += e[0] * e[0] + e[1] * e[1]
    ring.recovered_numbers[ROUGH] += rough / ring.recovered_count
    ring.recovered_numbers[SIZE] += size / ring.recovered_count
