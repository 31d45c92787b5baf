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
    """Number of groups of ``ROWS_PER_GROUP`` that contain ``count`` items; the last two may overlap."""
    return (count + (ROWS_PER_GROUP - 1)) // ROWS_PER_GROUP


@ti.func
def first_in_group(group, count):
    """Index of the first of ``count`` items in the group of this number."""
    return ti.min(group * ROWS_PER_GROUP, count - ROWS_PER_GROUP)


@ti.func
def store_sums(field: ti.template(), place, apart, values: ti.template()):
    """Writes the sums ``values`` of a group to ``field``, from entry ``place`` on, one every ``apart`` entries."""
    for k in ti.static(range(ROWS_PER_GROUP)):
        field[place + k * apart] = values[k]


@ti.func
def fourth_difference_weight(k):
    """Weight of value ``k`` (0 to 4) in the fourth difference of five: 1, -4, 6, -4, 1."""
    return ti.select(k == 2, 6.0, ti.select(k % 2 == 1, -4.0, 1.0))


@ti.func
def initial_reference_solution(reference, a, interval):
    """Returns a node's U, w, a, a at the start from ``reference`` = (U, v, ...), the acceleration ``a`` in m/s^2 and
    the reference's step H (``interval``) in s: w = v + H/2 a is the mean rate in the step to come."""
    return ti.Vector([reference[0], reference[1] + 0.5 * interval * a, a, a])


@ti.func
def next_reference_solution(reference, a, interval, first):
    """Returns a node's new U, w, a and previous a from ``reference``, the last ones, and the new acceleration ``a``.

    w is the mean rate over the time H (``interval``, s) to come: w += H (a + (a - 2 a_1 + a_2)/12) with the two before
    (Stoermer, with Numerov's correction one step late, which also damps what H hardly resolves). The ``first`` step
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
    """Returns a node's acceleration two steps before the new ``a`` in m/s^2, from its ``reference`` = (U, w, a,
    previous a) of the last step; before the ``first`` step, its extrapolation."""
    before = reference[3]
    if first:
        before = 2 * reference[2] - a
    return before


@ti.func
def reference_solution_at(reference, before, interval, since, dt):
    """Returns a node's U (m) and its rate (m/s) ``since`` s after the last step of its ``reference`` = (U, w, a,
    previous a), and its acceleration ``dt`` s earlier, by Taylor series; steps take ``interval`` s. ``before`` is the
    acceleration two steps before. Without it, on a free bar in its first half period, what was left out of the
    acceleration was up to three times its error."""
    snap = (reference[2] - 2 * reference[3] + before) / (interval * interval)
    jerk = (reference[2] - reference[3]) / interval + interval / 2 * snap
    v = reference[1] - interval * (reference[2] / 2 + interval * (jerk / 6 + interval / 24 * snap))
    U = reference[0] + since * (v + since / 2 * (reference[2] + since / 3 * (jerk + since / 4 * snap)))
    late = since - dt
    return (U, v + since * (reference[2] + since / 2 * (jerk + since / 3 * snap)),
            reference[2] + late * (jerk + late / 2 * snap))


def wave_travel_steps(scene, length):
    """Returns the number of steps of the run in which a wave travels ``length`` m, from 1 to ``MOST_STEPS``."""
    return max(1, min(MOST_STEPS, int(length / (scene.wave_speed * scene.time_step))))


def initial_numbers(scene, steps):
    """Returns initial numbers (8,), by ``H`` to ``SHORTEST``; the reference's step is ``steps`` of the run's."""
    return np.array([steps * scene.time_step, DAMPING * scene.spacing / scene.wave_speed, NEW, *[0.0] * 5])


def fit_width(scene):
    """Returns the number of particles of a fit along a line: four cells, longer than the method's own kinks, or six."""
    return max(NARROWEST_FIT, FIT_CELLS.get(scene.velocity, OTHER_FIT_CELLS) * scene.ppc + 1)


@ti.func
def time_since_reference_step(step, dt, interval):
    """Returns seconds since the reference's last step (each ``interval`` s), after ``step`` steps of ``dt`` s."""
    steps = ti.cast(interval / dt + 0.5, ti.i32)
    return step % steps * dt


@ti.func
def is_check_due(step, dt, interval):
    """Returns whether the sums for the verdict grow after ``step`` steps of ``dt`` s of the run: in every
    ``TURNS_PER_CHECK``-th step of the reference, which takes ``interval`` s, from the first on."""
    steps = ti.cast(interval / dt + 0.5, ti.i32)
    return step // steps % TURNS_PER_CHECK == 1


@ti.func
def table_row_range(state: ti.template(), table: ti.template(), row, pattern):
    """Returns the input entry at which row ``row`` of a table begins, and the first and the end index of its weights.
    ``table`` is what the state's members for it begin with; ``pattern`` is the row itself, or the one that it repeats.
    """
    width = prefix_view(state, table).width
    return prefix_view(state, table).first[row], pattern * width, (pattern + 1) * width


def table_types(names):
    """Returns the Taichi types of the state's members, by name, that hold the tables of these names."""
    return {name + member: kind for name in names for member, kind in TABLE.items()}


def table_values(tables):
    """Returns the values of :func:`table_types` by name, from a ``lattice_line_operators.Rows`` for the name of each
    table; weights (rows, width, n) become vectors of n."""
    return {name + member: value for name, rows in tables.items() for member, value in (
        ("first", rows.first.astype(np.int32)), ("width", rows.width),
        ("weights", rows.weights.reshape(-1, rows.weights.shape[-1])))}


def why_not_trusted(memory, growth):
    """Returns why not to trust recovered's estimate, as a sentence, or None: its reference is inverted, diverged, or
    oscillates from node to node. ``memory`` are its arrays by name, ``growth`` the largest U now over the motion's.

    A reference oscillates where it follows uneven particles or is unstable: then the estimate is its own error. The
    measure is the size of U's fourth differences, at node spacing one, over that of the error, summed over the run."""
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
