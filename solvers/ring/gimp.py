"""The ring's mappings with separable stencils: hat, uGIMP and cpGIMP, 3 x 3 nodes a particle."""

import taichi as ti

from solvers.ring.layout import GHOSTS, MOST_HALF_WIDTH
from solvers.ring.material import force_moment, force_record
from solvers.shapes import outer_weights, stencil


@ti.func
def half_widths(ring: ti.template(), p, on: ti.template()):
    """Half the particle's box in x and y, in cells: constant for uGIMP, stretched by F_xx and F_yy for cpGIMP."""
    widths = ti.Vector([ring.half_width, ring.half_width])
    if ti.static(on.method == "cpgimp" and not on.frozen):
        F = ring.deformation_gradient[p]
        widths = ti.min(ti.max(ring.half_width * ti.Vector([F[0], F[3]]), 1e-6), MOST_HALF_WIDTH)
    return widths


@ti.func
def find_weights(ring: ti.template(), p, on: ti.template()):
    """Keep the particle's stencils for both mappings of the step. Vectors of two are of x and y."""
    q, per = ring.motion[p], ring.cells_per_length
    position = ti.Vector([q[0], q[1]]) * per + GHOSTS
    if ti.static(on.frozen):
        position = ring.material_position[p] * per + GHOSTS
    first, left, right, slope_left, slope_right = outer_weights(on.method, position, half_widths(ring, p, on))
    # A run that goes bad has positions anywhere: stay inside the arrays until the check stops it.
    node = ti.min(ti.max(first, 0.0), float(ring.active - 3))
    ring.first_node[p] = ti.cast(node[1] * ring.row + node[0], ti.i32)  # whole numbers, exact
    slope_left, slope_right = slope_left * per, slope_right * per
    ring.weights[p] = ti.Vector([left[0], left[1], right[0], right[1],
                                 slope_left[0], slope_left[1], slope_right[0], slope_right[1]])


@ti.func
def stencils_of(ring: ti.template(), p):
    """The kept stencils: weights and gradients (1/length) at three nodes in x and in y."""
    w = ring.weights[p]
    S, dS = stencil(w[0], w[2], w[4], w[6])
    R, dR = stencil(w[1], w[3], w[5], w[7])
    return S, dS, R, dR


@ti.func
def particles_to_nodes(ring: ti.template(), start, end, grid, on: ti.template()):
    """Add mass, momentum and force of the particles from ``start`` to ``end`` to the nodes from ``grid`` on."""
    for p in range(start, end):
        S, dS, R, dR = stencils_of(ring, p)
        first = grid + ring.first_node[p]
        carried, tau = force_moment(ring, p, on)
        along_x = force_record(-tau[0], -tau[2])
        along_y = force_record(-tau[1], -tau[3])
        for j in ti.static(range(3)):
            level = R[j] * carried + dR[j] * along_y
            slope = R[j] * along_x
            for i in ti.static(range(3)):
                node = first + j * ring.row + i
                # Not +=, which would be an atomic addition where slabs run side by side; each has its own nodes.
                ring.node_sums[node] = ring.node_sums[node] + (S[i] * level + dS[i] * slope)


@ti.func
def gather(ring: ti.template(), p, values: ti.template()):
    """The nodes' values, four numbers, at the particle and their derivatives in x and y."""
    S, dS, R, dR = stencils_of(ring, p)
    first = ring.first_node[p]
    here, by_x, by_y = ti.Vector([0.0] * 4), ti.Vector([0.0] * 4), ti.Vector([0.0] * 4)
    for i in ti.static(range(3)):
        n0 = values[first + i]
        n1 = values[first + ring.row + i]
        n2 = values[first + 2 * ring.row + i]
        column = R[0] * n0 + R[1] * n1 + R[2] * n2
        here += S[i] * column
        by_x += dS[i] * column
        by_y += S[i] * (dR[0] * n0 + dR[1] * n1 + dR[2] * n2)
    return here, by_x, by_y


@ti.func
def scatter(ring: ti.template(), p, carried, values: ti.template()):
    """Add four numbers of the particle to the nodes' values, with its weights."""
    S, _, R, _ = stencils_of(ring, p)
    first = ring.first_node[p]
    for j in ti.static(range(3)):
        for i in ti.static(range(3)):
            node = first + j * ring.row + i
            values[node] = values[node] + S[i] * R[j] * carried
