"""The bar's nodes and stencils: how particles address them and how the period closes.

Nodes are stored with periodic images: entry 1 is node 0 at x = 0, entry 0 and entries N+1 ... N+3 are images.
"""

import taichi as ti

from solvers.kernels.shape_functions import complete_stencil
from solvers.problems.bar.method.gapless_pieces import sum_piece_lengths_at_nodes

GHOSTS = 4  # node arrays hold one periodic image on the left and three on the right
MOST_HALF_WIDTH = 0.5  # in cells: a domain meets at most two cells, so that three nodes suffice
EMPTY = 1e-12  # sum of S below which a node carries nothing
DEGENERATE = 1e-3  # linearity preservation falls back to the plain gradient below this share of its volume


@ti.func
def stencil_of(bar: ti.template(), p):
    """Returns particle p's stored stencil: S (3,) and dS (3,) in 1/m at the nodes from ``bar.first_node[p]`` on."""
    w = bar.weights[p]
    return complete_stencil(w[0], w[1], w[2], w[3])


@ti.func
def offset_from_first_node(bar: ti.template(), p):
    """Returns r = x_p - x_i in m of particle p from its stencil's first node; from the next nodes h and 2h less."""
    x = bar.position[p]
    return x - ti.floor(x) - (bar.first_node[p] - 1) * bar.spacing


@ti.func
def add_periodic_images(values: ti.template(), cells, first=0):
    """Adds to each node the sums at its periodic images, in place; ``values`` has entries for ``cells`` nodes, and for
    the images before and behind them, from ``first`` on."""
    values[first + cells] += values[first]
    for k in ti.static(range(1, 4)):
        values[first + k] += values[first + cells + k]


@ti.func
def copy_to_periodic_images(values: ti.template(), cells, first=0):
    """Copies each node's value to its periodic images, in place; ``values`` has entries for ``cells`` nodes, and for
    the images before and behind them, from ``first`` on."""
    values[first] = values[first + cells]
    for k in ti.static(range(1, 4)):
        values[first + cells + k] = values[first + k]


@ti.func
def divergence_mapping_factors(bar: ti.template(), i, on: ti.template()):
    """Returns ``(mean, scale)`` such that V_i d(sigma)/dx at node i is (sum D* sigma - mean sum S sigma) scale. ``on``:
    compile-time options.

    Plain (eq 8): 0 and 1. Linearity preserving: D = (D* - S sum D*/sum S)/den with sum D x = 1 (eq 17, normalised);
    V_i, the node's share of the *current* volume, keeps the density current. Where the domains leave too little to
    divide by, the plain form takes over: without this guard long runs divide by zero.
    """
    mean, scale = 0.0, 1.0
    if ti.static(on.linearity_preserving):
        moments = bar.node_moments[i]
        volume = bar.node_volume[i]
        tilt = moments[0] / bar.node_sums[i][0]
        den = moments[1] - tilt * moments[2]
        if den > DEGENERATE * volume and volume > DEGENERATE * bar.spacing:
            mean, scale = tilt, volume / den
    return mean, scale


@ti.func
def sum_moments_at_nodes(bar: ti.template(), on: ti.template()):
    """Computes the nodal sums of D*, D* r (m), S r (m) and S sigma (Pa) with r = x_p - x_i, in ``bar.node_moments``,
    and V_i = sum S F V0 in ``bar.node_volume``. ``on``: compile-time options."""
    for i in range(bar.cells + GHOSTS):
        bar.node_moments[i] = ti.Vector([0.0, 0.0, 0.0, 0.0])
        bar.node_volume[i] = 0.0
    for p in range(bar.particles):
        S, dS = stencil_of(bar, p)
        i = bar.first_node[p]
        r = offset_from_first_node(bar, p)
        volume = bar.deformation_gradient[p] * bar.volume
        stress = bar.modulus * (bar.deformation_gradient[p] - bar.unstretched)
        for k in ti.static(range(3)):
            D = 0.0
            if ti.static(not on.pieces):
                D = -dS[k] * volume
            r_k = r - k * bar.spacing
            bar.node_moments[i + k] += ti.Vector([D, D * r_k, S[k] * r_k, S[k] * stress])
            bar.node_volume[i + k] += S[k] * volume
    if ti.static(on.pieces):
        sum_piece_lengths_at_nodes(bar, on)
    add_periodic_images(bar.node_moments, bar.cells)
    add_periodic_images(bar.node_volume, bar.cells)


@ti.func
def node_internal_force(bar: ti.template(), i, on: ti.template()):
    """Returns node i's internal force in N: V_i d(sigma)/dx as the method sees it. ``on``: compile-time options."""
    force = bar.node_sums[i][2]
    if ti.static(on.linearity_preserving):
        mean, scale = divergence_mapping_factors(bar, i, on)
        force = (force - mean * bar.node_moments[i][3]) * scale
    return force
