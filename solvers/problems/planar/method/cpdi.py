"""The mappings with CPDI: the particle is a parallelogram whose corners carry hat functions.

S = 1/4 sum N(corner); the gradient is that of the corner values, exact over the parallelogram (Sadeghirad, Brannon &
Burghardt 2011). Corners lie at x -+ r1/2 -+ r2/2 with r1, r2 the edges convected by F; corners 3 and 4 are opposite to
1 and 2 and have the opposite gradients.
"""

import taichi as ti

from solvers.problems.planar.layout import CORNERS
from solvers.problems.planar.method.records import force_moment, force_record, scatter_add


@ti.func
def convected_edges(body: ti.template(), p, on: ti.template()):
    """F r1 and F r2, in cells, as (r1x, r1y, r2x, r2y)."""
    r = body.edges[p] * body.cells_per_length
    if ti.static(not on.frozen):
        F = body.deformation_gradient[p]
        r = ti.Vector([F[0] * r[0] + F[1] * r[1], F[2] * r[0] + F[3] * r[1],
                       F[0] * r[2] + F[1] * r[3], F[2] * r[2] + F[3] * r[3]])
    return r


@ti.func
def find_weights(body: ti.template(), p, on: ti.template()):
    """Keep the cell of each corner and its place in it. Vectors of four are of the corners."""
    x = body.position_velocity[p] * body.cells_per_length + body.origin
    if ti.static(on.frozen):
        X = body.material_position[p]
        x = ti.Vector([X[0], X[1], 0.0, 0.0]) * body.cells_per_length + body.origin
    r = convected_edges(body, p, on)
    along_first, along_second = ti.Vector([c[0] for c in CORNERS]), ti.Vector([c[1] for c in CORNERS])
    corner_x = x[0] + along_first * r[0] + along_second * r[2]
    corner_y = x[1] + along_first * r[1] + along_second * r[3]
    # Clamped: a run that goes bad has positions anywhere until the check stops it.
    last = float(body.active - 2)
    i = ti.min(ti.max(ti.floor(corner_x), 0.0), last)
    j = ti.min(ti.max(ti.floor(corner_y), 0.0), last)
    place_x, place_y = corner_x - i, corner_y - j
    body.weights[p] = ti.Vector([place_x[0], place_x[1], place_x[2], place_x[3],
                                 place_y[0], place_y[1], place_y[2], place_y[3]])
    node = j * body.row + i  # whole numbers, exact
    body.corner_nodes[p] = ti.Vector([ti.cast(node[c], ti.i32) for c in ti.static(range(4))])


@ti.func
def corner_gradients(body: ti.template(), p, on: ti.template()):
    """Weights of the values at corners 1 and 2 in d/dx and d/dy: (x of 1, y of 1, x of 2, y of 2), in 1/length."""
    r = convected_edges(body, p, on)
    per = 0.5 * body.cells_per_length / (r[0] * r[3] - r[1] * r[2])
    return per * ti.Vector([r[1] - r[3], r[2] - r[0], r[1] + r[3], -r[0] - r[2]])


@ti.func
def hats(places, c: ti.template()):
    """Hat functions of corner c at its cell's nodes: left and right below, left and right above."""
    x, y = places[c], places[c + 4]
    both = x * y
    return ti.Vector([1 - x - y + both, x - both, y - both, both])


@ti.func
def particles_to_nodes(body: ti.template(), start, end, grid, traits: ti.template(), on: ti.template()):
    """Add mass, momentum and force of the particles from ``start`` to ``end`` to the nodes from ``grid`` on."""
    for p in range(start, end):
        places, cells = body.weights[p], body.corner_nodes[p]
        g = corner_gradients(body, p, on)
        carried, tau = force_moment(body, p, traits, on)
        carried = 0.25 * carried
        for c in ti.static(range(4)):
            a, b = ti.static(2 * (c % 2), -1.0 if c < 2 else 1.0)
            pull = force_record(g[a] * tau[0] + g[a + 1] * tau[1], g[a] * tau[2] + g[a + 1] * tau[3])
            sums = carried + b * pull
            N = hats(places, c)
            first = grid + cells[c]
            for k in ti.static(range(4)):
                scatter_add(body.node_sums, first + (k // 2) * body.row + k % 2, N[k] * sums)


@ti.func
def gather(body: ti.template(), p, values: ti.template(), on: ti.template()):
    """The nodes' values, four numbers, at the particle and their derivatives in x and y."""
    places, cells = body.weights[p], body.corner_nodes[p]
    g = corner_gradients(body, p, on)
    total, first_pair, second_pair = ti.Vector([0.0] * 4), ti.Vector([0.0] * 4), ti.Vector([0.0] * 4)
    for c in ti.static(range(4)):
        N = hats(places, c)
        node = cells[c]
        value = N[0] * values[node] + N[1] * values[node + 1] \
            + N[2] * values[node + body.row] + N[3] * values[node + body.row + 1]
        total += value
        sign = ti.static(1.0 if c < 2 else -1.0)
        if ti.static(c % 2 == 0):
            first_pair += sign * value
        else:
            second_pair += sign * value
    return 0.25 * total, g[0] * first_pair + g[2] * second_pair, g[1] * first_pair + g[3] * second_pair


@ti.func
def scatter(body: ti.template(), p, carried, values: ti.template()):
    """Add four numbers of the particle to the nodes' values, with its weights."""
    places, cells = body.weights[p], body.corner_nodes[p]
    for c in ti.static(range(4)):
        N = hats(places, c)
        for k in ti.static(range(4)):
            scatter_add(values, cells[c] + (k // 2) * body.row + k % 2, 0.25 * N[k] * carried)
