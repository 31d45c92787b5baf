"""The mappings with separable stencils: hat, uGIMP and cpGIMP, 3 x 3 nodes a particle."""

import taichi as ti

from solvers.kernels.shapes import outer_weights, stencil
from solvers.problems.planar.layout import MOST_HALF_WIDTH
from solvers.problems.planar.method.records import force_moment, force_record, scatter_add


@ti.func
def half_widths(body: ti.template(), p, on: ti.template()):
    """Half the particle's box in x and y, in cells: constant for uGIMP, stretched by |F_xx| and |F_yy| for cpGIMP, by
    those of V = sqrt(F F^T) for its variant (b + J I)/sqrt(tr b + 2 J), b = F F^T, by Cayley and Hamilton."""
    widths = ti.Vector([body.half_width, body.half_width])
    if ti.static(on.method == "cpgimp" and not on.frozen):
        F = body.deformation_gradient[p]
        stretched = body.half_width * ti.Vector([F[0], F[3]])  # below 0 where the particle has turned by 90 degrees
        widths = ti.min(ti.max(ti.max(stretched, -1.0 * stretched), 1e-6), MOST_HALF_WIDTH)
    if ti.static(on.method == "cpgimp-v" and not on.frozen):
        F = body.deformation_gradient[p]
        b = ti.Vector([F[0] * F[0] + F[1] * F[1], F[2] * F[2] + F[3] * F[3]])
        J = ti.abs(F[0] * F[3] - F[1] * F[2])
        stretch = (b + J) / ti.sqrt(b[0] + b[1] + 2 * J)
        widths = ti.min(ti.max(body.half_width * stretch, 1e-6), MOST_HALF_WIDTH)
    return widths


@ti.func
def find_weights(body: ti.template(), p, on: ti.template()):
    """Keep the particle's stencils for both mappings of the step. Vectors of two are of x and y."""
    q, per = body.position_velocity[p], body.cells_per_length
    position = ti.Vector([q[0], q[1]]) * per + body.origin
    if ti.static(on.frozen):
        position = body.material_position[p] * per + body.origin
    first, left, right, slope_left, slope_right = outer_weights(on.method, position, half_widths(body, p, on))
    # A run that goes bad has positions anywhere: stay inside the arrays until the check stops it.
    node = ti.min(ti.max(first, 0.0), float(body.active - 3))
    body.first_node[p] = ti.cast(node[1] * body.row + node[0], ti.i32)  # whole numbers, exact
    slope_left, slope_right = slope_left * per, slope_right * per
    body.weights[p] = ti.Vector([left[0], left[1], right[0], right[1],
                                 slope_left[0], slope_left[1], slope_right[0], slope_right[1]])


@ti.func
def stencils_of(body: ti.template(), p):
    """The kept stencils: weights and gradients (1/length) at three nodes in x and in y."""
    w = body.weights[p]
    S, dS = stencil(w[0], w[2], w[4], w[6])
    R, dR = stencil(w[1], w[3], w[5], w[7])
    return S, dS, R, dR


@ti.func
def particles_to_nodes(body: ti.template(), start, end, grid, traits: ti.template(), on: ti.template()):
    """Add mass, momentum and force of the particles from ``start`` to ``end`` to the nodes from ``grid`` on."""
    for p in range(start, end):
        S, dS, R, dR = stencils_of(body, p)
        first = grid + body.first_node[p]
        carried, tau = force_moment(body, p, traits, on)
        along_x = force_record(-tau[0], -tau[2])
        along_y = force_record(-tau[1], -tau[3])
        for j in ti.static(range(3)):
            level = R[j] * carried + dR[j] * along_y
            slope = R[j] * along_x
            for i in ti.static(range(3)):
                scatter_add(body.node_sums, first + j * body.row + i, S[i] * level + dS[i] * slope)


@ti.func
def gather(body: ti.template(), p, values: ti.template()):
    """The nodes' values, four numbers, at the particle and their derivatives in x and y."""
    S, dS, R, dR = stencils_of(body, p)
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
def scatter(body: ti.template(), p, carried, values: ti.template()):
    """Add four numbers of the particle to the nodes' values, with its weights."""
    S, _, R, _ = stencils_of(body, p)
    first = body.first_node[p]
    for j in ti.static(range(3)):
        for i in ti.static(range(3)):
            scatter_add(values, first + j * body.row + i, S[i] * R[j] * carried)
