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

Assumptions: b(X, t) and v(X, 0) are known, the material is elastic, the particles began on a uniform lattice.
It fails where the solution varies within the four cells of the fit (six with one particle per cell, or with particles
moved with their own velocity): what the fit cannot follow counts as error. The verdict tells from the size of U's
fourth differences.
Source: derived for this program.
"""

import numpy as np
import taichi as ti

from solvers.bar import exact
from solvers.bar.forces import tones
from solvers.bar.nodes import stencil_of
from solvers.estimators import recovery
from solvers.estimators.interface import EstimatorHooks
from solvers.estimators.lattice_lines import Line, Rows
from solvers.estimators.recovery import BEGUN, MOVED, NEW, ROUGH, SIZE, TAU, TURNS, H, row_of
from solvers.kinds import integers, pairs, quads, reals

WAVE_CFL = 0.9  # H c/h; stable to 1.2
DEGREE = 3  # of the fits
MOST_ROUGH = 3.2  # with fits of four cells: x then comes out some 8 % too small, on bars of 16 to 20 cells
PATTERN_CELLS = 12  # on which the operators are found; all cells are alike

FIT, SPREAD, GATHER, SMOOTHING = range(4)  # tables: weights (value, slope)
#: Blocks of the nodal array: U, w in the middle of the next H, a and a before; errors as gathered; errors unsmoothed;
#: M sin 2 pi X and M sin 4 pi X.
MOTION, GATHERED, ERRORS, FORCE = range(4)


@ti.func
def block(bar: ti.template(), kind: ti.template(), i):
    """Entry i of a block of the nodal array."""
    return kind * bar.cells + i


@ti.func
def from_particles(bar: ti.template(), table: ti.template(), row):
    """A row of ``GATHER``, M of the fields kept at particles, at a node, and D of them; or of ``FIT``, the fields
    recovered at a particle, and their slopes."""
    value, slope = ti.Vector([0.0, 0.0, 0.0, 0.0]), ti.Vector([0.0, 0.0, 0.0, 0.0])
    p, begin, end = row_of(bar.recovered_index, table, row, 0)
    for k in range(begin, end):
        value += bar.recovered_weights[k][0] * bar.recovered_field[p]
        slope += bar.recovered_weights[k][1] * bar.recovered_field[p]
        p = ti.select(p + 1 < bar.particles, p + 1, 0)
    return value, slope


@ti.func
def smooth(bar: ti.template(), i):
    """C of the gathered nodal values at node i."""
    total = ti.Vector([0.0, 0.0, 0.0, 0.0])
    j, begin, end = row_of(bar.recovered_index, SMOOTHING, i, 0)
    for k in range(begin, end):
        total += bar.recovered_weights[k][0] * bar.recovered_nodes[block(bar, GATHERED, j)]
        j = ti.select(j + 1 < bar.cells, j + 1, 0)
    return total


@ti.func
def spread(bar: ti.template(), p, q):
    """The nodal errors interpolated to particle p, the q-th of its cell, and their slopes."""
    value, slope = ti.Vector([0.0, 0.0, 0.0, 0.0]), ti.Vector([0.0, 0.0, 0.0, 0.0])
    i, begin, _ = row_of(bar.recovered_index, SPREAD, p, q)
    for k in ti.static(range(3)):
        weight, error = bar.recovered_weights[begin + k], bar.recovered_nodes[block(bar, ERRORS, i)]
        value += weight[0] * error
        slope += weight[1] * error
        i = ti.select(i + 1 < bar.cells, i + 1, 0)
    return value, slope


@ti.func
def fit_slope(bar: ti.template(), p):
    """The slope alone, of the displacement alone."""
    slope = 0.0
    other, begin, end = row_of(bar.recovered_index, FIT, p, 0)
    for k in range(begin, end):
        slope += bar.recovered_weights[k][1] * bar.recovered_field[other][0]
        other = ti.select(other + 1 < bar.particles, other + 1, 0)
    return slope


@ti.func
def begin(bar: ti.template(), t, on: ti.template()):
    """Unless it is done: start the reference with the acceleration at time t, when the bar was undeformed, a = M b."""
    if bar.recovered_numbers[TURNS] == NEW:
        size = tones(bar, t, on)
        for i in range(bar.cells):
            shape, at = bar.recovered_nodes[block(bar, FORCE, i)], block(bar, MOTION, i)
            a = size[0] * shape[0] + size[1] * shape[1]
            bar.recovered_nodes[at] = recovery.with_start(bar.recovered_nodes[at], a, bar.recovered_numbers[H])
        bar.recovered_numbers[TURNS] = BEGUN


@ti.func
def remember_sizes(bar: ti.template()):
    """Add this turn's fourth differences of U, and e, to the sums that the verdict looks at."""
    rough, size = 0.0, 0.0
    for i in range(bar.cells):
        fourth = 0.0
        for k in ti.static(range(5)):
            j = (i + bar.cells + k - 2) % bar.cells
            fourth += ti.static(recovery.FOURTH[k]) * bar.recovered_nodes[block(bar, MOTION, j)][0]
        rough += fourth * fourth
        size += bar.recovered_nodes[block(bar, GATHERED, i)][0] ** 2
    bar.recovered_numbers[ROUGH] += rough / bar.cells
    bar.recovered_numbers[SIZE] += size / bar.cells


@ti.func
def after_step(bar: ti.template(), base, step, on: ti.template()):
    """U += H w; the error's gradient corrects the recovered one; w += H (a + correction), a = M b - D P/rho."""
    begin(bar, step * bar.dt - bar.recovered_numbers[H], on)
    for p in range(bar.particles):
        bar.recovered_field[p] = ti.Vector([bar.position[p] - bar.material_position[p], bar.velocity[p], 0.0, 0.0])
    for i in range(bar.cells):
        motion = bar.recovered_nodes[block(bar, MOTION, i)]
        motion[0] += bar.recovered_numbers[H] * motion[1]
        bar.recovered_nodes[block(bar, MOTION, i)] = motion
        mean, _ = from_particles(bar, GATHER, i)
        bar.recovered_nodes[block(bar, GATHERED, i)] = ti.Vector([mean[0] - motion[0], mean[1] - motion[1], 0.0, 0.0])
    remember_sizes(bar)
    for i in range(bar.cells):
        e = bar.recovered_nodes[block(bar, GATHERED, i)]
        bar.recovered_nodes[block(bar, ERRORS, i)] = e - smooth(bar, i) + ti.Vector([e[0], 0.0, 0.0, 0.0])
    for i in range(bar.cells):
        bar.recovered_nodes[block(bar, GATHERED, i)] = bar.recovered_nodes[block(bar, ERRORS, i)]
    for i in range(bar.cells):
        e = bar.recovered_nodes[block(bar, ERRORS, i)]
        e[0] += bar.recovered_numbers[TAU] * (e[1] - smooth(bar, i)[1])
        bar.recovered_nodes[block(bar, ERRORS, i)] = e
    per_cell = bar.particles // bar.cells
    for i in range(bar.cells):
        for q in range(per_cell):
            p = i * per_cell + q
            _, error_slope = spread(bar, p, q)
            field = bar.recovered_field[p]
            field[3] = bar.modulus * (fit_slope(bar, p) - error_slope[0])
            bar.recovered_field[p] = field
    size = tones(bar, step * bar.dt, on)
    first = bar.recovered_numbers[TURNS] == BEGUN
    bar.recovered_numbers[TURNS] = MOVED
    for i in range(bar.cells):
        shape, at = bar.recovered_nodes[block(bar, FORCE, i)], block(bar, MOTION, i)
        _, divergence = from_particles(bar, GATHER, i)
        a = size[0] * shape[0] + size[1] * shape[1] - divergence[3] / bar.density
        bar.recovered_nodes[at] = recovery.next_reference(bar.recovered_nodes[at], a, bar.recovered_numbers[H], first)


@ti.func
def report(bar: ti.template(), base, step, on: ti.template()):
    """Estimated errors of x, v, sigma at the state's time and of a at the last step's, on the particles."""
    for p in range(bar.particles):
        S, _ = stencil_of(bar, p)
        i = bar.first_node[p]
        v_g = S[0] * bar.node_motion[i][0] + S[1] * bar.node_motion[i + 1][0] + S[2] * bar.node_motion[i + 2][0]
        a = 0.0
        if ti.static(on.acceleration):
            a = bar.acceleration[p]
        bar.recovered_field[p] = ti.Vector([bar.position[p] - bar.material_position[p], v_g, a, 0.0])
    length = bar.recovered_numbers[H]
    since = recovery.time_since(step, bar.dt, length)
    if step > 0:
        begin(bar, step * bar.dt - since, on)
    for i in range(bar.cells):
        U, V, A = recovery.reference_at(bar.recovered_nodes[block(bar, MOTION, i)], length, since, bar.dt)
        mean, _ = from_particles(bar, GATHER, i)
        bar.recovered_nodes[block(bar, GATHERED, i)] = mean - ti.Vector([U, V, A, 0.0])
    for i in range(bar.cells):
        bar.recovered_nodes[block(bar, ERRORS, i)] = 2 * bar.recovered_nodes[block(bar, GATHERED, i)] - smooth(bar, i)
    for p in range(bar.particles):
        field = bar.recovered_field[p]
        fitted, slope = from_particles(bar, FIT, p)
        error, error_slope = spread(bar, p, p % (bar.particles // bar.cells))
        E = error + field - fitted
        E[1] += bar.velocity[p] - field[1]
        if ti.static(not on.acceleration):
            E[2] = ti.math.nan
        E_sigma = bar.modulus * (bar.deformation_gradient[p] - 1 - slope[0] + error_slope[0])
        estimate = ti.Vector([E[0], E[1], E_sigma, E[2]])
        bar.estimate[base + p] = estimate if step > 0 else ti.Vector([0.0, 0.0, 0.0, 0.0])


def interval(scene):
    return recovery.steps_between(scene, WAVE_CFL * scene.spacing)


def allocate(scene):
    """Operators of the material line, and the reference in the initial configuration."""
    cells, per_cell = scene.cells, scene.ppc
    few = min(cells, PATTERN_CELLS)
    line = Line(few * per_cell, few, few * scene.spacing, "periodic")
    tables = [line.fit(recovery.fit_width(scene), DEGREE).repeated(cells * per_cell, 1, 1),
              line.spread().repeated(cells, per_cell, 1), line.gather(4, 2).repeated(cells, 1, per_cell),
              line.smoothing().repeated(cells, 1, 1)]
    tables = [Rows(rows.first, rows.weights[:, :, 0, :2]) for rows in tables]  # one component; value and slope
    index, weights = recovery.pack_tables(tables)
    X = (np.arange(scene.particles) + 0.5) * (scene.spacing / per_cell)
    nodes = np.zeros((4, cells, 4))
    for k in (0, 1):
        nodes[FORCE, :, k] = tables[GATHER](np.sin(2 * (k + 1) * np.pi * X))[:, 0]
    nodes[MOTION, :, 1] = tables[GATHER](exact.velocity(scene, X, 0.0))[:, 0]
    return {"recovered_numbers": recovery.numbers(scene, interval(scene)), "recovered_index": index,
            "recovered_weights": weights, "recovered_nodes": nodes.reshape(-1, 4),
            "recovered_field": np.zeros((scene.particles, 4))}


def verdict(scene, memory):
    """Why not to trust it; what a fit misses grows like the fourth power of the cells that it goes over."""
    U = memory["recovered_nodes"].reshape(-1, scene.cells, 4)[MOTION, :, 0]
    return recovery.doubt(memory, MOST_ROUGH * (recovery.OTHER_FIT_CELLS / recovery.fit_cells(scene)) ** 4,
                          np.abs(U).max() / scene.motion_amplitude)


HOOKS = EstimatorHooks(
    memory={
        "recovered_numbers": reals,  # by the names of solvers.estimators.recovery
        "recovered_index": integers, "recovered_weights": pairs,  # the tables, packed
        "recovered_nodes": quads,  # nodal values, block by block
        "recovered_field": quads,  # u, v, a, P at particles
    },
    allocate=allocate, interval=interval, after_step=after_step, report=report, verdict=verdict)
