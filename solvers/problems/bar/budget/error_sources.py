"""Nodal sums of the particles for the budget, and the accelerations of nodes that each cause makes.

With f the method's force of the reference's stress, f~ that of the same stress in pieces (``method.pieces``), and
"down" the mass-weighted mean over a node's particles, the reference put through the step misses its own acceleration by

    crossings    (f - f~)/m              a particle, or its box, is counted whole where a part of it is in the next cell
    coarse grid  f~/m - down(a0 - b)     pieces of constant stress, and hats or B-splines to see them with
    body force   b_i - down(b)           0 for a force at material points.
"""

import taichi as ti

from solvers.problems.bar.budget.budget_arrays import FORCE, PIECES, REFERENCE, STRESS, VELOCITY
from solvers.problems.bar.budget.reference_motion import reference_gradients_at, reference_motion_at
from solvers.problems.bar.method import gapless_pieces, periodic_nodes
from solvers.problems.bar.method.body_force import body_force_on_particle, force_amplitude
from solvers.problems.bar.method.periodic_nodes import DEGENERATE, EMPTY, GHOSTS, stencil_of


@ti.func
def particles_to_nodes(bar: ti.template(), t, now, on: ti.template()):
    """Sums the reference, its stress in pieces, and each cause's errors at the nodes, into ``bar.budget_nodes``; t is
    the time in s, ``now`` are the :func:`reference_time_factors` from it on. ``on``: compile-time options."""
    M, P = bar.cells + GHOSTS, bar.particles
    for i in range(5 * M):
        bar.budget_nodes[i] = ti.Vector([0.0, 0.0, 0.0, 0.0])
    size = force_amplitude(bar, t, on)
    if ti.static(not on.pieces):
        gapless_pieces.store_piece_corners(bar, on)
    last = gapless_pieces.periodically_extended_position(bar, -1, on)
    stress_before = bar.modulus * (reference_gradients_at(bar, P - 1, now, on)[0] - bar.unstretched)
    for p in range(P):
        this = gapless_pieces.periodically_extended_position(bar, p, on)
        stress = bar.modulus * (reference_gradients_at(bar, p, now, on)[0] - bar.unstretched)
        corner_to_nodes(bar, p, stress - stress_before, this - last, on)
        particle_to_nodes(bar, p, stress, size, now, on)
        last, stress_before = this, stress
    for layer in ti.static((REFERENCE, PIECES, VELOCITY, FORCE, STRESS)):
        if ti.static(layer != STRESS or on.linearity_preserving):
            periodic_nodes.add_periodic_images(bar.budget_nodes, bar.cells, layer * M)


@ti.func
def corner_to_nodes(bar: ti.template(), p, jump, length, on: ti.template()):
    """Adds particle p's left corner to nodes: the ``jump`` of stress there in Pa, and the ``length`` in m from the
    particle before it, for linearity preservation. ``on``: compile-time options."""
    i, B, _ = gapless_pieces.stored_corner_stencil(bar, p)
    given = ti.Vector([jump, length, 0.0, 0.0])
    M, P = bar.cells + GHOSTS, bar.particles
    for k in ti.static(range(gapless_pieces.nodes_per_corner(on))):
        bar.budget_nodes[PIECES * M + i + k] += B[k] * given
        if ti.static(on.pieces):  # the errors' own stress pulls as the run's does
            before = bar.cause_errors[2 * P + (p + P - 1) % P]
            bar.budget_nodes[FORCE * M + i + k] += B[k] * bar.modulus * (bar.cause_errors[2 * P + p] - before)


@ti.func
def particle_to_nodes(bar: ti.template(), p, stress, size, now, on: ti.template()):
    """Adds particle p to nodes: S (v + dt a, a, b) and the force of the reference's ``stress`` in Pa, and the velocity
    and force of each cause's errors; ``size`` is the body force's amplitude in m/s^2. ``on``: compile-time options.

    F P is quadratic: F P - F0 P0 = E (F + F0 - F_rest) e_F exactly. Linearity preservation divides by sums of F, which
    so belong to the weights: there the run's own F is the geometry of either.
    """
    S, dS = stencil_of(bar, p)
    i, M, P = bar.first_node[p], bar.cells + GHOSTS, bar.particles
    F, F0 = bar.deformation_gradient[p], reference_gradients_at(bar, p, now, on)[0]
    m = reference_motion_at(bar, p, now, on)
    geometry, secant = F0, F + F0 - bar.unstretched
    if ti.static(on.linearity_preserving):
        geometry, secant = F, F
    if ti.static(on.frozen):
        geometry, secant = 1.0, 1.0
    given = ti.Vector([m[0], m[1], 0.0, 0.0])
    if ti.static(on.body_force == "node"):
        given[2] = body_force_on_particle(bar, p, size, on)
    force = ti.Vector([0.0, 0.0, 0.0, -geometry * bar.volume * stress])
    velocity = bar.cause_errors[P + p]
    stretch = bar.cause_errors[2 * P + p]
    pull = -bar.modulus * secant * bar.volume * stretch
    for k in ti.static(range(3)):
        bar.budget_nodes[i + k] += S[k] * given + dS[k] * force
        bar.budget_nodes[VELOCITY * M + i + k] += S[k] * velocity
        if ti.static(not on.pieces):
            bar.budget_nodes[FORCE * M + i + k] += dS[k] * pull
        if ti.static(on.linearity_preserving):
            bar.budget_nodes[PIECES * M + i + k] += S[k] * ti.Vector([0.0, 0.0, stress, 0.0])
            bar.budget_nodes[STRESS * M + i + k] += S[k] * (bar.modulus * stretch)


@ti.func
def update_nodes(bar: ti.template(), t, on: ti.template()):
    """Computes at nodes, in a step from t s, each cause's new velocity and acceleration, with sources, and the
    reference's. A removed cause is subtracted from the run's nodes and adds to no error. ``on``: kernel options."""
    M, size = bar.cells + GHOSTS, force_amplitude(bar, t, on)
    for i in range(1, bar.cells + 1):
        reference, pieces = bar.budget_nodes[i], bar.budget_nodes[PIECES * M + i]
        velocity, force = bar.budget_nodes[VELOCITY * M + i], bar.budget_nodes[FORCE * M + i]
        sums = bar.node_sums[i]
        if sums[0] > EMPTY:
            mass = bar.density * bar.volume * sums[0]
            method, whole = reference[3], pieces[0]
            if ti.static(on.linearity_preserving):
                mean, scale = periodic_nodes.divergence_mapping_factors(bar, i, on)
                method = (method - mean * pieces[2]) * scale
                force = (force - mean * bar.budget_nodes[STRESS * M + i]) * scale
                volume = bar.node_volume[i]
                if pieces[1] > DEGENERATE * volume and volume > DEGENERATE * bar.spacing:
                    whole *= volume / pieces[1]
            if ti.static(on.pieces):
                method = whole
            body, wanted = 0.0, 0.0
            if ti.static(on.body_force in ("material", "two-tone")):
                body = sums[3] / sums[0]
                wanted = body
            if ti.static(on.body_force == "node"):
                body, wanted = size * bar.node_sine[i], reference[2] / sums[0]
            made = ti.Vector([(method - whole) / mass, whole / mass - reference[1] / sums[0] + wanted,
                              body - wanted, 0.0])
            if bar.taken_away >= 0:
                for c in ti.static(range(3)):
                    if bar.taken_away == c:
                        bar.node_motion[i] += made[c] * ti.Vector([-bar.dt, -1.0])
                        made[c] = 0.0
            force = force / mass + made
            velocity = velocity / sums[0] + bar.dt * force
            reference /= sums[0]
        else:
            reference, velocity, force = 0.0 * reference, 0.0 * velocity, 0.0 * force
        bar.budget_nodes[i] = reference
        bar.budget_nodes[VELOCITY * M + i], bar.budget_nodes[FORCE * M + i] = velocity, force
    for layer in ti.static((REFERENCE, VELOCITY, FORCE)):
        periodic_nodes.copy_to_periodic_images(bar.budget_nodes, bar.cells, layer * M)
