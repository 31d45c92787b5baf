"""The recovered estimator on the ring: as on the bar (see there), on the polar material lattice.

The weak form, in the material frame with the error grid's functions N = N_b(R) N_a(angle) and Cartesian components,

    (M u)'' = M b - D P / rho,    M f = int N f / int N,    D P = int P grad N / int N,

leaves the free surfaces natural: a traction on them would be seen. Here P = mu (F - F^-T), and P grad N
= (P e_R) N_b' N_a + (P e_angle) N_b N_a'/R. Every operator is a product of one along the radius and one along the angle
(``lattice_lines``); symmetry planes are mirrors, with signs of their own for each component.

All else is as on the bar: U = M u_exact is integrated from the initial state, driven by P at the recovered gradient
less that of the error; E = sum_i N_i (2 e - C e)_i + (u - fit u), e = M u - U; and sigma is compared with the stress at
the recovered gradient less that of the error. In a step the gradient is recovered on one line each way; for a report
over a patch.

Assumptions: as on the bar; the particles began on a polar lattice, of four particles or more across, with lambda = 0.
It fails where the solution varies within a fit of four cells. Nothing is said of sigma and a where the particles are so
uneven that the fit follows them: one particle per cell, or particles moved with their own velocity (eq 24 as printed).
"""

import numpy as np
import taichi as ti

from solvers.estimators import recovery
from solvers.estimators.interface import EstimatorHooks
from solvers.estimators.lattice_lines import Line, Rows
from solvers.estimators.recovery import BEGUN, MOVED, NEW, TAU, TURNS, H
from solvers.kinds import quads, reals
from solvers.planar.phases import gather
from solvers.ring import exact, validity
from solvers.ring.estimators import recovered_operators as op
from solvers.ring.material import kirchhoff_stress
from solvers.ring.scene import polar_counts

MOST_ROUGH = 7.0  # from 7.7 on x was .99 to 30 times the error in 45 random runs, below it .96 to 1.06
SPARSE_WIDTH = 1.5  # cells to an element with one particle per cell
WAVE_CFL = 0.7  # H c over the shortest side of an element; stable to 0.9 while little is compressed


@ti.func
def begin(ring: ti.template(), nodes: ti.template(), t, on: ti.template()):
    """Unless it is done: start the reference with the acceleration at time t, when the ring was undeformed, a = M b."""
    if ring.recovered_numbers[TURNS] == NEW:
        op.gather_force(ring, t, on)
        B, step = ring.recovered_across, ring.recovered_numbers[H]
        for a in range(ring.recovered_count // B):
            e = nodes[op.node_at(ring, op.DIRECTION, a)]
            for b in range(B):
                push = nodes[op.node_at(ring, op.FORCE, b)][0]
                at_r, at_rate = op.node_at(ring, op.MOTION, a * B + b), op.node_at(ring, op.RATE, a * B + b)
                r = nodes[at_r]
                x = recovery.with_start(ti.Vector([r[0], r[2], 0.0, 0.0]), push * e[0], step)
                y = recovery.with_start(ti.Vector([r[1], r[3], 0.0, 0.0]), push * e[1], step)
                nodes[at_r], nodes[at_rate] = ti.Vector([x[0], y[0], x[1], y[1]]), ti.Vector([x[2], y[2], x[3], y[3]])
        ring.recovered_numbers[TURNS] = BEGUN


@ti.func
def after_step(ring: ti.template(), base, step, on: ti.template()):
    """U += H w; the error's gradient corrects the recovered one; w += H (a + correction), a = M b - D P/rho."""
    begin(ring, ring.recovered_nodes, step * ring.dt - ring.recovered_numbers[H], on)
    for p in range(ring.particles):
        q, X = ring.motion[p], ring.material_position[p]
        ring.recovered_particles[op.particle_at(ring, op.FIELD, p)] = ti.Vector([q[0] - X[0], q[1] - X[1], q[2], q[3]])
    op.radial_gather(ring, op.FIELD, op.VALUE)
    damped_errors(ring, ring.recovered_nodes)
    op.angular_spread(ring)
    find_stress(ring)
    op.gather_force(ring, step * ring.dt, on)
    op.radial_gather(ring, op.STRESS, op.SLOPE_AND_OVER_R)
    move_reference(ring, ring.recovered_nodes, ring.recovered_numbers[TURNS] == BEGUN)
    ring.recovered_numbers[TURNS] = MOVED


@ti.func
def damped_errors(ring: ti.template(), nodes: ti.template()):
    """U += H w at the nodes, and e* = 2 e - C e + tau (1 - C)^2 e'."""
    B = ring.recovered_across
    for a in range(ring.recovered_count // B):
        for b in range(B):
            i = a * B + b
            r = nodes[op.node_at(ring, op.MOTION, i)]
            r += ring.recovered_numbers[H] * ti.Vector([r[2], r[3], 0.0, 0.0])
            nodes[op.node_at(ring, op.MOTION, i)] = r
            nodes[op.node_at(ring, op.GATHERED, i)] = op.angular_gather(ring, a, b, op.ANGULAR_VALUES) - r
    op.remember_sizes(ring, nodes)
    op.radial_smoothing(ring)
    for a in range(ring.recovered_count // B):
        for b in range(B):
            e = nodes[op.node_at(ring, op.GATHERED, a * B + b)]
            rough = e - op.angular_smoothing(ring, a, b)
            nodes[op.node_at(ring, op.GATHERED, a * B + b)] = rough
            nodes[op.node_at(ring, op.ERRORS, a * B + b)] = ti.Vector([e[0] + rough[0], e[1] + rough[1], 0.0, 0.0])
    op.radial_smoothing(ring)
    for a in range(ring.recovered_count // B):
        for b in range(B):
            rough = nodes[op.node_at(ring, op.GATHERED, a * B + b)] - op.angular_smoothing(ring, a, b)
            damping = ring.recovered_numbers[TAU] * ti.Vector([rough[2], rough[3], 0.0, 0.0])
            e = nodes[op.node_at(ring, op.ERRORS, a * B + b)]  # not +=, an atomic addition
            nodes[op.node_at(ring, op.ERRORS, a * B + b)] = e + damping


@ti.func
def find_stress(ring: ti.template()):
    """P e_R and P e_angle at the particles, mu (F - F^-T), from slopes along the lattice's own lines."""
    for line in range(ring.particles // ring.radius_count):
        for j in range(ring.radius_count):
            p = line * ring.radius_count + j
            along, around = op.line_slopes(ring, line, j)
            _, error_along, error_around = op.radial_spread(ring, line, j)
            a, b, c, d = polar_gradient(ring, p, along - error_along, around - error_around)
            per_J = 1 / (a * d - b * c)
            ring.recovered_particles[op.particle_at(ring, op.STRESS, p)] = ring.shear_modulus * ti.Vector(
                [a - per_J * d, c + per_J * b, b + per_J * c, d - per_J * a])


@ti.func
def polar_gradient(ring: ti.template(), p, along, around):
    """F e_R = (a, c) and F e_angle = (b, d) at particle p, from the displacement's slopes."""
    e, per_R = ring.direction[p], 1 / ring.radii[ring.radius[p]][0]
    return e[0] + along[0], per_R * around[0] - e[1], e[1] + along[1], per_R * around[1] + e[0]


@ti.func
def move_reference(ring: ti.template(), nodes: ti.template(), first):
    """The acceleration of every node, and the rate that follows."""
    B, step = ring.recovered_across, ring.recovered_numbers[H]
    for a in range(ring.recovered_count // B):
        e = nodes[op.node_at(ring, op.DIRECTION, a)]
        for b in range(B):
            push = nodes[op.node_at(ring, op.FORCE, b)][0]
            parts = op.angular_gather(ring, a, b, op.EACH)
            a_x = push * e[0] - (parts[0] + parts[2]) / ring.density
            a_y = push * e[1] - (parts[1] + parts[3]) / ring.density
            at_r, at_rate = op.node_at(ring, op.MOTION, a * B + b), op.node_at(ring, op.RATE, a * B + b)
            r, rate = nodes[at_r], nodes[at_rate]
            x = recovery.next_reference(ti.Vector([r[0], r[2], rate[0], rate[2]]), a_x, step, first)
            y = recovery.next_reference(ti.Vector([r[1], r[3], rate[1], rate[3]]), a_y, step, first)
            nodes[at_r], nodes[at_rate] = ti.Vector([x[0], y[0], x[1], y[1]]), ti.Vector([x[2], y[2], x[3], y[3]])


@ti.func
def report(ring: ti.template(), base, step, on: ti.template()):
    """Estimated errors of x, v, sigma at the state's time and of a at the last step's, on the particles."""
    if step > 0:
        since = recovery.time_since(step, ring.dt, ring.recovered_numbers[H])
        begin(ring, ring.recovered_nodes, step * ring.dt - since, on)
    # First x, v and sigma, then a, by the same code: it is compiled once.
    for of_acceleration in range(ti.static(2 if on.acceleration else 1)):
        for p in range(ring.particles):
            field = ti.Vector([0.0, 0.0, 0.0, 0.0])
            if of_acceleration == 0:
                q, X = ring.motion[p], ring.material_position[p]
                v_g, _, _ = gather(ring, p, ring.node_motion, on)  # the grid's velocity, with the last step's weights
                field = ti.Vector([q[0] - X[0], q[1] - X[1], v_g[0], v_g[1]])
            elif ti.static(on.acceleration):
                a_p = ring.acceleration[p]
                field = ti.Vector([a_p[0], a_p[1], 0.0, 0.0])
            ring.recovered_particles[op.particle_at(ring, op.FIELD, p)] = field
        find_errors(ring, ring.recovered_nodes, step, of_acceleration)
        for p in range(ring.particles):
            report_particle(ring, base, p, of_acceleration)
    unknown = step > 0 and ring.recovered_uneven  # of sigma and a
    if step == 0 or unknown:
        nothing = ti.math.nan if unknown else 0.0
        for p in range(ring.particles):
            if step == 0:
                ring.estimate[base + p] = ti.Vector([0.0, 0.0, 0.0, 0.0])
            ring.estimate_stress[base + p] = ti.Vector([nothing] * 4)
            ring.estimate_acceleration[base + p] = ti.Vector([nothing] * 2)


@ti.func
def report_particle(ring: ti.template(), base, p, of_acceleration):
    """E of the fields at a particle: of x and v, and that of sigma; or of a, which is unknown until then."""
    line, j = p // ring.radius_count, p % ring.radius_count
    fitted, along, around = op.angular_fit(ring, line, j)
    error, error_along, error_around = op.radial_spread(ring, line, j)
    field, q = ring.recovered_particles[op.particle_at(ring, op.FIELD, p)], ring.motion[p]
    E = error + field - fitted
    if of_acceleration:
        ring.estimate_acceleration[base + p] = ti.Vector([E[0], E[1]])
    else:
        ring.estimate[base + p] = E + ti.Vector([0.0, 0.0, q[2] - field[2], q[3] - field[3]])
        ring.estimate_stress[base + p] = stress_error(ring, p, along - error_along, around - error_around)
        ring.estimate_acceleration[base + p] = ti.Vector([ti.math.nan, ti.math.nan])


@ti.func
def find_errors(ring: ti.template(), nodes: ti.template(), step, of_acceleration):
    """Nodal errors of the fields, unsmoothed and spread along the angle; and the fields fitted along each radius."""
    op.radial_gather(ring, op.FIELD, op.VALUE)
    B, length = ring.recovered_across, ring.recovered_numbers[H]
    since = recovery.time_since(step, ring.dt, length)
    for a in range(ring.recovered_count // B):
        for b in range(B):
            i = a * B + b
            r, rate = nodes[op.node_at(ring, op.MOTION, i)], nodes[op.node_at(ring, op.RATE, i)]
            x = ti.Vector([r[0], r[2], rate[0], rate[2]])
            y = ti.Vector([r[1], r[3], rate[1], rate[3]])
            U_x, V_x, A_x = recovery.reference_at(x, length, since, ring.dt)
            U_y, V_y, A_y = recovery.reference_at(y, length, since, ring.dt)
            true_mean = ti.Vector([U_x, U_y, V_x, V_y])
            if of_acceleration:
                true_mean = ti.Vector([A_x, A_y, 0.0, 0.0])
            nodes[op.node_at(ring, op.GATHERED, i)] = op.angular_gather(ring, a, b, op.ANGULAR_VALUES) - true_mean
    op.radial_smoothing(ring)
    for a in range(ring.recovered_count // B):
        for b in range(B):
            e = nodes[op.node_at(ring, op.GATHERED, a * B + b)]
            nodes[op.node_at(ring, op.ERRORS, a * B + b)] = 2 * e - op.angular_smoothing(ring, a, b)
    op.angular_spread(ring)
    op.radial_fit(ring)


@ti.func
def stress_error(ring: ti.template(), p, along, around):
    """sigma_p less mu/J (F F^T - I) at the gradient with these slopes; as xx, xy, yy and nothing."""
    a, b, c, d = polar_gradient(ring, p, along, around)
    F = ring.deformation_gradient[p]
    own = kirchhoff_stress(ring, p) / (F[0] * F[3] - F[1] * F[2])
    scale = ring.shear_modulus / (a * d - b * c)
    return ti.Vector([own[0] - scale * (a * a + b * b - 1), own[1] - scale * (a * c + b * d),
                      own[2] - scale * (c * c + d * d - 1), 0.0])


def lines(scene):
    """The lattice's lines, around the quarter and across the ring, with elements a cell wide at the inner radius.

    With one particle per cell they are half as wide again: elements as narrow as the particles' spacing are unstable.
    """
    around, across = polar_counts(scene.cells, scene.ppc)
    width = scene.spacing * (SPARSE_WIDTH if scene.ppc == 1 else 1.0)
    elements = round(0.5 * np.pi * exact.INNER / width), round((exact.OUTER - exact.INNER) / width)
    return (Line(around, max(3, elements[0]), 0.5 * np.pi, "mirror"),
            Line(across, max(1, elements[1]), exact.OUTER - exact.INNER, "free"))


def interval(scene):
    angle, radius = lines(scene)
    return recovery.steps_between(scene, WAVE_CFL * min(exact.INNER / angle.per_element, 1 / radius.per_element))


def allocate(scene):
    """Operators along both lines, and the reference in the initial configuration."""
    angle, radius = lines(scene)
    width, R = recovery.fit_width(scene), exact.INNER + radius.quadrature()[0] / radius.per_point
    angular = [angle.fit(width, 3), angle.spread(), angle.gather(4, 2), angle.smoothing()]
    radial = [radius.fit(width, 3), radius.spread(), radius.gather(4, 2, R), radius.smoothing(R)]
    tables = dict(zip(op.TABLES, [*map(across_planes, angular), *map(of_four, radial)], strict=True))
    theta = angle.particles() / angle.per_point
    direction = np.stack([angular[2](wave)[:, c, 0] for c, wave in enumerate((np.cos(theta), np.sin(theta)))], axis=1)
    # The initial velocity is radial.
    v0 = scene.amplitude * scene.angular_frequency * exact.shape(exact.INNER + radius.particles() / radius.per_point)[0]
    fields = op.PARTICLE_BLOCKS * angle.points * radius.points + 2 * angle.points * radius.nodes
    nodes = np.zeros((op.NODE_BLOCKS, angle.nodes * radius.nodes, 4))
    nodes[op.MOTION, :, 2:] = (direction[:, None] * radial[2](v0)[:, 0, 0, None]).reshape(-1, 2)
    nodes[op.DIRECTION, :angle.nodes, :2] = direction
    return {"recovered_numbers": recovery.numbers(scene, interval(scene)), **recovery.table_values(tables),
            "recovered_count": angle.nodes * radius.nodes, "recovered_across": radius.nodes,
            "recovered_uneven": int(validity.uneven(scene)), "recovered_nodes": nodes.reshape(-1, 4),
            "recovered_particles": np.zeros((fields, 4))}


def verdict(scene, memory):
    U = memory["recovered_nodes"].reshape(op.NODE_BLOCKS, -1, 4)[op.MOTION, :, :2]
    return recovery.doubt(memory, MOST_ROUGH, np.abs(U).max() / scene.motion_amplitude)


def across_planes(rows):
    """Weights as (value x, value y, slope x, slope y)."""
    return Rows(rows.first, np.swapaxes(rows.weights[..., :2], 2, 3).reshape(*rows.weights.shape[:2], 4))


def of_four(rows):
    """Weights of the one component that a radius has, filled up to four."""
    weights = rows.weights[:, :, 0]
    return Rows(rows.first, np.concatenate([weights, np.zeros((*weights.shape[:2], 4 - weights.shape[2]))], axis=2))


HOOKS = EstimatorHooks(
    memory={
        "recovered_numbers": reals,  # by the names of solvers.estimators.recovery
        **recovery.table_types(op.TABLES),
        "recovered_count": ti.i32, "recovered_across": ti.i32,  # nodes of the error grid, and those on a radius
        "recovered_uneven": ti.i32,  # a flag
        "recovered_nodes": quads,  # nodal values, block by block
        "recovered_particles": quads,  # fields at particles, and half-way values on radii with nodes on them
    },
    allocate=allocate, interval=interval, after_step=after_step, report=report, verdict=verdict)
