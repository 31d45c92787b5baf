"""One step of the bar (NUMERICS of section 2 of the paper): symplectic Euler, stress last.

Every phase is a function of the state and of the switches, so the file reads like the method: weights, particles
to nodes, nodes, nodes to particles. :func:`advance` runs any number of steps in one kernel on one thread; at
this size launches would cost more than the physics. Equal masses cancel: v_i = sum S v / sum S.
"""

import taichi as ti

from solvers.bar.nodes import EMPTY, fold, gather_moments, node_force, spread, stencil_of
from solvers.bar.samples import sample
from solvers.bar.state import MOST_HALF_WIDTH, BarState
from solvers.estimators import transport
from solvers.shapes import weights_1d
from solvers.solver import CRUSHED, ESCAPED, INVERTED, SOUND

FLATTEST = 1e-3  # F below which a particle counts as crushed; the exact bar stays above 1 - 2 pi A
CHECK_EVERY = 8  # steps between two looks for a run that has gone bad


@ti.func
def half_width(bar: ti.template(), p, on: ti.template()):
    """Half the particle's domain, in cells: constant for uGIMP, stretched by F for cpGIMP."""
    width = bar.half_width
    if ti.static(on.method == "cpgimp"):
        width = ti.min(ti.max(bar.half_width * bar.deformation_gradient[p], 1e-6), MOST_HALF_WIDTH)
    return width


@ti.func
def find_weights(bar: ti.template(), on: ti.template()):
    """Keep each particle's stencil for both mappings of the step."""
    for p in range(bar.particles):
        x = bar.position[p]
        first, S, dS = weights_1d(on.method, (x - ti.floor(x)) * bar.cells_per_length, half_width(bar, p, on))
        # A run that goes bad has positions anywhere: stay inside the arrays until the check stops it.
        bar.first_node[p] = ti.cast(ti.min(ti.max(first, -1.0), bar.cells), ti.i32) + 1
        bar.weights[p] = ti.Vector([S[0], S[2], dS[0] * bar.cells_per_length, dS[2] * bar.cells_per_length])


@ti.func
def particles_to_nodes(bar: ti.template(), on: ti.template()):
    """Sum S, S v, D* sigma with D* = -dS F V0, and S times the body force's shape."""
    for i in range(bar.cells + 4):
        bar.node_sums[i] = ti.Vector([0.0, 0.0, 0.0, 0.0])
    for p in range(bar.particles):
        S, dS = stencil_of(bar, p)
        i = bar.first_node[p]
        volume = bar.deformation_gradient[p] * bar.volume
        stress = bar.modulus * (bar.deformation_gradient[p] - 1)
        interpolated = ti.Vector([1.0, bar.velocity[p], 0.0, 0.0])
        if ti.static(on.body_force == "material"):
            interpolated[3] = bar.sine[p]
        force = ti.Vector([0.0, 0.0, -volume * stress, 0.0])
        for k in ti.static(range(3)):
            bar.node_sums[i + k] += S[k] * interpolated + dS[k] * force
    fold(bar.node_sums, bar.cells)
    if ti.static(on.linearity_preserving):
        gather_moments(bar)


@ti.func
def update_nodes(bar: ti.template(), t, on: ti.template()):
    """v_i += dt a_i with a_i = internal + body force at time t."""
    push = 0.0
    if ti.static(on.body_force != "none"):
        push = bar.force_scale * ti.sin(bar.angular_frequency * t)
    for i in range(1, bar.cells + 1):
        sums = bar.node_sums[i]
        v, a = 0.0, 0.0
        if sums[0] > EMPTY:
            mass = bar.density * bar.volume * sums[0]
            internal = node_force(bar, i, on) / mass
            body = 0.0
            if ti.static(on.body_force == "material"):
                body = push * sums[3] / sums[0]
            if ti.static(on.body_force == "node"):
                body = push * bar.node_sine[i]
            a = internal + body
            v = sums[1] / sums[0] + bar.dt * a
            if ti.static(on.energy):  # the force's power with the velocity in the middle of the step
                bar.totals[1] += bar.dt * mass * body * (v - 0.5 * bar.dt * a)
        bar.node_motion[i] = ti.Vector([v, a])
    spread(bar.node_motion, bar.cells)


@ti.func
def hat_velocity(bar: ti.template(), x):
    """The grid velocity at x with hat functions."""
    s = (x - ti.floor(x)) * bar.cells_per_length
    i = ti.cast(ti.min(ti.max(ti.floor(s), 0.0), bar.cells), ti.i32)
    return (1 - (s - i)) * bar.node_motion[i + 1][0] + (s - i) * bar.node_motion[i + 2][0]


@ti.func
def nodes_to_particles(bar: ti.template(), step, on: ti.template()):
    """v += dt sum S a; x += dt sum S v_i (not the printed eq 24); F <- (1 + dt L) F with L = sum dS v_i."""
    jumps = 0.0
    for p in range(bar.particles):
        S, dS = stencil_of(bar, p)
        i = bar.first_node[p]
        n0, n1, n2 = bar.node_motion[i], bar.node_motion[i + 1], bar.node_motion[i + 2]
        motion = S[0] * n0 + S[1] * n1 + S[2] * n2
        L = dS[0] * n0[0] + dS[1] * n1[0] + dS[2] * n2[0]
        v = bar.velocity[p] + bar.dt * motion[1]
        moving = motion[0]
        if ti.static(on.velocity == "particle"):
            moving = v
        if ti.static(on.velocity == "corners"):  # domains whose ends move with the grid tile for ever
            reach = half_width(bar, p, on) * bar.spacing
            moving = 0.5 * (hat_velocity(bar, bar.position[p] - reach)
                            + hat_velocity(bar, bar.position[p] + reach))
        x = bar.position[p] + bar.dt * moving
        if ti.static(on.crossings):
            jump = abs(ti.floor(x * bar.cells_per_length) - ti.floor(bar.position[p] * bar.cells_per_length))
            jumps += jump
            bar.last_crossing[p] = ti.select(jump > 0, step, bar.last_crossing[p])
        if ti.static(on.acceleration):
            bar.acceleration[p] = motion[1]
        bar.velocity[p] = v
        bar.position[p] = x
        bar.deformation_gradient[p] *= 1 + bar.dt * L
    bar.totals[0] += jumps


@ti.func
def check(bar: ti.template(), step):
    """Stop a run that has gone bad: F <= 0, tiny or NaN, or a particle far from where it can be.

    Without the middle one a run that collapses, all particles in a few clusters, would go on for ever.
    """
    flattest, bad = FLATTEST, -1
    for p in range(bar.particles):
        F = bar.deformation_gradient[p]
        if not F >= flattest:  # true for NaN too
            flattest, bad = -1e300 if ti.math.isnan(F) else F, p
            bar.verdict[0] = CRUSHED if F > 0 else INVERTED
        elif not abs(bar.position[p] - bar.material_position[p]) < bar.farthest and bad < 0:
            bad = p
            bar.verdict[0] = ESCAPED
    if bad >= 0:
        bar.verdict[1], bar.verdict[2] = step, bad


@ti.kernel
def advance(start: ti.i32, steps: ti.i32, bar: BarState, on: ti.template()):
    """Run ``steps`` steps from step ``start``; sample the norms every ``sample_interval`` steps."""
    ti.loop_config(serialize=True)
    for k in range(steps):
        if bar.verdict[0] == SOUND:
            step = start + k
            find_weights(bar, on)
            particles_to_nodes(bar, on)
            update_nodes(bar, step * bar.dt, on)
            if ti.static("transport" in on.estimators):
                if (step + 1) % bar.estimate_interval == 0:
                    transport.bar_step(bar, on)
            nodes_to_particles(bar, step + 1, on)
            if (step + 1) % CHECK_EVERY == 0:
                check(bar, step + 1)
            if (step + 1) % bar.sample_interval == 0:
                row = (step + 1) // bar.sample_interval - start // bar.sample_interval - 1
                sample(bar, row, step + 1, on)


@ti.kernel
def measure(step: ti.i32, bar: BarState, on: ti.template()):
    """Check the state and sample it into row 0, wherever the run stands."""
    ti.loop_config(serialize=True)
    for _ in range(1):
        if bar.verdict[0] == SOUND:
            check(bar, step)
        sample(bar, 0, step, on)
