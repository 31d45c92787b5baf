"""The recovered estimator's operators on a polar lattice: each along the radius first, then along the angle, or back.

Particle (i, j), the j-th along the i-th radius, is number i K + j, K = ``orbits``; node (a, b) of the error grid
is number a B + b, B = ``across``. Fields are two vectors side by side, (x, y, x, y). Weights along the angle
come for x and y, because a symmetry plane mirrors them differently: (value x, value y, slope x, slope y). Where the
lattice is ``closed``, a whole turn, the last angle is followed by the first.
"""

import taichi as ti

from solvers.estimators.recovery import ROUGH, SIZE, first_of, fourth_factor, groups, put, row_of
from solvers.kernels.packing import part
from solvers.solver.field_tables import find_force_functions, force_at

# Tables. Along the radius their weights are (value, slope, value over R, nothing).
TABLES = tuple(f"recovered_{way}_{what}_" for way in ("angular", "radial")
               for what in ("fit", "spread", "gather", "smoothing"))
ANGULAR_FIT, ANGULAR_SPREAD, ANGULAR_GATHER, ANGULAR_SMOOTHING = TABLES[:4]
RADIAL_FIT, RADIAL_SPREAD, RADIAL_GATHER, RADIAL_SMOOTHING = TABLES[4:]

#: Blocks of the nodal array: U and w in the middle of the next H; a and the one before; errors as gathered; smoothed
#: along the radius, and both ways; unsmoothed; M b along the radius, with unit directions; M e_R and M e_Theta along
#: the angle; a two steps before.
MOTION, RATE, GATHERED, HALF_SMOOTHED, SMOOTHED, ERRORS, FORCE, DIRECTION, BEFORE = range(9)
NODE_BLOCKS = 9
#: Blocks of the particle array: two vector fields; what was fitted to them along the radius, and then around; of the
#: first the slope along the radius and the value, fitted there, and then its slopes along the radius and around.
FIELD, HALF_FITTED, FITTED, HALF_SLOPES, FITTED_SLOPES = range(5)
PARTICLE_BLOCKS = 5
VALUES, SLOPES = 0, 1  # blocks behind these, of radii with nodes on them
STRESS = 1  # P e_R and P e_angle, in the place of what is fitted only for reports

#: Which of a weight's four numbers two vectors (x, y, x, y) are taken times.
VALUE, SLOPE, SLOPE_AND_OVER_R = (0, 0, 0, 0), (1, 1, 1, 1), (1, 1, 2, 2)  # along the radius
ANGULAR_VALUES, ANGULAR_SLOPES, EACH = (0, 1, 0, 1), (2, 3, 2, 3), (0, 1, 2, 3)


@ti.func
def node_at(body: ti.template(), block: ti.template(), i):
    return block * body.recovered_count + i


@ti.func
def line_at(body: ti.template(), block: ti.template(), line, b):
    radii = body.particles // body.orbits
    return PARTICLE_BLOCKS * body.particles + (block * radii + line) * body.recovered_across + b


@ti.func
def particle_at(body: ti.template(), block: ti.template(), p):
    return block * body.particles + p


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
def row_sum(body: ti.template(), table: ti.template(), row, pick: ti.template(), field: ti.template(), start):
    """The sum over a row of a table: entry ``start + i`` of ``field`` times the four of the row's i-th weights that
    ``pick`` names."""
    total = ti.Vector([0.0, 0.0, 0.0, 0.0])
    first, begin, end = row_of(body, table, row, row)
    entry = start + first
    for k in range(begin, end):
        total += picked(part(body, table).weights[k], pick) * field[entry]
        entry += 1
    return total


@ti.func
def sums(body: ti.template(), table: ti.template(), row, pick: ti.template(), field: ti.template(), start, apart,
         stride, count, closed: ti.template()):
    """That sum for ``ABREAST`` rows side by side, each with its fields ``apart`` behind the one before's; entries
    are ``stride`` apart, and where they are ``closed`` there are ``count`` in all."""
    one, two, three = ti.Vector([0.0] * 4), ti.Vector([0.0] * 4), ti.Vector([0.0] * 4)
    first, begin, end = row_of(body, table, row, row)
    entry, beyond = start + stride * first, start + stride * count
    for k in range(begin, end):
        w = picked(part(body, table).weights[k], pick)
        one += w * field[entry]
        two += w * field[entry + apart]
        three += w * field[entry + 2 * apart]
        entry += stride
        if ti.static(closed):
            entry -= ti.select(entry >= beyond, stride * count, 0)
    return one, two, three


@ti.func
def radial_gather(body: ti.template(), block: ti.template(), pick: ti.template()):
    """Integrals along each radius of a block of the particles' fields, over that of N_b R.

    With ``VALUE`` those of N_b f R; with ``SLOPE_AND_OVER_R`` of N_b' R P e_R and of N_b P e_angle, side by side.
    """
    radii, K, B = body.particles // body.orbits, body.orbits, body.recovered_across
    for group in range(groups(radii)):
        line = first_of(group, radii)
        for b in range(B):
            put(body.recovered_particles, line_at(body, VALUES, line, b), B, sums(
                body, RADIAL_GATHER, b, pick, body.recovered_particles, particle_at(body, block, line * K), K, 1, 0,
                False))


@ti.func
def angular_gather(body: ti.template(), into: ti.template(), pick: ti.template(), closed: ti.template()):
    """A block of the nodes from what the radii gathered: M f with ``ANGULAR_VALUES``; with ``EACH`` the two parts of
    D P, the first vector with N_a and the second with N_a'."""
    radii, B = body.particles // body.orbits, body.recovered_across
    for a in range(body.recovered_count // B):
        for group in range(groups(B)):
            b = first_of(group, B)
            put(body.recovered_nodes, node_at(body, into, a * B + b), 1, sums(
                body, ANGULAR_GATHER, a, pick, body.recovered_particles, line_at(body, VALUES, 0, b), 1, B, radii,
                closed))


@ti.func
def gather_force(body: ti.template(), t, on: ti.template()):
    """M b along the radius, of its parts along e_R and e_Theta; the force at the particles' radii waits where the radii
    will gather."""
    if ti.static(on.body_force != "none"):
        find_force_functions(body.tables, body.table_sizes, body.angular_frequency * t, on)
        for j in range(body.orbits):
            b_j = force_at(body.tables, body.table_sizes, j, on)
            body.recovered_particles[particle_at(body, HALF_SLOPES, j)] = ti.Vector([b_j[0], b_j[1], b_j[0], b_j[1]])
        for b in range(body.recovered_across):
            body.recovered_nodes[node_at(body, FORCE, b)] = row_sum(
                body, RADIAL_GATHER, b, VALUE, body.recovered_particles, particle_at(body, HALF_SLOPES, 0))


@ti.func
def node_force(body: ti.template(), nodes: ti.template(), a, b, closed: ti.template()):
    """M b at node (a, b), in x and y; between symmetry planes a force is radial."""
    push, e = nodes[node_at(body, FORCE, b)], nodes[node_at(body, DIRECTION, a)]
    x, y = push[0] * e[0], push[0] * e[1]
    if ti.static(closed):
        x += push[1] * e[2]
        y += push[1] * e[3]
    return x, y


@ti.func
def smoothing(body: ti.template(), closed: ti.template()):
    """C of the gathered nodal values."""
    B = body.recovered_across
    A = body.recovered_count // B
    for group in range(groups(A)):
        a = first_of(group, A)
        for b in range(B):
            put(body.recovered_nodes, node_at(body, HALF_SMOOTHED, a * B + b), B, sums(
                body, RADIAL_SMOOTHING, b, VALUE, body.recovered_nodes, node_at(body, GATHERED, a * B), B, 1, 0, False))
    for a in range(A):
        for group in range(groups(B)):
            b = first_of(group, B)
            put(body.recovered_nodes, node_at(body, SMOOTHED, a * B + b), 1, sums(
                body, ANGULAR_SMOOTHING, a, ANGULAR_VALUES, body.recovered_nodes, node_at(body, HALF_SMOOTHED, b), 1, B,
                A, closed))


@ti.func
def angular_spread(body: ti.template(), closed: ti.template()):
    """The nodal errors interpolated along the angle, the angular half of sum N_i e_i; and of the first field once more,
    beside its slopes around."""
    B = body.recovered_across
    for line in range(body.particles // body.orbits):
        a, begin, _ = row_of(body, ANGULAR_SPREAD, line, line)
        for b in range(B):
            value, slope = ti.Vector([0.0, 0.0, 0.0, 0.0]), ti.Vector([0.0, 0.0, 0.0, 0.0])
            for k in range(3):
                w, at = part(body, ANGULAR_SPREAD).weights[begin + k], a + k
                if ti.static(closed):
                    at = at % (body.recovered_count // B)
                e = body.recovered_nodes[node_at(body, ERRORS, at * B + b)]
                value += twice(w) * e
                slope += w * twice(e)
            body.recovered_particles[line_at(body, VALUES, line, b)] = value
            body.recovered_particles[line_at(body, SLOPES, line, b)] = slope


@ti.func
def twice(fields):
    """The first of two vectors, side by side."""
    x, y = fields[0], fields[1]
    return ti.Vector([x, y, x, y])


@ti.func
def radial_spread(body: ti.template(), i, j, block: ti.template()):
    """From the angular half of a block, with ``VALUES``: the errors at particle (i, j); with ``SLOPES`` the slopes of
    that of the first field, along the radius and around."""
    b, begin, _ = row_of(body, RADIAL_SPREAD, j, j)
    total = ti.Vector([0.0] * 4)
    for k in range(3):
        w = part(body, RADIAL_SPREAD).weights[begin + k]
        value, slope = w[0], w[1]
        four = ti.Vector([value] * 4)
        if ti.static(block == SLOPES):
            four = ti.Vector([slope, slope, value, value])
        total += four * body.recovered_particles[line_at(body, block, i, b + k)]
    return total


@ti.func
def radial_fit(body: ti.template(), into: ti.template(), pick: ti.template()):
    """The fields recovered along each radius with ``VALUE``, or with ``SLOPE`` their slopes."""
    K = body.orbits
    for group in range(groups(body.particles // K)):
        line = first_of(group, body.particles // K)
        for j in range(K):
            put(body.recovered_particles, particle_at(body, into, line * K + j), K, sums(
                body, RADIAL_FIT, j, pick, body.recovered_particles, particle_at(body, FIELD, line * K), K, 1, 0,
                False))


@ti.func
def angular_fit(body: ti.template(), block: ti.template(), into: ti.template(), pick: ti.template(),
               closed: ti.template()):
    """A block of the particles' fields recovered along the angle: values with ``ANGULAR_VALUES``, slopes with
    ``ANGULAR_SLOPES``; with ``EACH`` values of the first field and slopes of the second."""
    K = body.orbits
    for line in range(body.particles // K):
        for group in range(groups(K)):
            j = first_of(group, K)
            put(body.recovered_particles, particle_at(body, into, line * K + j), 1, sums(
                body, ANGULAR_FIT, line, pick, body.recovered_particles, particle_at(body, block, j), 1, K,
                body.particles // K, closed))


@ti.func
def remember_sizes(body: ti.template(), nodes: ti.template(), closed: ti.template()):
    """Add this turn's fourth differences of U along both lines, and e, to the sums that the verdict looks at."""
    B, rough, size = body.recovered_across, 0.0, 0.0
    A = body.recovered_count // B
    for a in range(A):
        for b in range(B):
            around, along = ti.Vector([0.0, 0.0]), ti.Vector([0.0, 0.0])
            for k in range(5):
                i, j = a + k - 2, ti.min(ti.max(b + k - 2, 0), B - 1)
                x, y = 1.0, 1.0  # signs beyond a plane
                if ti.static(closed):
                    i = (i + A) % A
                else:
                    if i < 0:
                        i, y = -1 - i, -1.0
                    if i >= A:
                        i, x = 2 * A - 1 - i, -1.0
                U, V = nodes[node_at(body, MOTION, i * B + b)], nodes[node_at(body, MOTION, a * B + j)]
                factor = fourth_factor(k)
                around += factor * ti.Vector([x * U[0], y * U[1]])
                along += factor * ti.Vector([V[0], V[1]])
            rough += around.dot(around)
            if b > 1 and b < B - 2:  # nothing lies beyond the free ends
                rough += along.dot(along)
            e = nodes[node_at(body, GATHERED, a * B + b)]
            size += e[0] * e[0] + e[1] * e[1]
    body.recovered_numbers[ROUGH] += rough / body.recovered_count
    body.recovered_numbers[SIZE] += size / body.recovered_count
