"""The recovered estimator on the bar: the run's own particles, made smooth, against the equation of motion.

In weak form on the material line, with N the quadratic B-splines of an *error grid* of spacing h and m = int rho N, the
exact displacement obeys

    (M u)'' = M b - D P / rho,    M f = int N f / int N,    D P = int N' P / int N,

whatever the grid. The estimator integrates this for U = M u_exact from the initial state on, and the error is

    e = M u - U,    E = sum_i N_i (2 e - C e)_i + (u - fit u),    C = M sum_j N_j,

u = x_p - X_p of the run; ``fit`` is a moving least-squares cubic over four cells and 2 - C undoes what M and N smooth.
The stress that drives U is not the run's, which is only piecewise smooth, but

    P = E (F - 1),    F = 1 + fit' u - sum_i N_i' e*_i,    e* = 2 e - C e + tau (1 - C)^2 e':

the recovered gradient less that of the error itself, so that the error feeds back on itself as it does in the run. The
last term, with tau = 0.4 h/c, damps waves as short as the grid; a second factor 1 - C spares the longer ones, which
have to ring for as long as the run's own error does. The errors of v and a are formed likewise, from v_g, the
grid's velocity at the particle (v_p - v_g is added as it is), and from the last step's a. The error of the stress is
E (F_p - 1 - fit' u + sum_i N_i' (2 e - C e)_i).

In time: steps H of about 0.8 h/c by Stoermer's method with Numerov's correction H^2/12 U'''' from past accelerations,
so that the error in time, of order H^4, stays far below the run's.

Assumptions: b(X, t) and v(X, 0) are known, the material is elastic, the particles began on a uniform lattice. It fails
where the solution varies within the four cells of the fit (six with one particle per cell, or with particles moved with
their own velocity): what the fit cannot follow counts as error. The verdict tells from the size of U's fourth
differences. Source: derived for this program.
"""

from dataclasses import replace

import numpy as np
import taichi as ti

from solvers.estimators import recovered_common
from solvers.estimators.recovered_common import ALONG, BEGUN, MOVED, NEW, ROUGH, SIZE, TAU, TURNS, H
from solvers.kernels.dtypes import integers, quads, reals
from solvers.kernels.packing import prefix_view
from solvers.motion.exact_solution_1d import force_table
from solvers.problems.bar import exact_solution
from solvers.problems.bar.estimators import recovered_tables
from solvers.problems.bar.estimators.recovered_tables import DRIVE, FIT, INTERPOLATION, PROJECTION, SMOOTHING, STIFFNESS
from solvers.problems.bar.method.body_force import tabulated_force_amplitude
from solvers.problems.bar.method.periodic_nodes import stencil_of
from solvers.scene.estimator_hooks import EstimatorHooks
from solvers.scene.typed_motion_scene import TYPED
from solvers.solver.separable_field_tables import pack_tables, pad_to_mode_pairs, paired_field_at

WAVE_CFL = 0.9  # H c/h; stable to ``estimator_limits.MOST_WAVE_CFL``
#: Blocks of the nodal array: U, w in the middle of the next H, a and a before; errors as gathered; errors unsmoothed;
#: M sin 2 pi X, M sin 4 pi X, D of the fitted slope of u, and a two steps before.
MOTION, PROJECTED, ERRORS, FORCE = range(4)


@ti.func
def nodal_entry_index(bar: ti.template(), kind: ti.template(), i):
    """Returns the index in ``bar.recovered_nodes`` of node i in the block ``kind``, such as ``MOTION``."""
    return kind * bar.recovered_stride + i


@ti.func
def extend_periodically(field: ti.template(), start, count, beyond):
    """Copies the first ``beyond`` of the ``count`` entries of a field from ``start`` on behind the last of them."""
    for k in range(beyond):
        field[start + count + k] = field[start + k]


@ti.func
def extend_nodal_block_periodically(bar: ti.template(), kind: ti.template()):
    """Repeats the beginning of the block ``kind`` of ``bar.recovered_nodes`` behind its end, for tables."""
    extend_periodically(bar.recovered_nodes, nodal_entry_index(bar, kind, 0), bar.cells,
                        bar.recovered_stride - bar.cells)


@ti.func
def row_sums(bar: ti.template(), table: ti.template(), row, field: ti.template(), start):
    """Returns three sums (4,) of a field from ``start`` on, by a table's rows ``row`` and two more of equal weights."""
    one, two, three = ti.Vector([0.0] * 4), ti.Vector([0.0] * 4), ti.Vector([0.0] * 4)
    first = start + prefix_view(bar, table).first[row]
    second, third = start + prefix_view(bar, table).first[row + 1], start + prefix_view(bar, table).first[row + 2]
    for k in range(prefix_view(bar, table).width):
        w = prefix_view(bar, table).weights[k]
        one += w * field[first + k]
        two += w * field[second + k]
        three += w * field[third + k]
    return one, two, three


@ti.func
def apply_table(bar: ti.template(), table: ti.template(), count, field: ti.template(), start, into: ti.template(), at):
    """Applies a table's ``count`` rows to a field from ``start`` on; stores the sums in ``into`` from ``at`` on."""
    for group in range(recovered_common.group_count(count)):
        row = recovered_common.first_in_group(group, count)
        recovered_common.store_sums(into, at + row, 1, row_sums(bar, table, row, field, start))


@ti.func
def particles_to_nodes(bar: ti.template(), table: ti.template(), kind: ti.template()):
    """Applies a table to the fields at particles; stores the sums in the block ``kind`` of nodal values."""
    apply_table(bar, table, bar.cells, bar.recovered_field, 0, bar.recovered_nodes, nodal_entry_index(bar, kind, 0))


@ti.func
def nodes_to_nodes(bar: ti.template(), table: ti.template(), kind: ti.template(), into: ti.template()):
    """Applies a table to the extended block ``kind`` of nodal values; stores the sums in the block ``into``."""
    apply_table(bar, table, bar.cells, bar.recovered_nodes, nodal_entry_index(bar, kind, 0), bar.recovered_nodes,
                nodal_entry_index(bar, into, 0))


@ti.func
def interpolate_nodal_errors(bar: ti.template(), p, pattern):
    """Returns nodal errors of u, v, a at particle p, number ``pattern`` of its cell, and fourth the slope of u's."""
    total = ti.Vector([0.0] * 4)
    first, begin, _ = recovered_common.table_row_range(bar, INTERPOLATION, p, pattern)
    for k in ti.static(range(3)):
        total += prefix_view(bar, INTERPOLATION).weights[begin + k] \
            * bar.recovered_nodes[nodal_entry_index(bar, ERRORS, first + k)]
    return total


@ti.func
def nodal_body_force(bar: ti.template(), i, shape, size, on: ti.template()):
    """Returns M b of node i in m/s^2, from M of its ``shape`` and its amplitude, ``size``."""
    b = size * shape[0]
    if ti.static(on.motion == TYPED):
        b = paired_field_at(bar.recovered_force, bar.recovered_force_sizes, 0, i)[0]
    return b


@ti.func
def start_reference(bar: ti.template(), t, on: ti.template()):
    """Starts the reference, once, with the acceleration M b at time t in s, when the bar was undeformed."""
    if bar.recovered_numbers[TURNS] == NEW:
        size = tabulated_force_amplitude(bar, bar.recovered_force, bar.recovered_force_sizes, t, on)
        for i in range(bar.cells):
            shape, at = bar.recovered_nodes[nodal_entry_index(bar, FORCE, i)], nodal_entry_index(bar, MOTION, i)
            a = nodal_body_force(bar, i, shape, size, on)
            bar.recovered_nodes[at] = recovered_common.initial_reference_solution(bar.recovered_nodes[at], a,
                                                                           bar.recovered_numbers[H])
            bar.recovered_nodes[nodal_entry_index(bar, FORCE, i)] = ti.Vector([shape[0], shape[1], shape[2], a])
        bar.recovered_numbers[TURNS] = BEGUN


@ti.func
def add_verdict_sums(bar: ti.template()):
    """Adds the present fourth differences of U, and errors e, to the verdict's sums in ``bar.recovered_numbers``."""
    rough, size, along = 0.0, 0.0, 0.0
    for i in range(bar.cells):
        fourth = 0.0
        j = ti.select(i < 2, i + bar.cells - 2, i - 2)
        for k in range(5):
            fourth += (recovered_common.fourth_difference_weight(k)
                       * bar.recovered_nodes[nodal_entry_index(bar, MOTION, j)][0])
            j = ti.select(j + 1 < bar.cells, j + 1, 0)
        error = bar.recovered_nodes[nodal_entry_index(bar, PROJECTED, i)][0]
        rough += fourth * fourth
        size += error * error
        along += fourth * error
    bar.recovered_numbers[ROUGH] += rough / bar.cells
    bar.recovered_numbers[SIZE] += size / bar.cells
    bar.recovered_numbers[ALONG] += along / bar.cells


@ti.func
def after_step(bar: ti.template(), base, step, on: ti.template()):
    """Advances the reference by H after ``step`` steps: U += H w; w += H (a + correction), a = M b - D P/rho.

    P is linear in the slopes and D in P, so D is taken of both slopes at once, and P itself is never needed.
    """
    start_reference(bar, step * bar.dt - bar.recovered_numbers[H], on)
    for p in range(bar.particles):
        u = bar.position[p] - bar.material_position[p]
        bar.recovered_field[p] = ti.Vector([u, bar.velocity[p], u, 0.0])
    extend_periodically(bar.recovered_field, 0, bar.particles, bar.recovered_beyond)
    particles_to_nodes(bar, DRIVE, ERRORS)
    for i in range(bar.cells):
        at, drive = nodal_entry_index(bar, MOTION, i), bar.recovered_nodes[nodal_entry_index(bar, ERRORS, i)]
        motion = bar.recovered_nodes[at]
        motion[0] += bar.recovered_numbers[H] * motion[1]
        bar.recovered_nodes[at] = motion
        shape = bar.recovered_nodes[nodal_entry_index(bar, FORCE, i)]
        bar.recovered_nodes[nodal_entry_index(bar, FORCE, i)] = ti.Vector([shape[0], shape[1], drive[2], shape[3]])
        bar.recovered_nodes[nodal_entry_index(bar, PROJECTED, i)] = \
            ti.Vector([drive[0] - motion[0], drive[1] - motion[1], 0.0, 0.0])
    if recovered_common.is_check_due(step, bar.dt, bar.recovered_numbers[H]):
        add_verdict_sums(bar)
    compute_damped_errors(bar)
    advance_reference_motion(bar, step * bar.dt, on)


@ti.func
def compute_damped_errors(bar: ti.template()):
    """Computes e* = 2 e - C e + tau (1 - C)^2 e' from the projected errors, in the block ``ERRORS``."""
    extend_nodal_block_periodically(bar, PROJECTED)
    nodes_to_nodes(bar, SMOOTHING, PROJECTED, ERRORS)
    for i in range(bar.cells):
        e = bar.recovered_nodes[nodal_entry_index(bar, PROJECTED, i)]
        bar.recovered_nodes[nodal_entry_index(bar, PROJECTED, i)] = \
            e - bar.recovered_nodes[nodal_entry_index(bar, ERRORS, i)] + ti.Vector([e[0], 0.0, 0.0, 0.0])
    extend_nodal_block_periodically(bar, PROJECTED)
    nodes_to_nodes(bar, SMOOTHING, PROJECTED, ERRORS)
    for i in range(bar.cells):
        e, at = bar.recovered_nodes[nodal_entry_index(bar, PROJECTED, i)], nodal_entry_index(bar, ERRORS, i)
        smooth = bar.recovered_nodes[at]
        bar.recovered_nodes[at] = ti.Vector([e[0] + bar.recovered_numbers[TAU] * (e[1] - smooth[1]), e[1], 0.0, 0.0])
    extend_nodal_block_periodically(bar, ERRORS)


@ti.func
def advance_reference_motion(bar: ti.template(), t, on: ti.template()):
    """Computes the reference's acceleration at every node at time t in s, and its new rate w."""
    size = tabulated_force_amplitude(bar, bar.recovered_force, bar.recovered_force_sizes, t, on)
    first = bar.recovered_numbers[TURNS] == BEGUN
    bar.recovered_numbers[TURNS] = MOVED
    nodes_to_nodes(bar, STIFFNESS, ERRORS, PROJECTED)
    for i in range(bar.cells):
        shape, at = bar.recovered_nodes[nodal_entry_index(bar, FORCE, i)], nodal_entry_index(bar, MOTION, i)
        slope = shape[2] - bar.recovered_nodes[nodal_entry_index(bar, PROJECTED, i)][0]
        a = nodal_body_force(bar, i, shape, size, on) - bar.modulus / bar.density * slope
        motion = bar.recovered_nodes[at]
        shape[3] = recovered_common.acceleration_two_steps_before(motion, a, first)
        bar.recovered_nodes[nodal_entry_index(bar, FORCE, i)] = shape
        bar.recovered_nodes[at] = recovered_common.next_reference_solution(motion, a, bar.recovered_numbers[H], first)


@ti.func
def report(bar: ti.template(), base, step, on: ti.template()):
    """Stores errors of x, v, sigma after ``step`` steps and the last a in ``bar.estimate`` from ``base`` on, in SI."""
    for p in range(bar.particles):
        S, _ = stencil_of(bar, p)
        i = bar.first_node[p]
        v_g = S[0] * bar.node_motion[i][0] + S[1] * bar.node_motion[i + 1][0] + S[2] * bar.node_motion[i + 2][0]
        a = 0.0
        if ti.static(on.acceleration):
            a = bar.acceleration[p]
        u = bar.position[p] - bar.material_position[p]
        bar.recovered_field[p] = ti.Vector([u, v_g, a, u])
    length = bar.recovered_numbers[H]
    since = recovered_common.time_since_reference_step(step, bar.dt, length)
    if step > 0:
        start_reference(bar, step * bar.dt - since, on)
    extend_periodically(bar.recovered_field, 0, bar.particles, bar.recovered_beyond)
    compute_nodal_errors(bar, length, since)
    apply_table(bar, FIT, bar.particles, bar.recovered_field, 0, bar.estimate, base)
    per_cell = bar.particles // bar.cells
    for i in range(bar.cells):
        for q in range(per_cell):
            p = i * per_cell + q
            field = bar.recovered_field[p]
            less = bar.estimate[base + p] - interpolate_nodal_errors(bar, p, q)  # last: slope of u less its error's
            E = field - less
            E[1] += bar.velocity[p] - field[1]
            if ti.static(not on.acceleration):
                E[2] = ti.math.nan
            E_sigma = bar.modulus * (bar.deformation_gradient[p] - 1 - less[3])
            estimate = ti.Vector([E[0], E[1], E_sigma, E[2]])
            bar.estimate[base + p] = estimate if step > 0 else ti.Vector([0.0, 0.0, 0.0, 0.0])


@ti.func
def compute_nodal_errors(bar: ti.template(), length, since):
    """Computes the fields' nodal errors ``since`` s after the reference's last step, of ``length`` s, unsmoothed."""
    particles_to_nodes(bar, PROJECTION, PROJECTED)
    for i in range(bar.cells):
        before = bar.recovered_nodes[nodal_entry_index(bar, FORCE, i)][3]
        U, V, A = recovered_common.reference_solution_at(bar.recovered_nodes[nodal_entry_index(bar, MOTION, i)], before,
                                                  length, since, bar.dt)
        mean = bar.recovered_nodes[nodal_entry_index(bar, PROJECTED, i)]
        if bar.recovered_numbers[TURNS] == BEGUN:
            A = mean[2]  # without the rate of a, which is unknown there: it was up to 250 times the error
        bar.recovered_nodes[nodal_entry_index(bar, PROJECTED, i)] = mean - ti.Vector([U, V, A, U])
    extend_nodal_block_periodically(bar, PROJECTED)
    nodes_to_nodes(bar, SMOOTHING, PROJECTED, ERRORS)
    for i in range(bar.cells):
        e, at = bar.recovered_nodes[nodal_entry_index(bar, PROJECTED, i)], nodal_entry_index(bar, ERRORS, i)
        bar.recovered_nodes[at] = 2 * e - bar.recovered_nodes[at]
    extend_nodal_block_periodically(bar, ERRORS)


def interval(scene):
    """Returns the number of run steps in one of the estimator's."""
    return recovered_common.wave_travel_steps(scene, WAVE_CFL * scene.spacing)


def allocate(scene):
    """Returns the estimator's arrays at the start by name: operators of the material line, and the reference."""
    cells, per_cell = scene.cells, scene.ppc
    tables = recovered_tables.operators(scene)
    X = (np.arange(scene.particles) + 0.5) * (scene.spacing / per_cell)
    stride = cells + max(tables[name].width for name in (INTERPOLATION, SMOOTHING, STIFFNESS))
    beyond = max(tables[name].width for name in (FIT, PROJECTION, DRIVE))
    nodes = np.zeros((4, stride, 4))
    nodes[FORCE, :cells, 0] = tables[PROJECTION](np.sin(exact_solution.WAVENUMBER * X))[:, 0]
    nodes[MOTION, :cells, 1] = tables[PROJECTION](exact_solution.velocity(scene, X, 0.0))[:, 0]
    table = None
    if scene.motion_formula:
        force = force_table(scene, X)
        modes = np.stack([tables[PROJECTION](one)[:, :2] for one in force.modes[:, :, 0].T], axis=1)
        table = replace(force, modes=modes)
    return {**dict(zip(("recovered_force_sizes", "recovered_force"), pack_tables(pad_to_mode_pairs(table)),
                       strict=True)), "recovered_numbers": recovered_common.initial_numbers(scene, interval(scene)),
            **recovered_common.table_values(tables), "recovered_stride": stride, "recovered_beyond": beyond,
            "recovered_nodes": nodes.reshape(-1, 4), "recovered_field": np.zeros((scene.particles + beyond, 4))}


HOOKS = EstimatorHooks(memory={
    "recovered_numbers": reals,  # by the names of solvers.estimators.recovered_common
    **recovered_common.table_types(recovered_tables.TABLES),
    "recovered_stride": ti.i32, "recovered_beyond": ti.i32,  # nodes of a block; particles repeated behind the last
    "recovered_nodes": quads,  # nodal values, block by block, each closed by a repetition of its beginning
    "recovered_force": quads, "recovered_force_sizes": integers,  # the table of M b of a motion by formula
    "recovered_field": quads,  # u, v, a, P at particles, and likewise
}, allocate=allocate, interval=interval, after_step=after_step, report=report, verdict=recovered_tables.verdict)
