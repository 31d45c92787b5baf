"""The bar's step margin: dt over the bound of ``solvers.scene.step_bound``, by the last step's stencils and masses."""

import taichi as ti

from solvers.problems.bar.method.gapless_pieces import nodes_per_corner, stored_corner_stencil
from solvers.problems.bar.method.periodic_nodes import EMPTY, GHOSTS, add_periodic_images, stencil_of

NODES_PER_PIECE = 5  # nodes that the two corners of a piece meet, up to two cells apart


@ti.func
def step_margin(bar: ti.template(), on: ti.template()):
    """Stores dt over Gershgorin's bound of the stable step in ``bar.step_margin[0]``; NaN before the first step.
    ``on``: compile-time options."""
    for i in range(bar.cells + GHOSTS):
        bar.node_stiffness[i] = 0.0
    if ti.static(on.pieces):
        add_piece_rows(bar, on)
    else:
        add_particle_rows(bar)
    add_periodic_images(bar.node_stiffness, bar.cells)
    largest = 0.0
    for i in range(1, bar.cells + 1):
        largest = ti.max(largest, bar.node_stiffness[i])
    bar.step_margin[0] = 0.5 * bar.dt * ti.sqrt(largest) if largest > 0 else ti.math.nan


@ti.func
def inverse_sqrt_mass(bar: ti.template(), node):
    """Returns 1/sqrt(m) of a node, m in kg; of an image that of its node, whose sums are complete; 0 if it is empty."""
    weight = bar.node_sums[(node + bar.cells - 1) % bar.cells + 1][0]
    return 1 / ti.sqrt(weight * bar.density * bar.volume) if weight > EMPTY else 0.0


@ti.func
def add_particle_rows(bar: ti.template()):
    """Adds rows of Gershgorin's circles in 1/s^2 to ``bar.node_stiffness``: for every particle the product of E F^2 V0,
    |dS_i|/sqrt(m_i) and sum_j |dS_j|/sqrt(m_j), with masses of nodes."""
    for p in range(bar.particles):
        _, dS = stencil_of(bar, p)
        i = bar.first_node[p]
        scaled = ti.Vector([0.0, 0.0, 0.0])
        for k in ti.static(range(3)):
            scaled[k] = abs(dS[k]) * inverse_sqrt_mass(bar, i + k)
        F = bar.deformation_gradient[p]
        stiffness = bar.modulus * F * F * bar.volume * scaled.sum()
        for k in ti.static(range(3)):
            bar.node_stiffness[i + k] += stiffness * scaled[k]


@ti.func
def add_piece_rows(bar: ti.template(), on: ti.template()):
    """Adds rows of Gershgorin's circles in 1/s^2 to ``bar.node_stiffness``, with the remedy of pieces: a piece's force
    is the difference of the base functions at its corners, over V0. ``on``: compile-time options."""
    for p in range(bar.particles):
        following = ti.select(p + 1 < bar.particles, p + 1, 0)
        i, left, _ = stored_corner_stencil(bar, p)
        j, right, _ = stored_corner_stencil(bar, following)
        apart = (j - i + bar.cells) % bar.cells
        scaled = ti.Vector([0.0] * NODES_PER_PIECE)
        for k in ti.static(range(NODES_PER_PIECE)):
            difference = 0.0
            if ti.static(k < nodes_per_corner(on)):
                difference -= left[k]
            for l in ti.static(range(nodes_per_corner(on))):
                if apart + l == k:
                    difference += right[l]
            scaled[k] = abs(difference) * inverse_sqrt_mass(bar, i + k)
        stiffness = bar.modulus / bar.volume * scaled.sum()
        for k in ti.static(range(NODES_PER_PIECE)):
            bar.node_stiffness[(i + k - 1) % bar.cells + 1] += stiffness * scaled[k]
