"""The mappings with separable stencils: hat, uGIMP and cpGIMP, 3 x 3 nodes a particle."""

import taichi as ti

from solvers.kernels.shape_functions import complete_stencil, outer_weights
from solvers.kernels.simd import load_component
from solvers.problems.planar.method.node_records import force_record, particle_contribution, scatter_add
from solvers.problems.planar.method.stored_weights import store_weight_part, stored_weight_entries
from solvers.problems.planar.particle_layout import MOST_HALF_WIDTH


@ti.func
def half_widths(body: ti.template(), some: ti.template(), c: ti.template(), on: ti.template()):
    """Returns half the widths of the particles' (``some``) boxes in x (``c`` = 0) or y (1), in cells: constant for
    uGIMP, stretched by |F_xx| or |F_yy| for cpGIMP, for its variant by V_xx or V_yy of V = sqrt(F F^T) = (b + J I)/
    sqrt(tr b + 2 J), b = F F^T, by Cayley and Hamilton."""
    widths = ti.Vector([body.half_width for _ in ti.static(range(some.n))])
    if ti.static(on.method == "cpgimp" and not on.frozen):
        stretched = body.half_width * load_component(body.deformation_gradient, some, 3 * c)
        # Below 0 where the particle has turned by 90 degrees.
        widths = ti.min(ti.max(ti.max(stretched, -1.0 * stretched), 1e-6), MOST_HALF_WIDTH)
    if ti.static(on.method == "cpgimp-v" and not on.frozen):
        xx, xy, yx, yy = [load_component(body.deformation_gradient, some, k) for k in ti.static(range(4))]
        b_xx, b_yy, J = xx * xx + xy * xy, yx * yx + yy * yy, xx * yy - xy * yx
        J = ti.max(J, -1.0 * J)
        stretch = ((b_yy if c else b_xx) + J) / ti.sqrt(b_xx + b_yy + 2 * J)
        widths = ti.min(ti.max(body.half_width * stretch, 1e-6), MOST_HALF_WIDTH)
    return widths


@ti.func
def find_weights(body: ti.template(), some: ti.template(), on: ti.template()):
    """Stores ``first_node`` and weights of a block of particles ``some`` for both mappings of the step."""
    x, y = stencil_along(body, some, 0, on), stencil_along(body, some, 1, on)
    # Positions of an unstable run are arbitrary: stay inside the arrays until the check stops it.
    last = float(body.active - 3)
    node = ti.min(ti.max(y[0], 0.0), last) * float(body.row) + ti.min(ti.max(x[0], 0.0), last)
    for k in ti.static(range(some.n)):
        body.first_node[some[k]] = ti.cast(node[k], ti.i32)  # whole numbers, exact
    store_weight_part(body, some[0], 0, [x[1], y[1], x[2], y[2], x[3], y[3], x[4], y[4]], on)


@ti.func
def stencil_along(body: ti.template(), some: ti.template(), c: ti.template(), on: ti.template()):
    """Returns first node, two outer weights and slopes (per m) of particles ``some`` in x (``c`` = 0) or y (1)."""
    per = body.cells_per_length
    position = load_component(body.position_velocity, some, c)
    if ti.static(on.frozen):
        position = load_component(body.material_position, some, c)
    first, left, right, slope_left, slope_right = outer_weights(
        on.method, position * per + body.origin, half_widths(body, some, c, on))
    return first, left, right, slope_left * per, slope_right * per


@ti.func
def stored_stencils(body: ti.template(), p, on: ti.template()):
    """Returns the stored stencils of particle p: weights and slopes (per m) at three nodes in x, then in y."""
    w, = ti.static([stored_weight_entries(body, p, on)])
    S, dS = complete_stencil(w[0], w[2], w[4], w[6])
    R, dR = complete_stencil(w[1], w[3], w[5], w[7])
    return S, dS, R, dR


@ti.func
def particles_to_nodes(body: ti.template(), start, end, grid, traits: ti.template(), on: ti.template()):
    """Adds mass, momentum and force of particles ``start`` up to ``end`` to ``node_sums`` of nodes from ``grid`` on."""
    for p in range(start, end):
        S, dS, R, dR = stored_stencils(body, p, on)
        first = grid + body.first_node[p]
        carried, tau = particle_contribution(body, p, traits, on)
        along_x = force_record(-tau[0], -tau[2])
        along_y = force_record(-tau[1], -tau[3])
        for j in ti.static(range(3)):
            level = R[j] * carried + dR[j] * along_y
            slope = R[j] * along_x
            for i in ti.static(range(3)):
                scatter_add(body.node_sums, first + j * body.row + i, S[i] * level + dS[i] * slope)


@ti.func
def gather(body: ti.template(), p, values: ti.template(), on: ti.template()):
    """Returns nodal ``values``, vectors of four, interpolated to particle p, and their x and y derivatives (per m)."""
    S, dS, R, dR = stored_stencils(body, p, on)
    first = body.first_node[p]
    here, by_x, by_y = ti.Vector([0.0] * 4), ti.Vector([0.0] * 4), ti.Vector([0.0] * 4)
    for i in ti.static(range(3)):
        n0 = values[first + i]
        n1 = values[first + body.row + i]
        n2 = values[first + 2 * body.row + i]
        column = R[0] * n0 + R[1] * n1 + R[2] * n2
        here += S[i] * column
        by_x += dS[i] * column
        by_y += S[i] * (dR[0] * n0 + dR[1] * n1 + dR[2] * n2)
    return here, by_x, by_y


@ti.func
def scatter(body: ti.template(), p, carried, values: ti.template(), on: ti.template()):
    """Adds the vector of four ``carried`` of particle p to the nodal ``values``, times its weights."""
    S, _, R, _ = stored_stencils(body, p, on)
    first = body.first_node[p]
    for j in ti.static(range(3)):
        for i in ti.static(range(3)):
            scatter_add(values, first + j * body.row + i, S[i] * R[j] * carried)
