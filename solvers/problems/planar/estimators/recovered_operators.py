"""The recovered estimator's operators on a lattice of particles: each along its lines first, then across them, or back.

Lines are the radii of a polar lattice or the rows of a square. Particle (i, j), the j-th on the i-th line, is number
i K + j; node (a, b) of the error grid is number a B + b. Fields are two vectors side by side, (x, y, x, y). Weights
come for x and y where a symmetry plane mirrors them differently: (value x, value y, slope x, slope y).
"""

from typing import NamedTuple

import taichi as ti

from solvers.estimators import recovered_common
from solvers.estimators.recovered_common import ROUGH, SIZE, first_in_group, group_count, store_sums, table_row_range
from solvers.kernels.packing import prefix_view
from solvers.solver.separable_field_tables import body_force_at, compute_force_time_functions

# Tables. Along a radius their weights are (value, slope, value over R, nothing).
TABLES = tuple(f"recovered_{way}_{what}_" for way in ("across", "along")
               for what in ("fit", "spread", "gather", "smoothing"))
ACROSS_FIT, ACROSS_INTERPOLATION, ACROSS_PROJECTION, ACROSS_SMOOTHING = TABLES[:4]
ALONG_FIT, ALONG_INTERPOLATION, ALONG_PROJECTION, ALONG_SMOOTHING = TABLES[4:]

#: Blocks of the nodal array: U and w in the middle of the next H; a and the one before; errors as gathered; smoothed
#: along the radius, and both ways; unsmoothed; M b along the radius, with unit directions; M e_R and M e_Theta along
#: the angle; a two steps before.
MOTION, RATE, PROJECTED, HALF_SMOOTHED, SMOOTHED, ERRORS, FORCE, DIRECTION, BEFORE = range(9)
NODE_BLOCKS = 9
#: Blocks of the particle array: two vector fields; what was fitted to them along the radius, and then around; of the
#: first the slope along the radius and the value, fitted there, and then its slopes along the radius and around.
FIELD, HALF_FITTED, FITTED, HALF_SLOPES, FITTED_SLOPES = range(5)
PARTICLE_BLOCKS = 5
VALUES, SLOPES = 0, 1  # blocks behind these, of radii with nodes on them
STRESS = 1  # P e_R and P e_angle, in the place of what is fitted only for reports

#: Which of a weight's four numbers two vectors (x, y, x, y) are taken times.
PAIR_VALUES, PAIR_SLOPES, EACH = (0, 1, 0, 1), (2, 3, 2, 3), (0, 1, 2, 3)


@ti.func
def store_tabulated_body_force(body: ti.template(), t, on: ti.template()):
    """Stores the body force at t s at its points, twice side by side, in the particles' block HALF_SLOPES."""
    compute_force_time_functions(body.tables, body.table_sizes, body.angular_frequency * t, on)
    for k in range(body.orbits):
        b = body_force_at(body.tables, body.table_sizes, k, on)
        body.recovered_particles[particle_index(body, HALF_SLOPES, k)] = ti.Vector([b[0], b[1], b[0], b[1]])


class LatticeKernelOptions(NamedTuple):
    """Compile-time description of the particles' lattice, and which of a weight's four numbers along a line multiply
    the components of two vectors (x, y, x, y), for values or slopes."""

    closed: bool = False  # a whole turn: the first line comes after the last
    box: bool = False  # the rows of a rectangle; else radii
    planes: bool = True  # whether a symmetry plane is at all four sides of a box; else nothing lies beyond them
    value: tuple[int, ...] = (0, 0, 0, 0)
    slope: tuple[int, ...] = (1, 1, 1, 1)
    slope_value: tuple[int, ...] = (1, 1, 0, 0)  # slopes of the first vector, values of the second
    slope_metric: tuple[int, ...] = (1, 1, 2, 2)  # and values over the radius
    store_body_force: object = store_tabulated_body_force


BOX = LatticeKernelOptions(box=True, value=PAIR_VALUES, slope=PAIR_SLOPES, slope_value=(2, 3, 0, 1),
                           slope_metric=(2, 3, 0, 1))


@ti.func
def node_index(body: ti.template(), block: ti.template(), i):
    """Returns the index of node i in a block (MOTION, RATE, ...) of ``recovered_nodes``."""
    return block * body.recovered_count + i


@ti.func
def line_node_index(body: ti.template(), block: ti.template(), line, b):
    """Returns the index in ``recovered_particles`` of node b on a line of particles, in the block VALUES or SLOPES."""
    radii = body.particles // body.recovered_line
    return PARTICLE_BLOCKS * body.particles + (block * radii + line) * body.recovered_line_nodes + b


@ti.func
def particle_index(body: ti.template(), block: ti.template(), p):
    """Returns the index of particle p in a block (FIELD, FITTED, ...) of ``recovered_particles``."""
    return block * body.particles + p


@ti.func
def pick_weights(weight, pick: ti.template()):
    """Returns the four entries with the indices ``pick`` of a vector ``weight``."""
    ready = weight
    if ti.static(pick != EACH):
        first, third = weight[pick[0]], weight[pick[2]]
        if ti.static(pick[0] == pick[1]):
            ready = ti.Vector([first, first, third, third])
        else:
            ready = ti.Vector([first, weight[pick[1]], third, weight[pick[3]]])
    return ready


@ti.func
def row_sum(body: ti.template(), table: ti.template(), row, pick: ti.template(), field: ti.template(), start):
    """Returns the sum (4,) of a table's row: entries of ``field`` from ``start`` on, as the row says, times the entries
    ``pick`` of its weights."""
    total = ti.Vector([0.0, 0.0, 0.0, 0.0])
    first, begin, end = table_row_range(body, table, row, row)
    entry = start + first
    for k in range(begin, end):
        total += pick_weights(prefix_view(body, table).weights[k], pick) * field[entry]
        entry += 1
    return total


@ti.func
def row_sums(body: ti.template(), table: ti.template(), row, pick: ti.template(), field: ti.template(), start, apart,
             stride, count, closed: ti.template()):
    """Returns :func:`row_sum` for ``ROWS_PER_GROUP`` lines side by side, which begin ``apart`` entries apart; a line's
    entries are ``stride`` apart, and ``count`` in all where it is ``closed``."""
    one, two, three = ti.Vector([0.0] * 4), ti.Vector([0.0] * 4), ti.Vector([0.0] * 4)
    first, begin, end = table_row_range(body, table, row, row)
    entry, beyond = start + stride * first, start + stride * count
    for k in range(begin, end):
        w = pick_weights(prefix_view(body, table).weights[k], pick)
        one += w * field[entry]
        two += w * field[entry + apart]
        three += w * field[entry + 2 * apart]
        entry += stride
        if ti.static(closed):
            entry -= ti.select(entry >= beyond, stride * count, 0)
    return one, two, three


@ti.func
def project_along_lines(body: ti.template(), block: ti.template(), pick: ti.template()):
    """Stores integrals along each line of a block of the particles' fields, on a radius over that of N_b R: if ``pick``
    is ``value``, of N_b f R; if ``slope_metric``, of N_b' R P e_R and of N_b P e_angle, side by side."""
    radii, K, B = body.particles // body.recovered_line, body.recovered_line, body.recovered_line_nodes
    for group in range(group_count(radii)):
        line = first_in_group(group, radii)
        for b in range(B):
            store_sums(body.recovered_particles, line_node_index(body, VALUES, line, b), B, row_sums(
                body, ALONG_PROJECTION, b, pick, body.recovered_particles, particle_index(body, block, line * K), K, 1,
                0, False))


@ti.func
def project_across_lines(body: ti.template(), into: ti.template(), pick: ti.template(), lattice: ti.template()):
    """Stores the block ``into`` of the nodes from the lines' integrals: M f if ``pick`` is ``PAIR_VALUES``; if ``EACH``
    the two parts of D P, the first vector with N_a and the second with N_a'."""
    radii, B = body.particles // body.recovered_line, body.recovered_line_nodes
    for a in range(body.recovered_count // B):
        for group in range(group_count(B)):
            b = first_in_group(group, B)
            store_sums(body.recovered_nodes, node_index(body, into, a * B + b), 1, row_sums(
                body, ACROSS_PROJECTION, a, pick, body.recovered_particles, line_node_index(body, VALUES, 0, b), 1, B,
                radii, lattice.closed))


@ti.func
def project_body_force(body: ti.template(), t, lattice: ti.template(), on: ti.template()):
    """Stores M b at t s: of a box at the nodes; else along the radius, of its parts along e_R and e_Theta."""
    if ti.static(on.body_force != "none"):
        lattice.store_body_force(body, t, on)
        if ti.static(lattice.box):
            project_along_lines(body, HALF_SLOPES, lattice.value)
            project_across_lines(body, FORCE, PAIR_VALUES, lattice)
        else:
            for b in range(body.recovered_line_nodes):
                body.recovered_nodes[node_index(body, FORCE, b)] = row_sum(
                    body, ALONG_PROJECTION, b, lattice.value, body.recovered_particles,
                    particle_index(body, HALF_SLOPES, 0))


@ti.func
def nodal_body_force(body: ti.template(), nodes: ti.template(), a, b, lattice: ti.template()):
    """Returns M b (m/s^2) at node (a, b), in x and y; between the symmetry planes of a ring a force is radial."""
    x, y = 0.0, 0.0
    if ti.static(lattice.box):
        push = nodes[node_index(body, FORCE, a * body.recovered_line_nodes + b)]
        x, y = push[0], push[1]
    else:
        push, e = nodes[node_index(body, FORCE, b)], nodes[node_index(body, DIRECTION, a)]
        x, y = push[0] * e[0], push[0] * e[1]
        if ti.static(lattice.closed):
            x += push[1] * e[2]
            y += push[1] * e[3]
    return x, y


@ti.func
def smooth_nodes(body: ti.template(), lattice: ti.template()):
    """Stores C times the nodes' block PROJECTED in SMOOTHED; C is what spreading and gathering does to nodal values."""
    B = body.recovered_line_nodes
    A = body.recovered_count // B
    for group in range(group_count(A)):
        a = first_in_group(group, A)
        for b in range(B):
            store_sums(body.recovered_nodes, node_index(body, HALF_SMOOTHED, a * B + b), B, row_sums(
                body, ALONG_SMOOTHING, b, lattice.value, body.recovered_nodes, node_index(body, PROJECTED, a * B), B, 1,
                0, False))
    for a in range(A):
        for group in range(group_count(B)):
            b = first_in_group(group, B)
            store_sums(body.recovered_nodes, node_index(body, SMOOTHED, a * B + b), 1, row_sums(
                body, ACROSS_SMOOTHING, a, PAIR_VALUES, body.recovered_nodes, node_index(body, HALF_SMOOTHED, b), 1, B,
                A, lattice.closed))


@ti.func
def interpolate_across_lines(body: ti.template(), lattice: ti.template()):
    """Stores the nodal errors interpolated across the lines, half of sum N_i e_i, in VALUES; and of the first field
    these and its slopes across in SLOPES."""
    B = body.recovered_line_nodes
    for line in range(body.particles // body.recovered_line):
        a, begin, _ = table_row_range(body, ACROSS_INTERPOLATION, line, line)
        for b in range(B):
            value, slope = ti.Vector([0.0, 0.0, 0.0, 0.0]), ti.Vector([0.0, 0.0, 0.0, 0.0])
            for k in range(3):
                w, at = prefix_view(body, ACROSS_INTERPOLATION).weights[begin + k], a + k
                if ti.static(lattice.closed):
                    at = at % (body.recovered_count // B)
                e = body.recovered_nodes[node_index(body, ERRORS, at * B + b)]
                value += repeat_first_vector(w) * e
                slope += w * repeat_first_vector(e)
            body.recovered_particles[line_node_index(body, VALUES, line, b)] = value
            body.recovered_particles[line_node_index(body, SLOPES, line, b)] = slope


@ti.func
def repeat_first_vector(fields):
    """Returns the first two components of ``fields``, twice."""
    x, y = fields[0], fields[1]
    return ti.Vector([x, y, x, y])


@ti.func
def interpolate_along_line(body: ti.template(), i, j, block: ti.template(), pick: ti.template()):
    """Returns at particle (i, j), from the results of :func:`interpolate_across_lines`, the errors of both fields
    (``VALUES``, ``value``) or the slopes along the line and across of the first's (``SLOPES``, ``slope_value``)."""
    b, begin, _ = table_row_range(body, ALONG_INTERPOLATION, j, j)
    total = ti.Vector([0.0] * 4)
    for k in range(3):
        total += pick_weights(prefix_view(body, ALONG_INTERPOLATION).weights[begin + k], pick) \
            * body.recovered_particles[line_node_index(body, block, i, b + k)]
    return total


@ti.func
def fit_along_lines(body: ti.template(), into: ti.template(), pick: ti.template()):
    """Stores the particles' block FIELD, fitted along each line, in the block ``into``: values if ``pick`` is the
    lattice's ``value``, slopes if ``slope``."""
    K = body.recovered_line
    for group in range(group_count(body.particles // K)):
        line = first_in_group(group, body.particles // K)
        for j in range(K):
            store_sums(body.recovered_particles, particle_index(body, into, line * K + j), K, row_sums(
                body, ALONG_FIT, j, pick, body.recovered_particles, particle_index(body, FIELD, line * K), K, 1, 0,
                False))


@ti.func
def fit_across_lines(body: ti.template(), block: ti.template(), into: ti.template(), pick: ti.template(),
                     lattice: ti.template()):
    """Stores a ``block`` of the particles' fields fitted across the lines in ``into``: values if ``pick`` is
    ``PAIR_VALUES``, slopes if ``PAIR_SLOPES``; if ``EACH``, values of the first field and slopes of the second."""
    K = body.recovered_line
    for line in range(body.particles // K):
        for group in range(group_count(K)):
            j = first_in_group(group, K)
            store_sums(body.recovered_particles, particle_index(body, into, line * K + j), 1, row_sums(
                body, ACROSS_FIT, line, pick, body.recovered_particles, particle_index(body, block, j), 1, K,
                body.particles // K, lattice.closed))


@ti.func
def add_verdict_sums(body: ti.template(), nodes: ti.template(), lattice: ti.template()):
    """Adds the mean squares of U's fourth differences along and across lines, and of e, to ROUGH and SIZE, in m^2."""
    B, rough, size = body.recovered_line_nodes, 0.0, 0.0
    A = body.recovered_count // B
    for a in range(A):
        for b in range(B):
            around, along = ti.Vector([0.0, 0.0]), ti.Vector([0.0, 0.0])
            for k in range(5):
                i, j = a + k - 2, b + k - 2
                x, y, x_along = 1.0, 1.0, 1.0  # signs beyond a plane
                if ti.static(not lattice.planes):
                    i = ti.min(ti.max(i, 0), A - 1)
                elif ti.static(lattice.box):
                    if i < 0 or i >= A:
                        i, y = ti.select(i < 0, -1 - i, 2 * A - 1 - i), -1.0
                    if j < 0 or j >= B:
                        j, x_along = ti.select(j < 0, -1 - j, 2 * B - 1 - j), -1.0
                elif ti.static(lattice.closed):
                    i = (i + A) % A
                else:
                    if i < 0:
                        i, y = -1 - i, -1.0
                    if i >= A:
                        i, x = 2 * A - 1 - i, -1.0
                j = ti.min(ti.max(j, 0), B - 1)
                U, V = nodes[node_index(body, MOTION, i * B + b)], nodes[node_index(body, MOTION, a * B + j)]
                factor = recovered_common.fourth_difference_weight(k)
                around += factor * ti.Vector([x * U[0], y * U[1]])
                along += factor * ti.Vector([x_along * V[0], V[1]])
            if ti.static(lattice.planes) or (a > 1 and a < A - 2):  # nothing lies beyond free ends
                rough += around.dot(around)
            if ti.static(lattice.box and lattice.planes) or (b > 1 and b < B - 2):
                rough += along.dot(along)
            e = nodes[node_index(body, PROJECTED, a * B + b)]
            size += e[0] * e[0] + e[1] * e[1]
    body.recovered_numbers[ROUGH] += rough / body.recovered_count
    body.recovered_numbers[SIZE] += size / body.recovered_count
