"""Shared parts of the recovered estimators: steps of the reference, width of the fits, and checks of validity."""

import numpy as np
import taichi as ti

from solvers.kernels.dtypes import integers, quads
from solvers.kernels.packing import prefix_view
from solvers.translatable_message import Message

DAMPING = 0.4  # tau c/h of waves as short as the error grid; 0.8 is unstable on the ring
#: Indices in the estimators' numbers: the reference's time step, the damping time, the reference's stage, and sums over
#: all checked turns, in m^2: squares of the reference's fourth differences and of the error; on the bar products of
#: both; in the plane squares of what smoothing removes from the error, and of what smoothing removes from that.
H, TAU, TURNS, ROUGH, SIZE, ALONG, SHORT, SHORTEST = range(8)
NEW, BEGUN, MOVED = 0, 1, 2  # the reference as allocated, with its acceleration at the start, past its first step
FIT_CELLS = {"particle": 6}  # cells per fit; particles moved with their own velocity are less evenly spaced
OTHER_FIT_CELLS = 4
NARROWEST_FIT = 7  # particles: with five a cubic follows each of them
TABLE = {"first": integers, "width": ti.i32, "weights": quads}  # members of a table of rows, with their types
MOST_GROWTH = 2.0  # amplitudes of the motion
#: Fourth differences of a reference that oscillates from node to node are 16 times its amplitude. Measured on 80 rings
#: and bars with uneven particles, where it does: index of x and v from .9 to 1.1 up to .8 of the error found.
SWING_FACTOR = 16.0
MOST_SWING = 1.0  # of the error found
MOST_STEPS = 50  # of the run between two of the estimator's
TURNS_PER_CHECK = 4  # of the estimator, per turn at which the sums for the verdict grow
#: Sums over rows that are computed side by side, with the same weights, so that additions overlap in the processor.
#: No error grid has fewer nodes across, and numbers of cells, particles and radii are larger.
ROWS_PER_GROUP = 3


@ti.func
def group_count(count):
    """Number of groups of ``ROWS_PER_GROUP`` for ``count`` items; the last two overlap."""
    return (count + (ROWS_PER_GROUP - 1)) // ROWS_PER_GROUP


@ti.func
def first_in_group(group, count):
    """Index of the first item of a group."""
    return ti.min(group * ROWS_PER_GROUP, count - ROWS_PER_GROUP)


@ti.func
def store_sums(field: ti.template(), place, apart, values: ti.template()):
    """Stores the sums of a group, with ``apart`` entries between neighbours."""
    for k in ti.static(range(ROWS_PER_GROUP)):
        field[place + k * apart] = values[k]


@ti.func
def fourth_difference_weight(k):
    """Weight of value ``k`` of five in their fourth difference: 1, -4, 6, -4, 1."""
    return ti.select(k == 2, 6.0, ti.select(k % 2 == 1, -4.0, 1.0))


@ti.func
def initial_reference_solution(reference, a, interval):
    """Returns an allocated reference, with mean rate w = v, that starts with the acceleration ``a``: w = v + H/2 a."""
    return ti.Vector([reference[0], reference[1] + 0.5 * interval * a, a, a])


@ti.func
def next_reference_solution(reference, a, interval, first):
    """Returns U, w, a and the previous a (components side by side in each quarter), given the acceleration ``a``.

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
def acceleration_two_steps_before(reference, a, first):
    """Returns the acceleration two steps before ``a`` of a reference that has not advanced yet, or its
    extrapolation."""
    before = reference[3]
    if first:
        before = 2 * reference[2] - a
    return before


@ti.func
def reference_solution_at(reference, before, interval, since, dt):
    """Returns U and its rate ``since`` s after its last step, and its acceleration dt earlier, by Taylor series.

    ``before`` is the acceleration two steps before. Without it, on a free bar in its first half period, what was left
    out of the acceleration was up to three times its error.
    """
    snap = (reference[2] - 2 * reference[3] + before) / (interval * interval)
    jerk = (reference[2] - reference[3]) / interval + interval / 2 * snap
    v = reference[1] - interval * (reference[2] / 2 + interval * (jerk / 6 + interval / 24 * snap))
    U = reference[0] + since * (v + since / 2 * (reference[2] + since / 3 * (jerk + since / 4 * snap)))
    late = since - dt
    return (U, v + since * (reference[2] + since / 2 * (jerk + since / 3 * snap)),
            reference[2] + late * (jerk + late / 2 * snap))


def wave_travel_steps(scene, length):
    """Returns the number of steps in which a wave travels ``length``, in m."""
    return max(1, min(MOST_STEPS, int(length / (scene.wave_speed * scene.time_step))))


def initial_numbers(scene, steps):
    """Returns the estimators' numbers at the start."""
    return np.array([steps * scene.time_step, DAMPING * scene.spacing / scene.wave_speed, NEW, *[0.0] * 5])


def fit_width(scene):
    """Returns the number of particles of a fit along a line: four cells, longer than the method's own kinks."""
    return max(NARROWEST_FIT, FIT_CELLS.get(scene.velocity, OTHER_FIT_CELLS) * scene.ppc + 1)


@ti.func
def time_since_reference_step(step, dt, interval):
    """Returns the time in s since the reference's last step, after ``step`` steps of the run."""
    steps = ti.cast(interval / dt + 0.5, ti.i32)
    return step % steps * dt


@ti.func
def is_check_due(step, dt, interval):
    """Returns whether the sums for the verdict grow after ``step`` steps; the first turn is one of these."""
    steps = ti.cast(interval / dt + 0.5, ti.i32)
    return step // steps % TURNS_PER_CHECK == 1


@ti.func
def table_row_range(state: ti.template(), table: ti.template(), row, pattern):
    """Returns the first entry of row ``row`` of a table, and the first and the end index of its weights.

    ``table`` is what the names of its members begin with; ``pattern`` is the row itself, or the one that it repeats.
    """
    width = prefix_view(state, table).width
    return prefix_view(state, table).first[row], pattern * width, (pattern + 1) * width


def table_types(names):
    """Returns the members that hold these tables, with their types."""
    return {name + member: kind for name in names for member, kind in TABLE.items()}


def table_values(tables):
    """Returns the members' values from :class:`~solvers.estimators.lattice_line_operators.Rows` by the names of the
    tables.

    Weights (rows, width, n) become vectors of n.
    """
    return {name + member: value for name, rows in tables.items() for member, value in (
        ("first", rows.first.astype(np.int32)), ("width", rows.width),
        ("weights", rows.weights.reshape(-1, rows.weights.shape[-1])))}


def why_not_trusted(memory, growth):
    """Returns why not to trust what was reported: the reference is inverted, diverged, or oscillates from node to node.

    It oscillates where it follows uneven particles and where it is unstable: then the estimate is the reference's own
    error. The measure is the size of the fourth differences of U, with a node spacing of one, over that of the error,
    in sums over the whole run. ``growth`` is the largest U now over the motion's amplitude, at most one.
    """
    numbers = memory["recovered_numbers"]
    if not (np.isfinite(memory["recovered_nodes"]).all() and np.isfinite(numbers).all()):
        return Message("not valid here: the recovered deformation turned inside out; take shorter steps or a smaller "
                       "amplitude")
    if not growth < MOST_GROWTH:
        return Message("not valid here: recovered's own reference has grown to {growth:.2g} amplitudes, because its "
                       "equation of motion is unstable here; take more particles per cell or a smaller amplitude",
                       growth)
    if numbers[ROUGH] > (SWING_FACTOR * MOST_SWING) ** 2 * numbers[SIZE]:
        return Message("not valid here: recovered's own reference is too rough (it swings from node to node by "
                       "{by:.2g} times the error found, and may by {most:.2g}); take two or more particles per cell "
                       "that move with the grid", np.sqrt(numbers[ROUGH] / numbers[SIZE]) / SWING_FACTOR, MOST_SWING)
    return None
