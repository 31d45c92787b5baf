"""What the recovered estimators of the bar and of the ring share: how the reference advances and how wide they fit."""

import numpy as np
import taichi as ti

DAMPING = 0.4  # tau c/h of waves as short as the error grid; 0.8 is unstable on the ring
H, TAU = 0, 1  # entries of the estimators' numbers: the reference's time step, the damping's time
WIDEST_FIT = 17  # particles
MOST_STEPS = 50  # of the run between two of the estimator's


@ti.func
def next_reference(reference, a, interval, first):
    """U, w, a, a before (components side by side in each quarter) after the acceleration ``a`` has been found.

    w is the mean rate over the time H (``interval``) to come: w += H (a + (a - 2 a_1 + a_2)/12) with the two before
    (Stoermer, with Numerov's correction one step late, which also damps what H hardly resolves). The first step
    instead completes the Taylor series of U from the start.
    """
    change = a - reference[2]
    correction = (change - reference[2] + reference[3]) / 12
    if first:
        reference[0] += interval * interval / 6 * change
        reference[1] += interval / 6 * change
        correction = 0.0
    return ti.Vector([reference[0], reference[1] + interval * (a + correction), a, reference[2]])


@ti.func
def reference_at(reference, interval, since, dt):
    """U and its rate the time ``since`` after its last step, and its acceleration a dt earlier, by Taylor series."""
    jerk = (reference[2] - reference[3]) / interval
    v = reference[1] - interval / 2 * reference[2] - interval * interval / 6 * jerk
    U = reference[0] + since * (v + since / 2 * (reference[2] + since / 3 * jerk))
    return U, v + since * (reference[2] + since / 2 * jerk), reference[2] + (since - dt) * jerk


def steps_between(scene, length):
    """Steps in the time that a wave takes along ``length``."""
    return max(1, min(MOST_STEPS, int(length / (scene.wave_speed * scene.time_step))))


def numbers(scene, steps):
    """H and tau in seconds."""
    return np.array([steps * scene.time_step, DAMPING * scene.spacing / scene.wave_speed])


def fit_width(scene):
    """Particles along a line that a fit goes over: four cells, which the method's own kinks are shorter than."""
    return min(4 * scene.ppc + 1, WIDEST_FIT)


@ti.func
def time_since(step, dt, interval):
    """The time since the reference's last step, after ``step`` steps of the run."""
    steps = ti.cast(interval / dt + 0.5, ti.i32)
    return step % steps * dt


@ti.func
def row_of(index: ti.template(), table: ti.template(), row, pattern):
    """Where row ``row`` of a packed table begins: its first entry, and the first and the end of its weights.

    ``pattern`` is the row itself, or the one that it repeats.
    """
    width = index[3 * table + 2]
    begin = index[3 * table + 1] + pattern * width
    return index[index[3 * table] + row], begin, begin + width


def pack_tables(tables, counts=()):
    """Several :class:`~solvers.estimators.lattice_lines.Rows` in two arrays, for :func:`row_of`; a kernel can take only
    so many arguments.

    The integers begin with three numbers a table: where its firsts begin, where its weights begin, and the width; then
    come ``counts``.
    Weights (rows, width, n) become vectors of n.
    """
    header, firsts, weights = [], [], []
    for rows in tables:
        header += [3 * len(tables) + len(counts) + sum(map(len, firsts)), sum(map(len, weights)), rows.width]
        firsts.append(rows.first)
        weights.append(rows.weights.reshape(-1, rows.weights.shape[-1]))
    return np.concatenate([np.array([*header, *counts]), *firsts]).astype(np.int32), np.concatenate(weights)


def not_finite(scene, memory):
    """The reference broke down: a waves' step too long for a very compressed state, or a run gone bad."""
    if np.isfinite(memory["recovered_nodes"]).all():
        return None
    return "not valid here: the recovered deformation turned inside out; take shorter steps or a smaller amplitude"
