"""The recovered estimator in the plane: as on the bar (see there), on the polar material lattice of a ring.

The weak form, in the material frame with the error grid's functions N = N_b(R) N_a(angle) and Cartesian components,

    (M u)'' = M b - D P / rho,    M f = int N f / int N,    D P = int P grad N / int N,

leaves the free surfaces natural: a traction on them would be seen. P grad N = (P e_R) N_b' N_a
+ (P e_angle) N_b N_a'/R. Every operator is a product of one along the radius and one along the angle
(``lattice_lines``); symmetry planes are mirrors, with signs of their own for each component, and a whole turn closes on
itself.

All else is as on the bar: U = M u_exact is integrated from the initial state, driven by P at the recovered gradient
less that of the error; E = sum_i N_i (2 e - C e)_i + (u - fit u), e = M u - U; and sigma is compared with the stress at
the recovered gradient less that of the error. In a step the gradient is recovered on one line each way; for a report
over a patch.

Assumptions: as on the bar; the particles began on a polar lattice, of four particles or more across. It fails where the
solution varies within a fit of four cells. Nothing is said of sigma and a where the particles are so uneven that the
fit follows them: one particle per cell, or particles moved with their own velocity (eq 24 as printed).
"""

import numpy as np
import taichi as ti

from solvers.estimators import recovery
from solvers.estimators.lattice_lines import Line
from solvers.estimators.recovery import BEGUN, MOVED, NEW, SHORT, TAU, TURNS, H
from solvers.kernels.kinds import quads, reals
from solvers.problems.planar.estimators import recovered_operators as op
from solvers.problems.planar.estimators.recovered_tables import across_planes, gathered_directions, of_four, verdict
from solvers.problems.planar.layout import on_axis
from solvers.problems.planar.method import material
from solvers.problems.planar.method.neo_hookean import ALONE, cauchy_stress, cauchy_stress_of
from solvers.problems.planar.method.phases import gather
from solvers.scene.estimator_hooks import EstimatorHooks

SPARSE_WIDTH = 1.5  # cells to an element with one particle per cell
WAVE_CFL = 0.7  # H c over the shortest side of an element, where the run's own step is shorter
MOST_CFL = {"mirror": 0.72, "periodic": 0.8}  # the same where it is not: beyond .74 and .84 the reference breaks down

MEMORY = {
    "recovered_numbers": reals,  # by the names of solvers.estimators.recovery
    **recovery.table_types(op.TABLES),
    "recovered_count": ti.i32, "recovered_across": ti.i32,  # nodes of the error grid, and those on a radius
    "recovered_silent": ti.i32,  # of how many quantities nothing is said: 1 of a, 2 of sigma too
    "recovered_nodes": quads,  # nodal values, block by block
    "recovered_particles": quads,  # fields at particles, and half-way values on radii with nodes on them
}


@ti.func
def begin(body: ti.template(), nodes: ti.template(), t, closed: ti.template(), on: ti.template()):
    """Unless it is done: start the reference with the acceleration at time t, when the ring was undeformed, a = M b."""
    if body.recovered_numbers[TURNS] == NEW:
        op.gather_force(body, t, on)
        B, step = body.recovered_across, body.recovered_numbers[H]
        for a in range(body.recovered_count // B):
            for b in range(B):
                push_x, push_y = op.node_force(body, nodes, a, b, closed)
                at_r, at_rate = op.node_at(body, op.MOTION, a * B + b), op.node_at(body, op.RATE, a * B + b)
                r = nodes[at_r]
                x = recovery.with_start(ti.Vector([r[0], r[2], 0.0, 0.0]), push_x, step)
                y = recovery.with_start(ti.Vector([r[1], r[3], 0.0, 0.0]), push_y, step)
                nodes[at_r], nodes[at_rate] = ti.Vector([x[0], y[0], x[1], y[1]]), ti.Vector([x[2], y[2], x[3], y[3]])
                nodes[op.node_at(body, op.BEFORE, a * B + b)] = ti.Vector([push_x, push_y, 0.0, 0.0])
        body.recovered_numbers[TURNS] = BEGUN


@ti.func
def after_step(body: ti.template(), step, closed: ti.template(), on: ti.template()):
    """U += H w; the error's gradient corrects the recovered one; w += H (a + correction), a = M b - D P/rho."""
    begin(body, body.recovered_nodes, step * body.dt - body.recovered_numbers[H], closed, on)
    for p in range(body.particles):
        q, X = body.position_velocity[p], body.material_position[p]
        body.recovered_particles[op.particle_at(body, op.FIELD, p)] = ti.Vector([q[0] - X[0], q[1] - X[1], q[2], q[3]])
    op.radial_gather(body, op.FIELD, op.VALUE)
    damped_errors(body, body.recovered_nodes, step, closed)
    op.angular_spread(body, closed)
    find_stress(body, closed)
    op.gather_force(body, step * body.dt, on)
    op.radial_gather(body, op.STRESS, op.SLOPE_AND_OVER_R)
    move_reference(body, body.recovered_nodes, body.recovered_numbers[TURNS] == BEGUN, closed)
    body.recovered_numbers[TURNS] = MOVED


@ti.func
def damped_errors(body: ti.template(), nodes: ti.template(), step, closed: ti.template()):
    """U += H w at the nodes, and e* = 2 e - C e + tau (1 - C)^2 e'."""
    op.angular_gather(body, op.GATHERED, op.ANGULAR_VALUES, closed)
    for i in range(body.recovered_count):
        r = nodes[op.node_at(body, op.MOTION, i)]
        r += body.recovered_numbers[H] * ti.Vector([r[2], r[3], 0.0, 0.0])
        nodes[op.node_at(body, op.MOTION, i)] = r
        nodes[op.node_at(body, op.GATHERED, i)] = nodes[op.node_at(body, op.GATHERED, i)] - r  # not -=: atomic
    looked_at = recovery.looks(step, body.dt, body.recovered_numbers[H])
    if looked_at:
        op.remember_sizes(body, nodes, closed)
    for turn in range(2):
        op.smoothing(body, closed)
        square = 0.0
        for i in range(body.recovered_count):
            e = nodes[op.node_at(body, op.GATHERED, i)]
            rough = e - nodes[op.node_at(body, op.SMOOTHED, i)]
            square += rough[0] * rough[0] + rough[1] * rough[1]
            if turn == 0:
                nodes[op.node_at(body, op.GATHERED, i)] = rough
                nodes[op.node_at(body, op.ERRORS, i)] = ti.Vector([e[0] + rough[0], e[1] + rough[1], 0.0, 0.0])
            else:
                damping = body.recovered_numbers[TAU] * ti.Vector([rough[2], rough[3], 0.0, 0.0])
                nodes[op.node_at(body, op.ERRORS, i)] = nodes[op.node_at(body, op.ERRORS, i)] + damping
        if looked_at:
            body.recovered_numbers[SHORT + turn] += square / body.recovered_count


@ti.func
def find_stress(body: ti.template(), closed: ti.template()):
    """P e_R and P e_angle at the particles, from slopes along the lattice's own lines."""
    op.angular_fit(body, op.FIELD, op.FITTED_SLOPES, op.ANGULAR_SLOPES, closed)
    op.radial_fit(body, op.HALF_SLOPES, op.SLOPE)
    for line in range(body.particles // body.orbits):
        for j in range(body.orbits):
            p = line * body.orbits + j
            along = body.recovered_particles[op.particle_at(body, op.HALF_SLOPES, p)]
            around = body.recovered_particles[op.particle_at(body, op.FITTED_SLOPES, p)]
            slopes = ti.Vector([along[0], along[1], around[0], around[1]]) - op.radial_spread(body, line, j, op.SLOPES)
            a, b, c, d = polar_gradient(body, p, slopes)
            body.recovered_particles[op.particle_at(body, op.STRESS, p)] = piola(body, a, b, c, d)


@ti.func
def piola(body: ti.template(), a, b, c, d):
    """P e_R and P e_angle as (x, y, x, y), where F e_R = (a, c) and F e_angle = (b, d)."""
    F = ti.Vector([a, b, c, d])
    J, q, r, _, _ = material.coefficients(body, F, ALONE)
    xx, xy, yx, yy = material.piola(F, q, (r - q) / J)
    return ti.Vector([xx, yx, xy, yy])


@ti.func
def stress_error(body: ti.template(), p, a, b, c, d):
    """The Cauchy stress of a particle less that of such a gradient, as xx, xy, yy and nothing."""
    miss = cauchy_stress(body, p) - cauchy_stress_of(body, ti.Vector([a, b, c, d]))
    return ti.Vector([miss[0], miss[1], miss[2], 0.0])


@ti.func
def polar_gradient(body: ti.template(), p, slopes):
    """F e_R = (a, c) and F e_angle = (b, d) at particle p, from the displacement's slopes along the radius and around
    it."""
    e, per_R = body.direction[p], 1 / body.orbit_point[body.orbit[p]][0]
    return e[0] + slopes[0], per_R * slopes[2] - e[1], e[1] + slopes[1], per_R * slopes[3] + e[0]


@ti.func
def move_reference(body: ti.template(), nodes: ti.template(), first, closed: ti.template()):
    """The acceleration of every node, and the rate that follows."""
    B, step = body.recovered_across, body.recovered_numbers[H]
    op.angular_gather(body, op.GATHERED, op.EACH, closed)
    for a in range(body.recovered_count // B):
        for b in range(B):
            push_x, push_y = op.node_force(body, nodes, a, b, closed)
            parts = nodes[op.node_at(body, op.GATHERED, a * B + b)]
            a_x = push_x - (parts[0] + parts[2]) / body.density
            a_y = push_y - (parts[1] + parts[3]) / body.density
            at_r, at_rate = op.node_at(body, op.MOTION, a * B + b), op.node_at(body, op.RATE, a * B + b)
            r, rate = nodes[at_r], nodes[at_rate]
            x, y = ti.Vector([r[0], r[2], rate[0], rate[2]]), ti.Vector([r[1], r[3], rate[1], rate[3]])
            nodes[op.node_at(body, op.BEFORE, a * B + b)] = ti.Vector([
                recovery.second_before(x, a_x, first), recovery.second_before(y, a_y, first), 0.0, 0.0])
            x, y = recovery.next_reference(x, a_x, step, first), recovery.next_reference(y, a_y, step, first)
            nodes[at_r], nodes[at_rate] = ti.Vector([x[0], y[0], x[1], y[1]]), ti.Vector([x[2], y[2], x[3], y[3]])


@ti.func
def report(body: ti.template(), base, step, closed: ti.template(), on: ti.template()):
    """Estimated errors of x, v, sigma at the state's time and of a at the last step's, on the particles."""
    if step > 0:
        since = recovery.time_since(step, body.dt, body.recovered_numbers[H])
        begin(body, body.recovered_nodes, step * body.dt - since, closed, on)
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
            body.recovered_particles[op.particle_at(body, op.FIELD, p)] = field
        find_errors(body, body.recovered_nodes, step, of_acceleration, closed)
        for p in range(body.particles):
            report_particle(body, base, p, of_acceleration, closed)
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
def report_particle(body: ti.template(), base, p, of_acceleration, closed: ti.template()):
    """E of the fields at a particle: of x and v, and that of sigma; or of a, which is unknown until then."""
    line, j = p // body.orbits, p % body.orbits
    field, q = body.recovered_particles[op.particle_at(body, op.FIELD, p)], body.position_velocity[p]
    fitted = body.recovered_particles[op.particle_at(body, op.FITTED, p)]
    E = op.radial_spread(body, line, j, op.VALUES) + field - fitted
    if of_acceleration:
        body.estimate_acceleration[base + p] = ti.Vector([E[0], E[1]])
    else:
        a, b, c, d = polar_gradient(body, p, body.recovered_particles[op.particle_at(body, op.FITTED_SLOPES, p)]
                                    - op.radial_spread(body, line, j, op.SLOPES))
        body.estimate[base + p] = E + ti.Vector([0.0, 0.0, q[2] - field[2], q[3] - field[3]])
        body.estimate_stress[base + p] = stress_error(body, p, a, b, c, d)
        body.estimate_acceleration[base + p] = ti.Vector([ti.math.nan, ti.math.nan])


@ti.func
def find_errors(body: ti.template(), nodes: ti.template(), step, of_acceleration, closed: ti.template()):
    """Nodal errors of the fields, unsmoothed and spread along the angle; and the fields fitted, the first of x and v
    with its slopes."""
    op.radial_gather(body, op.FIELD, op.VALUE)
    op.angular_gather(body, op.GATHERED, op.ANGULAR_VALUES, closed)
    length = body.recovered_numbers[H]
    since = recovery.time_since(step, body.dt, length)
    for i in range(body.recovered_count):
        r, rate = nodes[op.node_at(body, op.MOTION, i)], nodes[op.node_at(body, op.RATE, i)]
        x = ti.Vector([r[0], r[2], rate[0], rate[2]])
        y = ti.Vector([r[1], r[3], rate[1], rate[3]])
        before = nodes[op.node_at(body, op.BEFORE, i)]
        U_x, V_x, A_x = recovery.reference_at(x, before[0], length, since, body.dt)
        U_y, V_y, A_y = recovery.reference_at(y, before[1], length, since, body.dt)
        true_mean = ti.Vector([U_x, U_y, V_x, V_y])
        if of_acceleration:
            true_mean = ti.Vector([A_x, A_y, 0.0, 0.0])
            if body.recovered_numbers[TURNS] == BEGUN:  # as on the bar
                true_mean = nodes[op.node_at(body, op.GATHERED, i)]
        nodes[op.node_at(body, op.GATHERED, i)] = nodes[op.node_at(body, op.GATHERED, i)] - true_mean
    op.smoothing(body, closed)
    for i in range(body.recovered_count):
        nodes[op.node_at(body, op.ERRORS, i)] = 2 * nodes[op.node_at(body, op.GATHERED, i)] \
            - nodes[op.node_at(body, op.SMOOTHED, i)]
    op.angular_spread(body, closed)
    op.radial_fit(body, op.HALF_FITTED, op.VALUE)
    op.angular_fit(body, op.HALF_FITTED, op.FITTED, op.ANGULAR_VALUES, closed)
    if not of_acceleration:
        op.radial_fit(body, op.HALF_SLOPES, op.SLOPE)
        for p in range(body.particles):
            slope = body.recovered_particles[op.particle_at(body, op.HALF_SLOPES, p)]
            value = body.recovered_particles[op.particle_at(body, op.HALF_FITTED, p)]
            body.recovered_particles[op.particle_at(body, op.HALF_SLOPES, p)] = \
                ti.Vector([slope[0], slope[1], value[0], value[1]])
        op.angular_fit(body, op.HALF_SLOPES, op.FITTED_SLOPES, op.EACH, closed)


def hooks(closed: bool) -> EstimatorHooks:
    """The estimator of problems on a whole turn, which closes on itself, or on a part of one between symmetry planes,
    where only radial forces can act."""
    @ti.func
    def its_step(body: ti.template(), base, step, on: ti.template()):
        after_step(body, step, closed, on)

    @ti.func
    def its_report(body: ti.template(), base, step, on: ti.template()):
        report(body, base, step, closed, on)

    return EstimatorHooks(memory=MEMORY, allocate=allocate, interval=interval, after_step=its_step, report=its_report,
                          verdict=verdict)


def interval(scene):
    """Steps of the run to one of the estimator's: its reference moves by an explicit method in the material frame, with
    elements whose sides along the fastest circle a wave passes at the scene's ``crossing_rate``. Where that is sheared
    much, steps are hardly longer than the run's, and then it costs more than the run."""
    angle, radius = lines(scene)
    side = 1 / angle.per_element / scene.crossing_rate
    return recovery.steps_between(scene, WAVE_CFL * min(side, 1 / radius.per_element))


def lines(scene):
    """The lattice's lines, around and across the ring, with elements a cell wide at the inner rim.

    With one particle per cell they are half as wide again: elements as narrow as the particles' spacing are unstable.
    None is narrower than the reference's step bears, which is no shorter than the run's.
    """
    width = scene.spacing * (SPARSE_WIDTH if scene.ppc == 1 else 1.0)
    turn, across, counts = scene.ANGLE, scene.OUTER - scene.INNER, scene.polar_counts(scene.cells, scene.ppc)
    ends = "periodic" if turn >= 2 * np.pi else "mirror"
    narrowest = scene.wave_speed * scene.time_step / MOST_CFL[ends]
    around, radial = (min(round(length / width), int(length / narrowest)) for length in (turn * scene.INNER, across))
    return Line(counts[0], max(3, around), turn, ends), Line(counts[1], max(1, radial), across, "free")


def allocate(scene):
    """Operators along both lines, and the reference in the initial configuration."""
    (angle, radius), inner = lines(scene), scene.INNER
    velocity = scene.EXACT.velocity(scene, on_axis(inner + radius.particles() / radius.per_point), 0.0).T
    width, R = recovery.fit_width(scene), inner + radius.quadrature()[0] / radius.per_point
    angular = [angle.fit(width, 3), angle.spread(), angle.gather(4, 2), angle.smoothing()]
    radial = [radius.fit(width, 3), radius.spread(), radius.gather(4, 2, R), radius.smoothing(R)]
    tables = dict(zip(op.TABLES, [*map(across_planes, angular), *map(of_four, radial)], strict=True))
    direction, across = gathered_directions(angle, angular[2])
    speed, turning = (radial[2](v)[:, 0, 0, None] for v in velocity)
    fields = op.PARTICLE_BLOCKS * angle.points * radius.points + 2 * angle.points * radius.nodes
    nodes = np.zeros((op.NODE_BLOCKS, angle.nodes * radius.nodes, 4))
    nodes[op.MOTION, :, 2:] = (direction[:, None] * speed + across[:, None] * turning).reshape(-1, 2)
    nodes[op.DIRECTION, :angle.nodes] = np.concatenate([direction, across], axis=1)
    return {"recovered_numbers": recovery.numbers(scene, interval(scene)), **recovery.table_values(tables),
            "recovered_count": angle.nodes * radius.nodes, "recovered_across": radius.nodes,
            "recovered_silent": 2 if scene.uneven else int(scene.coarse), "recovered_nodes": nodes.reshape(-1, 4),
            "recovered_particles": np.zeros((fields, 4))}
