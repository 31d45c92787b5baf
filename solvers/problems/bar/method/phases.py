"""The phases of one step of the bar (section 2 of the paper): symplectic Euler, stress last.

Every phase is a function of the state and of the compile-time options, so the file reads like the method: weights,
particles to nodes, nodes, nodes to particles. Equal masses cancel: v_i = sum S v / sum S.
"""

import taichi as ti

from solvers.kernels.shape_functions import outer_weights
from solvers.kernels.simd import LANES, load
from solvers.problems.bar.method import gapless_pieces, periodic_nodes
from solvers.problems.bar.method.body_force import body_force_on_particle, force_amplitude
from solvers.problems.bar.method.periodic_nodes import EMPTY, GHOSTS, MOST_HALF_WIDTH, stencil_of


@ti.func
def update_grid(bar: ti.template(), t, on: ti.template()):
    """Runs a step's first half at t in s: weights, particles to nodes, their new motion. ``on``: kernel options."""
    if ti.static(not on.frozen):
        find_weights(bar, on)
    if ti.static(on.pieces):
        gapless_pieces.store_piece_corners(bar, on)
    particles_to_nodes(bar, t, on)
    update_nodes(bar, t, on)


@ti.func
def half_width(bar: ti.template(), F, on: ti.template()):
    """Returns half the domain, in cells, of particles with deformation F: constant for uGIMP, stretched for cpGIMP.
    ``on``: compile-time options."""
    width = bar.half_width + ti.zero(F)
    if ti.static(on.method == "cpgimp" and not on.frozen):
        width = ti.min(ti.max(bar.half_width * F, 1e-6), MOST_HALF_WIDTH)
    return width


@ti.func
def find_weights(bar: ti.template(), on: ti.template()):
    """Stores each particle's stencil in ``bar.first_node`` and ``bar.weights``, for both mappings of the step,
    ``LANES`` particles at a time; the last perhaps twice. ``on``: compile-time options."""
    per = bar.cells_per_length
    for block in range((bar.particles + LANES - 1) // LANES):
        p = ti.min(block * LANES, bar.particles - LANES)
        x = load(bar.position, p)
        if ti.static(on.frozen):
            x = load(bar.material_position, p)
        width = half_width(bar, load(bar.deformation_gradient, p), on)
        first, left, right, slope_left, slope_right = outer_weights(on.method, (x - ti.floor(x)) * per, width)
        slope_left, slope_right = slope_left * per, slope_right * per
        # Positions of an unstable run are arbitrary: stay inside the arrays until the check stops it.
        node = ti.min(ti.max(first, -1.0), float(bar.cells)) + 1
        for k in ti.static(range(LANES)):
            bar.first_node[p + k] = ti.cast(node[k], ti.i32)
            bar.weights[p + k] = ti.Vector([left[k], right[k], slope_left[k], slope_right[k]])


@ti.func
def particles_to_nodes(bar: ti.template(), t, on: ti.template()):
    """Computes ``bar.node_sums``, at each node the sums over particles of S, S v, D* sigma with D* = -dS F V0, and S b
    with the body force b at time t in s; S are weights, dS their slopes. ``on``: compile-time options.

    Sums of three nodes stay in registers until a particle has others: in memory, each would wait for the one before it.
    """
    size = force_amplitude(bar, t, on)
    for i in range(bar.cells + GHOSTS):
        bar.node_sums[i] = ti.Vector([0.0, 0.0, 0.0, 0.0])
    at = bar.first_node[0]
    left, middle, right = bar.node_sums[at], bar.node_sums[at + 1], bar.node_sums[at + 2]
    for p in range(bar.particles):
        S, dS = stencil_of(bar, p)
        carried = contribution_of(bar, p, size, on)
        i = bar.first_node[p]
        if i != at:
            bar.node_sums[at], bar.node_sums[at + 1], bar.node_sums[at + 2] = left, middle, right
            left, middle, right = bar.node_sums[i], bar.node_sums[i + 1], bar.node_sums[i + 2]
            at = i
        left = left + ti.Vector([S[0], S[0], dS[0], S[0]]) * carried
        middle = middle + ti.Vector([S[1], S[1], dS[1], S[1]]) * carried
        right = right + ti.Vector([S[2], S[2], dS[2], S[2]]) * carried
    bar.node_sums[at], bar.node_sums[at + 1], bar.node_sums[at + 2] = left, middle, right
    if ti.static(on.pieces):
        gapless_pieces.add_piece_forces_to_nodes(bar, on)
    periodic_nodes.add_periodic_images(bar.node_sums, bar.cells)
    if ti.static(on.linearity_preserving):
        periodic_nodes.sum_moments_at_nodes(bar, on)


@ti.func
def contribution_of(bar: ti.template(), p, size, on: ti.template()):
    """Returns what particle p adds to nodes (4,): 1, v and b, to be multiplied by its weight, and third -sigma F V0, by
    the weight's slope; ``size`` is the amplitude of the body force in m/s^2. ``on``: compile-time options."""
    carried = ti.Vector([1.0, bar.velocity[p], 0.0, 0.0])
    if ti.static(not on.pieces):
        volume = bar.volume  # frozen weights: the force at rest is -sum dS P V0
        if ti.static(not on.frozen):
            volume *= bar.deformation_gradient[p]
        stress = bar.modulus * (bar.deformation_gradient[p] - bar.unstretched)
        carried[2] = -volume * stress
    if ti.static(on.body_force in ("material", "two-tone")):
        carried[3] = body_force_on_particle(bar, p, size, on)
    return carried


@ti.func
def update_nodes(bar: ti.template(), t, on: ti.template()):
    """Stores each node's v_i + dt a_i and a_i in ``bar.node_motion``, a_i by internal and body force at time t in s.
    ``on``: compile-time options."""
    size = force_amplitude(bar, t, on)
    for i in range(1, bar.cells + 1):
        sums = bar.node_sums[i]
        v, a = 0.0, 0.0
        if sums[0] > EMPTY:
            mass = bar.density * bar.volume * sums[0]
            internal = periodic_nodes.node_internal_force(bar, i, on) / mass
            body = 0.0
            if ti.static(on.body_force in ("material", "two-tone")):
                body = sums[3] / sums[0]
            if ti.static(on.body_force == "node"):
                body = size * bar.node_sine[i]
            a = internal + body
            v = sums[1] / sums[0] + bar.dt * a
            if ti.static(on.energy):  # the force's power with the velocity in the middle of the step
                bar.totals[1] += bar.dt * mass * body * (v - 0.5 * bar.dt * a)
        bar.node_motion[i] = ti.Vector([v, a])
    periodic_nodes.copy_to_periodic_images(bar.node_motion, bar.cells)


@ti.func
def hat_velocity(bar: ti.template(), x):
    """Returns the grid's velocity in m/s at a position x in m, by hat functions."""
    s = (x - ti.floor(x)) * bar.cells_per_length
    i = ti.cast(ti.min(ti.max(ti.floor(s), 0.0), bar.cells), ti.i32)
    return (1 - (s - i)) * bar.node_motion[i + 1][0] + (s - i) * bar.node_motion[i + 2][0]


@ti.func
def nodes_to_particles(bar: ti.template(), step, on: ti.template()):
    """Updates particles in step number ``step``: v += dt sum S a; x += dt sum S v_i (not the printed eq 24); F <- (1 +
    dt L) F, L = sum dS v_i; for diagnostics also ``bar.last_crossing``, ``bar.acceleration`` and crossings. ``on``:
    compile-time options."""
    jumps = 0.0
    for p in range(bar.particles):
        S, dS = stencil_of(bar, p)
        i = bar.first_node[p]
        n0, n1, n2 = bar.node_motion[i], bar.node_motion[i + 1], bar.node_motion[i + 2]
        v_a_L = ti.Vector([S[0], S[0], dS[0], dS[0]]) * ti.Vector([n0[0], n0[1], n0[0], n0[1]]) \
            + ti.Vector([S[1], S[1], dS[1], dS[1]]) * ti.Vector([n1[0], n1[1], n1[0], n1[1]]) \
            + ti.Vector([S[2], S[2], dS[2], dS[2]]) * ti.Vector([n2[0], n2[1], n2[0], n2[1]])
        moving, a, L = v_a_L[0], v_a_L[1], v_a_L[2]
        v = bar.velocity[p] + bar.dt * a
        if ti.static(on.velocity == "particle"):
            moving = v
        if ti.static(on.velocity == "corners"):  # domains whose ends move with the grid tile for ever
            reach = half_width(bar, bar.deformation_gradient[p], on) * bar.spacing
            moving = 0.5 * (hat_velocity(bar, bar.position[p] - reach) + hat_velocity(bar, bar.position[p] + reach))
        x = bar.position[p] + bar.dt * moving
        if ti.static(on.crossings and not on.frozen):
            jump = abs(ti.floor(x * bar.cells_per_length) - ti.floor(bar.position[p] * bar.cells_per_length))
            jumps += jump
            bar.last_crossing[p] = ti.select(jump > 0, step, bar.last_crossing[p])
        if ti.static(on.acceleration):
            bar.acceleration[p] = a
        bar.velocity[p] = v
        bar.position[p] = x
        if ti.static(on.frozen):
            bar.deformation_gradient[p] += bar.dt * L  # the gradient of S is with respect to X
        elif ti.static(not on.pieces):
            bar.deformation_gradient[p] *= 1 + bar.dt * L
    if ti.static(on.pieces):
        gapless_pieces.update_piece_gradients(bar, on)
    bar.totals[0] += jumps
