"""The mappings with CPDI: the particle is a parallelogram whose corners carry hat functions.

S = 1/4 sum N(corner); the gradient is that of the corner values, exact over the parallelogram (Sadeghirad, Brannon &
Burghardt 2011). Corners lie at x -+ r1/2 -+ r2/2 with r1, r2 the edges convected by F; corners 3 and 4 are opposite to
1 and 2 and have the opposite gradients.
"""

import taichi as ti

from solvers.kernels.simd import load_component
from solvers.problems.planar.method.node_records import force_record, particle_contribution, scatter_add
from solvers.problems.planar.method.stored_weights import store_weight_part, stored_weight_entries
from solvers.problems.planar.particle_layout import CORNERS

#: Of what is kept, the first of four: beside those, the places of the corners in x and in y.
GRADIENTS, NODES = 8, 12


@ti.func
def find_weights(body: ti.template(), some: ti.template(), on: ti.template()):
    """Stores, for a block of particles ``some``, each corner's cell, its place in it, and the corners' gradients."""
    per = body.cells_per_length
    x, y = load_component(body.position_velocity, some, 0), load_component(body.position_velocity, some, 1)
    if ti.static(on.frozen):
        x, y = load_component(body.material_position, some, 0), load_component(body.material_position, some, 1)
    x, y = x * per + body.origin, y * per + body.origin
    ax, ay, bx, by = [load_component(body.edges, some, k) * per for k in ti.static(range(4))]
    if ti.static(not on.frozen):
        xx, xy, yx, yy = [load_component(body.deformation_gradient, some, k) for k in ti.static(range(4))]
        ax, ay, bx, by = xx * ax + xy * ay, yx * ax + yy * ay, xx * bx + xy * by, yx * bx + yy * by
    last = float(body.active - 2)
    # Clamped: positions of an unstable run are arbitrary until the check stops it.
    corner_x = [x + CORNERS[c][0] * ax + CORNERS[c][1] * bx for c in ti.static(range(4))]
    corner_y = [y + CORNERS[c][0] * ay + CORNERS[c][1] * by for c in ti.static(range(4))]
    i = [ti.min(ti.max(ti.floor(corner_x[c]), 0.0), last) for c in ti.static(range(4))]
    j = [ti.min(ti.max(ti.floor(corner_y[c]), 0.0), last) for c in ti.static(range(4))]
    store_weight_part(body, some[0], 0, [corner_x[0] - i[0], corner_x[1] - i[1], corner_x[2] - i[2], corner_x[3] - i[3],
                                         corner_y[0] - j[0], corner_y[1] - j[1], corner_y[2] - j[2],
                                         corner_y[3] - j[3]], on)
    half, row = 0.5 * per / (ax * by - ay * bx), float(body.row)
    store_weight_part(body, some[0], 1, [half * (ay - by), half * (bx - ax), half * (ay + by), half * (-1.0 * ax - bx),
                                         j[0] * row + i[0], j[1] * row + i[1], j[2] * row + i[2], j[3] * row + i[3]],
                      on)


@ti.func
def corner_cell_nodes(w: ti.template()):
    """Returns the four corners' cells' first nodes from a particle's stored numbers ``w``, as integers."""
    return [ti.cast(w[NODES + c], ti.i32) for c in ti.static(range(4))]


@ti.func
def corner_gradients(body: ti.template(), p, on: ti.template()):
    """Returns the weights of particle p's corners 1 and 2 in d/dx and d/dy: (x of 1, y of 1, x of 2, y of 2), 1/m."""
    r = body.edges[p] * body.cells_per_length  # r1 and r2, or F r1 and F r2, in cells
    if ti.static(not on.frozen):
        F = body.deformation_gradient[p]
        r = ti.Vector([F[0] * r[0] + F[1] * r[1], F[2] * r[0] + F[3] * r[1],
                       F[0] * r[2] + F[1] * r[3], F[2] * r[2] + F[3] * r[3]])
    per = 0.5 * body.cells_per_length / (r[0] * r[3] - r[1] * r[2])
    return per * ti.Vector([r[1] - r[3], r[2] - r[0], r[1] + r[3], -r[0] - r[2]])


@ti.func
def stored_gradients(body: ti.template(), p, w: ti.template(), on: ti.template()):
    """Returns :func:`corner_gradients` of particle p as stored in ``w``, for F at the start of the step; with the
    stabilisation "coupled-deformation", for the present F."""
    g = [w[GRADIENTS + k] for k in ti.static(range(4))]
    if ti.static(on.coupled):
        g = corner_gradients(body, p, on)
    return g


@ti.func
def corner_hats(w: ti.template(), c: ti.template()):
    """Returns corner c's hat functions at its cell's nodes, from stored ``w``: left and right below, then above."""
    x, y = w[c], w[c + 4]
    both = x * y
    return ti.Vector([1 - x - y + both, x - both, y - both, both])


@ti.func
def particles_to_nodes(body: ti.template(), start, end, grid, traits: ti.template(), on: ti.template()):
    """Adds mass, momentum and force of particles ``start`` up to ``end`` to ``node_sums`` of nodes from ``grid`` on."""
    for p in range(start, end):
        w, = ti.static([stored_weight_entries(body, p, on)])
        cells, g = corner_cell_nodes(w), stored_gradients(body, p, w, on)
        carried, tau = particle_contribution(body, p, traits, on)
        carried = 0.25 * carried
        for c in ti.static(range(4)):
            a, b = ti.static(2 * (c % 2), -1.0 if c < 2 else 1.0)
            pull = force_record(g[a] * tau[0] + g[a + 1] * tau[1], g[a] * tau[2] + g[a + 1] * tau[3])
            sums = carried + b * pull
            N = corner_hats(w, c)
            first = grid + cells[c]
            for k in ti.static(range(4)):
                scatter_add(body.node_sums, first + (k // 2) * body.row + k % 2, N[k] * sums)


@ti.func
def gather(body: ti.template(), p, values: ti.template(), on: ti.template()):
    """Returns nodal ``values``, vectors of four, interpolated to particle p, and their x and y derivatives (per m)."""
    w, = ti.static([stored_weight_entries(body, p, on)])
    cells, g = corner_cell_nodes(w), stored_gradients(body, p, w, on)
    total, first_pair, second_pair = ti.Vector([0.0] * 4), ti.Vector([0.0] * 4), ti.Vector([0.0] * 4)
    for c in ti.static(range(4)):
        N = corner_hats(w, c)
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
def scatter(body: ti.template(), p, carried, values: ti.template(), on: ti.template()):
    """Adds the vector of four ``carried`` of particle p to the nodal ``values``, times its weights."""
    w, = ti.static([stored_weight_entries(body, p, on)])
    cells = corner_cell_nodes(w)
    for c in ti.static(range(4)):
        N = corner_hats(w, c)
        for k in ti.static(range(4)):
            scatter_add(values, cells[c] + (k // 2) * body.row + k % 2, 0.25 * N[k] * carried)
