"""Remedies of the bar (see ``solvers.scene.stabilisations``) against breakdown in long and large motions.

Two things diverge slowly in MPM, both because the particle-grid maps lose information. The part of the particles'
velocity that no node sees is never corrected; and F follows the gradient of the grid's velocity, x its value, so that
after many periods F is no longer that of x. Both remedies act with the weights of the step, before particles move.
"""

import taichi as ti

from solvers.problems.bar.method import periodic_nodes
from solvers.problems.bar.method.periodic_nodes import EMPTY, GHOSTS, stencil_of

PASSES = 8  # of the coupling: u_i = sum over l < 8 of (I - S^+ S)^l S^+ (x - X)
MOST_GRADIENT = 0.9  # du/dx beyond which F = 1/(1 - du/dx) is meaningless


@ti.func
def in_step(bar: ti.template(), step, on: ti.template()):
    """Applies the null-space filter and the coupling of F, if on and due, between nodes and particles of step
    ``step``. ``on``: compile-time options."""
    if ti.static(on.filtered or on.coupled):
        if step % bar.remedy_interval == 0:
            if ti.static(on.filtered):
                filter_null_space(bar)
            if ti.static(on.coupled):
                couple_deformation_to_positions(bar)


@ti.func
def subtract_mean_velocity(bar: ti.template(), on: ti.template()):
    """Subtracts the particles' mean velocity, except a patch test's, with zero-drift. ``on``: kernel options."""
    if ti.static(on.centred):
        mean = 0.0
        for p in range(bar.particles):
            mean += bar.velocity[p]
        mean = mean / bar.particles - bar.drift_velocity
        for p in range(bar.particles):
            bar.velocity[p] -= mean


@ti.func
def filter_null_space(bar: ti.template()):
    """Applies the null-space filter v_p -= rate (I - S S^+)^2 v to the particles' velocities: mapping to nodes by S^+,
    the mass-weighted mean, and back by S omits the part that no node sees."""
    for p in range(bar.particles):
        S, _ = stencil_of(bar, p)
        i = bar.first_node[p]
        seen = 0.0
        for k in ti.static(range(3)):  # v_i before the step's acceleration
            seen += S[k] * (bar.node_motion[i + k][0] - bar.dt * bar.node_motion[i + k][1])
        bar.particle_scratch[p] = bar.velocity[p] - seen
    scratch_to_nodes(bar)
    for p in range(bar.particles):
        bar.velocity[p] -= bar.remedy_rate * (bar.particle_scratch[p] - interpolate_scratch(bar, p))


@ti.func
def couple_deformation_to_positions(bar: ti.template()):
    """Draws the particles' F towards that of their positions, F += rate (1/(1 - du/dx) - F), with u the grid's best
    copy of x - X, sharpened by ``PASSES``."""
    for i in range(bar.cells + GHOSTS):
        bar.node_displacement[i] = 0.0
    for p in range(bar.particles):
        bar.particle_scratch[p] = bar.position[p] - bar.material_position[p]
    for l in range(PASSES):
        scratch_to_nodes(bar)
        for i in range(bar.cells + GHOSTS):
            bar.node_displacement[i] += bar.node_scratch[i]
        if l < PASSES - 1:
            for p in range(bar.particles):
                bar.particle_scratch[p] -= interpolate_scratch(bar, p)
    for p in range(bar.particles):
        _, dS = stencil_of(bar, p)
        i = bar.first_node[p]
        G = 0.0
        for k in ti.static(range(3)):
            G += dS[k] * bar.node_displacement[i + k]
        if G < MOST_GRADIENT:
            F = bar.deformation_gradient[p]
            bar.deformation_gradient[p] = F + bar.remedy_rate * (1 / (1 - G) - F)


@ti.func
def scratch_to_nodes(bar: ti.template()):
    """Maps ``bar.particle_scratch`` to ``bar.node_scratch`` by S^+, the mass-weighted mean of a node's particles."""
    for i in range(bar.cells + GHOSTS):
        bar.node_scratch[i] = 0.0
    for p in range(bar.particles):
        S, _ = stencil_of(bar, p)
        i = bar.first_node[p]
        for k in ti.static(range(3)):
            bar.node_scratch[i + k] += S[k] * bar.particle_scratch[p]
    periodic_nodes.add_periodic_images(bar.node_scratch, bar.cells)
    for i in range(1, bar.cells + 1):
        weight = bar.node_sums[i][0]
        bar.node_scratch[i] = bar.node_scratch[i] / weight if weight > EMPTY else 0.0
    periodic_nodes.copy_to_periodic_images(bar.node_scratch, bar.cells)


@ti.func
def interpolate_scratch(bar: ti.template(), p):
    """Returns ``bar.node_scratch`` interpolated to particle p."""
    S, _ = stencil_of(bar, p)
    i = bar.first_node[p]
    total = 0.0
    for k in ti.static(range(3)):
        total += S[k] * bar.node_scratch[i + k]
    return total
