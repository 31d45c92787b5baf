"""The recovered estimator in the plane: as on the bar (see there), on the polar material lattice of a ring.

The weak form, in the material frame with the error grid's functions N = N_b(R) N_a(angle) and Cartesian components,

    (M u)'' = M b - D P / rho,    M f = int N f / int N,    D P = int P grad N / int N,

leaves the free surfaces natural: a traction on them would be seen. P grad N = (P e_R) N_b' N_a + (P e_angle) N_b
N_a'/R. Every operator is a product of one along the radius and one along the angle (``lattice_lines``); symmetry planes
are mirrors, with signs of their own for each component, and a whole turn closes on itself.

Else all is as on the bar: U = M u_exact is integrated from the start, driven by P at the recovered gradient less the
error's; E = sum_i N_i (2 e - C e)_i + (u - fit u), e = M u - U; and sigma is compared with the stress at the recovered
gradient less the error's. In a step the gradient is recovered on one line each way; for a report over a patch.

Assumptions: as on the bar; the particles began on a polar lattice, of four particles or more across. It fails where the
solution varies within a fit of four cells. sigma and a are not estimated where the particles are so uneven that the fit
follows them: one particle per cell, or particles moved with their own velocity (eq 24 as printed).
"""

import taichi as ti

from solvers.estimators import recovered_common
from solvers.estimators.recovered_common import BEGUN, MOVED, NEW, SHORT, TAU, TURNS, H
from solvers.kernels.dtypes import quads, reals
from solvers.problems.planar.estimators import recovered_operators as op
from solvers.problems.planar.estimators.recovered_tables import allocate, interval, verdict
from solvers.problems.planar.method import material_laws
from solvers.problems.planar.method.material_laws import cauchy_stress, cauchy_stress_of
from solvers.problems.planar.method.phases import gather
from solvers.scene.estimator_hooks import EstimatorHooks

MEMORY = {
    "recovered_numbers": reals,  # by the names of solvers.estimators.recovered_common
    **recovered_common.table_types(op.TABLES),
    "recovered_count": ti.i32, "recovered_line_nodes": ti.i32,  # nodes of the error grid, and those on a line
    "recovered_line": ti.i32,  # particles on a line
    "recovered_silent": ti.i32,  # how many quantities are not estimated: 1 is a, 2 also sigma
    "recovered_nodes": quads,  # nodal values, block by block
    "recovered_particles": quads,  # fields at particles, and half-way values on radii with nodes on them
}


@ti.func
def start_reference(body: ti.template(), nodes: ti.template(), t, lattice: ti.template(), on: ti.template()):
    """Starts the reference in ``nodes``, once, with the acceleration a = M b at t s, when the body was undeformed;
    ``lattice`` are :class:`~solvers.problems.planar.estimators.recovered_operators.LatticeKernelOptions`."""
    if body.recovered_numbers[TURNS] == NEW:
        op.project_body_force(body, t, lattice, on)
        B, step = body.recovered_line_nodes, body.recovered_numbers[H]
        for a in range(body.recovered_count // B):
            for b in range(B):
                push_x, push_y = op.nodal_body_force(body, nodes, a, b, lattice)
                at_r, at_rate = op.node_index(body, op.MOTION, a * B + b), op.node_index(body, op.RATE, a * B + b)
                r = nodes[at_r]
                x = recovered_common.initial_reference_solution(ti.Vector([r[0], r[2], 0.0, 0.0]), push_x, step)
                y = recovered_common.initial_reference_solution(ti.Vector([r[1], r[3], 0.0, 0.0]), push_y, step)
                nodes[at_r], nodes[at_rate] = ti.Vector([x[0], y[0], x[1], y[1]]), ti.Vector([x[2], y[2], x[3], y[3]])
                nodes[op.node_index(body, op.BEFORE, a * B + b)] = ti.Vector([push_x, push_y, 0.0, 0.0])
        body.recovered_numbers[TURNS] = BEGUN


@ti.func
def after_step(body: ti.template(), step, lattice: ti.template(), on: ti.template()):
    """Advances the reference to ``step`` steps: U += H w; w += H (a + correction), with a = M b - D P/rho."""
    start_reference(body, body.recovered_nodes, step * body.dt - body.recovered_numbers[H], lattice, on)
    for p in range(body.particles):
        q, X = body.position_velocity[p], body.material_position[p]
        field = ti.Vector([q[0] - X[0], q[1] - X[1], q[2], q[3]])
        body.recovered_particles[op.particle_index(body, op.FIELD, p)] = field
    op.project_along_lines(body, op.FIELD, lattice.value)
    damped_errors(body, body.recovered_nodes, step, lattice)
    op.interpolate_across_lines(body, lattice)
    compute_recovered_stress(body, lattice, on)
    op.project_body_force(body, step * body.dt, lattice, on)
    op.project_along_lines(body, op.STRESS, lattice.slope_metric)
    advance_reference_motion(body, body.recovered_nodes, body.recovered_numbers[TURNS] == BEGUN, lattice)
    body.recovered_numbers[TURNS] = MOVED


@ti.func
def damped_errors(body: ti.template(), nodes: ti.template(), step, lattice: ti.template()):
    """Sets U += H w in ``nodes``, and their errors e* = 2 e - C e + tau (1 - C)^2 e'; C smooths (see the module)."""
    op.project_across_lines(body, op.PROJECTED, op.PAIR_VALUES, lattice)
    for i in range(body.recovered_count):
        r = nodes[op.node_index(body, op.MOTION, i)]
        r += body.recovered_numbers[H] * ti.Vector([r[2], r[3], 0.0, 0.0])
        nodes[op.node_index(body, op.MOTION, i)] = r
        nodes[op.node_index(body, op.PROJECTED, i)] = nodes[op.node_index(body, op.PROJECTED, i)] - r  # not -=: atomic
    looked_at = recovered_common.is_check_due(step, body.dt, body.recovered_numbers[H])
    if looked_at:
        op.add_verdict_sums(body, nodes, lattice)
    for turn in range(2):
        op.smooth_nodes(body, lattice)
        square = 0.0
        for i in range(body.recovered_count):
            e = nodes[op.node_index(body, op.PROJECTED, i)]
            rough = e - nodes[op.node_index(body, op.SMOOTHED, i)]
            square += rough[0] * rough[0] + rough[1] * rough[1]
            if turn == 0:
                nodes[op.node_index(body, op.PROJECTED, i)] = rough
                nodes[op.node_index(body, op.ERRORS, i)] = ti.Vector([e[0] + rough[0], e[1] + rough[1], 0.0, 0.0])
            else:
                damping = body.recovered_numbers[TAU] * ti.Vector([rough[2], rough[3], 0.0, 0.0])
                nodes[op.node_index(body, op.ERRORS, i)] = nodes[op.node_index(body, op.ERRORS, i)] + damping
        if looked_at:
            body.recovered_numbers[SHORT + turn] += square / body.recovered_count


@ti.func
def compute_recovered_stress(body: ti.template(), lattice: ti.template(), on: ti.template()):
    """Stores P e_R and P e_angle, in Pa, at the particles, from slopes along the lattice's own lines."""
    op.fit_across_lines(body, op.FIELD, op.FITTED_SLOPES, op.PAIR_SLOPES, lattice)
    op.fit_along_lines(body, op.HALF_SLOPES, lattice.slope)
    for line in range(body.particles // body.recovered_line):
        for j in range(body.recovered_line):
            p = line * body.recovered_line + j
            along = body.recovered_particles[op.particle_index(body, op.HALF_SLOPES, p)]
            around = body.recovered_particles[op.particle_index(body, op.FITTED_SLOPES, p)]
            slopes = ti.Vector([along[0], along[1], around[0], around[1]]) \
                - op.interpolate_along_line(body, line, j, op.SLOPES, lattice.slope_value)
            a, b, c, d = gradient(body, p, slopes, lattice)
            body.recovered_particles[op.particle_index(body, op.STRESS, p)] = piola_stress_vectors(body, a, b, c, d, on)


@ti.func
def piola_stress_vectors(body: ti.template(), a, b, c, d, on: ti.template()):
    """Returns P e_R and P e_angle as (x, y, x, y) in Pa, where F e_R = (a, c) and F e_angle = (b, d)."""
    F = ti.Vector([a, b, c, d])
    J, q, r, _, _ = material_laws.coefficients(body, F, on)
    xx, xy, yx, yy = material_laws.piola(F, q, (r - q) / J)
    return ti.Vector([xx, yx, xy, yy])


@ti.func
def stress_error(body: ti.template(), p, a, b, c, d, on: ti.template()):
    """Returns the Cauchy stress of particle p minus that of F e_R = (a, c), F e_angle = (b, d): xx, xy, yy, 0 in Pa."""
    miss = cauchy_stress(body, p, on) - cauchy_stress_of(body, ti.Vector([a, b, c, d]), on)
    return ti.Vector([miss[0], miss[1], miss[2], 0.0])


@ti.func
def gradient(body: ti.template(), p, slopes, lattice: ti.template()):
    """Returns a, b, c, d of F e_R = (a, c) and F e_angle = (b, d) at particle p, from the displacement's ``slopes`` by
    radius (x, y) and angle (x, y); on a square of F e_x and F e_y, from slopes along x and y."""
    e, per_R = body.direction[p], 1.0
    if ti.static(not lattice.box):
        per_R = 1 / body.orbit_point[body.orbit[p]][0]
    return e[0] + slopes[0], per_R * slopes[2] - e[1], e[1] + slopes[1], per_R * slopes[3] + e[0]


@ti.func
def advance_reference_motion(body: ti.template(), nodes: ti.template(), first, lattice: ti.template()):
    """Sets acceleration and mean rate of the reference at ``nodes``; ``first`` is whether it is its first step."""
    B, step = body.recovered_line_nodes, body.recovered_numbers[H]
    op.project_across_lines(body, op.PROJECTED, op.EACH, lattice)
    for a in range(body.recovered_count // B):
        for b in range(B):
            push_x, push_y = op.nodal_body_force(body, nodes, a, b, lattice)
            parts = nodes[op.node_index(body, op.PROJECTED, a * B + b)]
            a_x = push_x - (parts[0] + parts[2]) / body.density
            a_y = push_y - (parts[1] + parts[3]) / body.density
            at_r, at_rate = op.node_index(body, op.MOTION, a * B + b), op.node_index(body, op.RATE, a * B + b)
            r, rate = nodes[at_r], nodes[at_rate]
            x, y = ti.Vector([r[0], r[2], rate[0], rate[2]]), ti.Vector([r[1], r[3], rate[1], rate[3]])
            nodes[op.node_index(body, op.BEFORE, a * B + b)] = ti.Vector([
                recovered_common.acceleration_two_steps_before(x, a_x, first),
                recovered_common.acceleration_two_steps_before(y, a_y, first), 0.0, 0.0])
            x = recovered_common.next_reference_solution(x, a_x, step, first)
            y = recovered_common.next_reference_solution(y, a_y, step, first)
            nodes[at_r], nodes[at_rate] = ti.Vector([x[0], y[0], x[1], y[1]]), ti.Vector([x[2], y[2], x[3], y[3]])


@ti.func
def report(body: ti.template(), base, step, lattice: ti.template(), on: ti.template()):
    """Writes the particles' errors of x, v, sigma after ``step`` steps, and of a one step before, to the ``estimate``
    arrays from entry ``base`` on; NaN for those that are not estimated."""
    if step > 0:
        since = recovered_common.time_since_reference_step(step, body.dt, body.recovered_numbers[H])
        start_reference(body, body.recovered_nodes, step * body.dt - since, lattice, on)
    # First x, v and sigma, then a, by the same code: it is compiled once.
    for of_acceleration in range(ti.static(2 if on.acceleration else 1)):
        for p in range(body.particles):
            field = ti.Vector([0.0, 0.0, 0.0, 0.0])
            if of_acceleration == 0:
                q, X = body.position_velocity[p], body.material_position[p]
                v_g, _, _ = gather(body, p, body.node_motion, on)  # the grid's velocity, with the last step's weights
                field = ti.Vector([q[0] - X[0], q[1] - X[1], v_g[0], v_g[1]])
            elif ti.static(on.acceleration):
                a_p = body.acceleration[p]
                field = ti.Vector([a_p[0], a_p[1], 0.0, 0.0])
            body.recovered_particles[op.particle_index(body, op.FIELD, p)] = field
        compute_nodal_errors(body, body.recovered_nodes, step, of_acceleration, lattice)
        for p in range(body.particles):
            report_particle(body, base, p, of_acceleration, lattice, on)
    silent = body.recovered_silent
    if step == 0 or silent > 0:
        nothing = 0.0 if step == 0 else ti.math.nan
        for p in range(body.particles):
            if step == 0:
                body.estimate[base + p] = ti.Vector([0.0, 0.0, 0.0, 0.0])
            if step == 0 or silent > 1:
                body.estimate_stress[base + p] = ti.Vector([nothing] * 4)
            body.estimate_acceleration[base + p] = ti.Vector([nothing] * 2)


@ti.func
def report_particle(body: ti.template(), base, p, of_acceleration, lattice: ti.template(), on: ti.template()):
    """Writes the error E of particle p to the ``estimate`` arrays: of x, v and sigma, with a unknown; or of a."""
    line, j = p // body.recovered_line, p % body.recovered_line
    field, q = body.recovered_particles[op.particle_index(body, op.FIELD, p)], body.position_velocity[p]
    fitted = body.recovered_particles[op.particle_index(body, op.FITTED, p)]
    E = op.interpolate_along_line(body, line, j, op.VALUES, lattice.value) + field - fitted
    if of_acceleration:
        body.estimate_acceleration[base + p] = ti.Vector([E[0], E[1]])
    else:
        slopes = body.recovered_particles[op.particle_index(body, op.FITTED_SLOPES, p)] \
            - op.interpolate_along_line(body, line, j, op.SLOPES, lattice.slope_value)
        a, b, c, d = gradient(body, p, slopes, lattice)
        body.estimate[base + p] = E + ti.Vector([0.0, 0.0, q[2] - field[2], q[3] - field[3]])
        body.estimate_stress[base + p] = stress_error(body, p, a, b, c, d, on)
        body.estimate_acceleration[base + p] = ti.Vector([ti.math.nan, ti.math.nan])


@ti.func
def compute_nodal_errors(body: ti.template(), nodes: ti.template(), step, of_acceleration, lattice: ti.template()):
    """Stores nodal errors of the particles' fields after ``step`` steps, unsmoothed and interpolated across lines; and
    the fitted fields, unless ``of_acceleration`` with their slopes."""
    op.project_along_lines(body, op.FIELD, lattice.value)
    op.project_across_lines(body, op.PROJECTED, op.PAIR_VALUES, lattice)
    length = body.recovered_numbers[H]
    since = recovered_common.time_since_reference_step(step, body.dt, length)
    for i in range(body.recovered_count):
        r, rate = nodes[op.node_index(body, op.MOTION, i)], nodes[op.node_index(body, op.RATE, i)]
        x = ti.Vector([r[0], r[2], rate[0], rate[2]])
        y = ti.Vector([r[1], r[3], rate[1], rate[3]])
        before = nodes[op.node_index(body, op.BEFORE, i)]
        U_x, V_x, A_x = recovered_common.reference_solution_at(x, before[0], length, since, body.dt)
        U_y, V_y, A_y = recovered_common.reference_solution_at(y, before[1], length, since, body.dt)
        true_mean = ti.Vector([U_x, U_y, V_x, V_y])
        if of_acceleration:
            true_mean = ti.Vector([A_x, A_y, 0.0, 0.0])
            if body.recovered_numbers[TURNS] == BEGUN:  # as on the bar
                true_mean = nodes[op.node_index(body, op.PROJECTED, i)]
        nodes[op.node_index(body, op.PROJECTED, i)] = nodes[op.node_index(body, op.PROJECTED, i)] - true_mean
    op.smooth_nodes(body, lattice)
    for i in range(body.recovered_count):
        nodes[op.node_index(body, op.ERRORS, i)] = 2 * nodes[op.node_index(body, op.PROJECTED, i)] \
            - nodes[op.node_index(body, op.SMOOTHED, i)]
    op.interpolate_across_lines(body, lattice)
    op.fit_along_lines(body, op.HALF_FITTED, lattice.value)
    op.fit_across_lines(body, op.HALF_FITTED, op.FITTED, op.PAIR_VALUES, lattice)
    if not of_acceleration:
        op.fit_along_lines(body, op.HALF_SLOPES, lattice.slope)
        for p in range(body.particles):
            slope = body.recovered_particles[op.particle_index(body, op.HALF_SLOPES, p)]
            value = body.recovered_particles[op.particle_index(body, op.HALF_FITTED, p)]
            body.recovered_particles[op.particle_index(body, op.HALF_SLOPES, p)] = \
                ti.Vector([slope[0], slope[1], value[0], value[1]])
        op.fit_across_lines(body, op.HALF_SLOPES, op.FITTED_SLOPES, op.EACH, lattice)


def hooks(lattice: op.LatticeKernelOptions) -> EstimatorHooks:
    """Returns recovered's hooks for problems whose particles start on this ``lattice``."""
    @ti.func
    def its_step(body: ti.template(), base, step, on: ti.template()):
        after_step(body, step, lattice, on)

    @ti.func
    def its_report(body: ti.template(), base, step, on: ti.template()):
        report(body, base, step, lattice, on)

    return EstimatorHooks(memory=MEMORY, allocate=allocate, interval=interval, after_step=its_step, report=its_report,
                          verdict=verdict)
