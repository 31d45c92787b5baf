"""What the recovered estimators of the bar and of the ring share: how the reference advances and how wide they fit."""

import numpy as np
import taichi as ti

DAMPING = 0.4  # tau c/h of waves as short as the error grid; 0.8 is unstable on the ring
#: Places in the estimators' numbers: the reference's time step, the damping's time, how far the reference has come, and
#: over all turns the sums of squares of the reference's fourth differences and of the error, in m^2.
H, TAU, TURNS, ROUGH, SIZE = range(5)
FOURTH = (1, -4, 6, -4, 1)  # the fourth difference of five values
NEW, BEGUN, MOVED = 0, 1, 2  # the reference as allocated, with its acceleration at the start, past its first step
FIT_CELLS = {"particle": 6}  # that a fit goes over; particles moved with their own velocity stand less evenly
OTHER_FIT_CELLS = 4
NARROWEST_FIT = 7  # particles: with five a cubic follows each of them
MOST_GROWTH = 2.0  # amplitudes of the motion
MOST_STEPS = 50  # of the run between two of the estimator's


@ti.func
def with_start(reference, a, interval):
    """A reference as allocated, with the mean rate w = v, that begins with the acceleration ``a``: w = v + H/2 a."""
    return ti.Vector([reference[0], reference[1] + 0.5 * interval * a, a, a])


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
    """The estimators' numbers at the start."""
    return np.array([steps * scene.time_step, DAMPING * scene.spacing / scene.wave_speed, NEW, 0.0, 0.0])


def fit_width(scene):
    """Particles along a line that a fit goes over: four cells, which the method's own kinks are shorter than."""
    return max(NARROWEST_FIT, FIT_CELLS.get(scene.velocity, OTHER_FIT_CELLS) * scene.ppc + 1)


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


def fit_cells(scene):
    """Cells that a fit goes over."""
    return (fit_width(scene) - 1) / scene.ppc


def doubt(memory, most_rough, growth):
    """Why not to trust what was reported: the reference is too rough, in sums over the whole run, or has run away.

    The measure is the size of the fourth differences of U, nodes as steps, over that of the error. The exact solution's
    are small where the cells resolve it; where they are not, the fits miss a part of it, and that counts as error. They
    are large, too, where the reference swings from node to node, which is how it follows uneven particles and how it
    goes unstable: then what is estimated is the reference's own error. A run that goes bad leaves them small.
    ``growth`` is the largest U now, over the amplitude of the motion, which it should never exceed.
    """
    numbers = memory["recovered_numbers"]
    if not (np.isfinite(memory["recovered_nodes"]).all() and np.isfinite(numbers).all()):
        return "not valid here: the recovered deformation turned inside out; take shorter steps or a smaller amplitude"
    if not growth < MOST_GROWTH:
        return (f"not valid here: recovered's own reference has grown to {growth:.2g} amplitudes, because its equation "
                "of motion is unstable here; take more particles per cell or a smaller amplitude")
    if numbers[ROUGH] > most_rough**2 * numbers[SIZE]:
        return (f"not valid here: recovered's own reference is too rough (its fourth differences are "
                f"{np.sqrt(numbers[ROUGH] / numbers[SIZE]):.2g} times the error found, and may be {most_rough:.2g}); "
                "take more cells, or two or more particles per cell that move with the grid")
    return None
