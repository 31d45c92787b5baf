"""The ring's mappings with separable stencils: hat, uGIMP and cpGIMP, 3 x 3 nodes a particle."""

import taichi as ti

from solvers.ring.layout import GHOSTS
from solvers.ring.material import force_moment
from solvers.shapes import stencil, weights_1d

MOST_HALF_WIDTH = 0.5  # in cells: a domain meets at most two cells, so that three nodes suffice


@ti.func
def half_widths(ring: ti.template(), p, on: ti.template()):
    """Half the particle's box in x and y, in cells: constant for uGIMP, stretched by F_xx and F_yy for cpGIMP."""
    across, up = ring.half_width, ring.half_width
    if ti.static(on.method == "cpgimp"):
        F = ring.deformation_gradient[p]
        across = ti.min(ti.max(ring.half_width * F[0], 1e-6), MOST_HALF_WIDTH)
        up = ti.min(ti.max(ring.half_width * F[3], 1e-6), MOST_HALF_WIDTH)
    return across, up


@ti.func
def find_weights(ring: ti.template(), start, end, on: ti.template()):
    """Keep the stencils of the particles from ``start`` to ``end`` for both mappings of the step."""
    for p in range(start, end):
        x = ring.motion[p] * ring.cells_per_length + GHOSTS
        across, up = half_widths(ring, p, on)
        i, S, dS = weights_1d(on.method, x[0], across)
        j, R, dR = weights_1d(on.method, x[1], up)
        # A run that goes bad has positions anywhere: stay inside the arrays until the check stops it.
        i = ti.min(ti.max(i, 0.0), ring.active - 3)
        j = ti.min(ti.max(j, 0.0), ring.active - 3)
        ring.first_node[p] = ti.cast(j, ti.i32) * ring.row + ti.cast(i, ti.i32)
        per = ring.cells_per_length
        ring.weights[p] = ti.Vector([S[0], S[2], dS[0] * per, dS[2] * per, R[0], R[2], dR[0] * per, dR[2] * per])


@ti.func
def stencils_of(ring: ti.template(), p):
    """The kept stencils: weights and gradients (1/length) at three nodes in x and in y."""
    w = ring.weights[p]
    S, dS = stencil(w[0], w[1], w[2], w[3])
    R, dR = stencil(w[4], w[5], w[6], w[7])
    return S, dS, R, dR


@ti.func
def particles_to_nodes(ring: ti.template(), start, end, grid, on: ti.template()):
    """Add mass, momentum and force of the particles from ``start`` to ``end`` to the nodes from ``grid`` on."""
    for p in range(start, end):
        S, dS, R, dR = stencils_of(ring, p)
        first = grid + ring.first_node[p]
        mass, carried, tau = force_moment(ring, p, on)
        along_x = ti.Vector([0.0, 0.0, -tau[0], -tau[1]])
        along_y = ti.Vector([0.0, 0.0, -tau[1], -tau[2]])
        for j in ti.static(range(3)):
            level = R[j] * carried + dR[j] * along_y
            slope = R[j] * along_x
            for i in ti.static(range(3)):
                node = first + j * ring.row + i
                # Not +=, which would be an atomic addition where slabs run side by side; each has its own nodes.
                ring.node_sums[node] = ring.node_sums[node] + S[i] * level + dS[i] * slope
                ring.node_mass[node] = ring.node_mass[node] + S[i] * (R[j] * mass)


@ti.func
def gather(ring: ti.template(), p):
    """Grid motion (v, a) at the particle and its derivatives in x and y."""
    S, dS, R, dR = stencils_of(ring, p)
    first = ring.first_node[p]
    here, by_x, by_y = ti.Vector([0.0] * 4), ti.Vector([0.0] * 4), ti.Vector([0.0] * 4)
    for i in ti.static(range(3)):
        n0 = ring.node_motion[first + i]
        n1 = ring.node_motion[first + ring.row + i]
        n2 = ring.node_motion[first + 2 * ring.row + i]
        column = R[0] * n0 + R[1] * n1 + R[2] * n2
        here += S[i] * column
        by_x += dS[i] * column
        by_y += S[i] * (dR[0] * n0 + dR[1] * n1 + dR[2] * n2)
    return here, by_x, by_y
