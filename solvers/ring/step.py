"""Steps of the ring by two plans that run the same phases.

:func:`advance` puts any number of steps into one kernel on one thread. :func:`step_in_slabs` does one step on several.
"""

import taichi as ti

from solvers.estimators import running
from solvers.read_once import read_once
from solvers.ring import margin, phases, remedies
from solvers.ring.layout import GHOSTS
from solvers.ring.material import radial_forces
from solvers.ring.samples import sample
from solvers.ring.state import HOOKS, RingState
from solvers.solver import CRUSHED, ESCAPED, INVERTED, MEASURE, REPORT, SOUND
from solvers.turn import Phases, take_turn

FLATTEST = 1e-3  # det F below which a particle counts as crushed
TASK = 512  # indices that a parallel loop never splits between threads


@ti.func
def check(ring: ti.template(), step):
    """Stop a run that has gone bad: det F <= 0, tiny or NaN, or a particle outside of where the ring can be."""
    flattest, bad = FLATTEST, -1
    for p in range(ring.particles):
        q, X, F = ring.motion[p], ring.material_position[p], ring.deformation_gradient[p]
        J = F[0] * F[3] - F[1] * F[2]
        inside = q[0] > -ring.spacing and q[1] > -ring.spacing
        if not J >= flattest:  # true for NaN too
            flattest, bad = -1e300 if ti.math.isnan(J) else J, p
            ring.verdict[0] = CRUSHED if J > 0 else INVERTED
        elif not (inside and q[0] * q[0] + q[1] * q[1] < ring.farthest * ring.farthest and
                  (q[0] - X[0]) ** 2 + (q[1] - X[1]) ** 2 < ring.farthest_move ** 2) and bad < 0:
            bad = p
            ring.verdict[0] = ESCAPED
    if bad >= 0:
        ring.verdict[1], ring.verdict[2] = step, bad


@ti.func
def one_step(ring: ti.template(), step, on: ti.template()):
    """Step number ``step``, counted from one, on one thread: that many have been taken after it."""
    phases.update_grid(ring, (step - 1) * ring.dt, on)
    running.in_step(ring, step, HOOKS, on)
    remedies.in_step(ring, step, on)
    phases.nodes_to_particles(ring, 0, step, on)
    running.after_step(ring, step, HOOKS, on)


PHASES = Phases(one_step, check, sample, HOOKS)


@ti.kernel
def advance(start: ti.i32, turns: ti.i32, purpose: ti.i32, ring: RingState, on: ti.template()):
    """On one thread, from step ``start`` on, ``turns`` turns for ``purpose``: see :func:`solvers.turn.take_turn`."""
    ti.loop_config(serialize=True)
    for turn in range(turns):
        take_turn(read_once(ring), turn, start, purpose, PHASES, on)


@ti.kernel
def step_in_slabs(step: ti.i32, slabs: ti.i32, ring: RingState, on: ti.template()):
    """One step on as many threads as there are slabs; ``slabs`` = 0 only compiles."""
    for _ in range(ti.min(slabs, 1)):
        radial_forces(ring, step * ring.dt, on)
    for task in range(TASK * slabs):
        if task % TASK == 0:
            phases.particles_to_nodes(ring, task // TASK, on)
    for task in range(TASK * slabs):
        if task % TASK == 0:
            first, last = phases.slab_range(ring.active, task // TASK, ring.slabs)
            for j in range(first, last):
                phases.sum_slabs(ring, j)
    for _ in range(ti.min(slabs, 1)):
        phases.fold(ring, phases.fold_sums)
    for task in range(TASK * slabs):
        if task % TASK == 0:
            first, last = phases.slab_range(ring.active - GHOSTS, task // TASK, ring.slabs)
            for j in range(first, last):
                phases.update_nodes(ring, GHOSTS + j, on)
    for _ in range(ti.min(slabs, 1)):
        phases.mirror_motion(ring)
        running.in_step(ring, step + 1, HOOKS, on)
        remedies.in_step(ring, step + 1, on)
    for task in range(TASK * slabs):
        if task % TASK == 0:
            phases.nodes_to_particles(ring, task // TASK, step + 1, on)
    for _ in range(ti.min(slabs, 1)):
        running.after_step(ring, step + 1, HOOKS, on)


@ti.kernel
def inspect(step: ti.i32, line: ti.i32, purpose: ti.i32, ring: RingState, on: ti.template()):
    """Beside :func:`step_in_slabs`: check the state unless it is to ``REPORT``, and sample it into ``line`` unless that
    is negative, with a look for contradictions where one is due or it is to ``MEASURE``."""
    ti.loop_config(serialize=True)
    for _ in range(1):
        if purpose != REPORT and ring.verdict[0] == SOUND:
            check(ring, step)
        if line >= 0:
            running.report(ring, step, HOOKS, on)
        if line >= 0 and purpose != REPORT:
            sample(ring, line, step, purpose == MEASURE or step % ring.look_interval == 0, on)


@ti.kernel
def freeze(ring: RingState, on: ti.template()):
    """Find the weights of a ring that keeps them."""
    ti.loop_config(serialize=True)
    for _ in range(1):
        phases.find_weights(ring, 0, ring.particles, on)


@ti.kernel
def find_margin(ring: RingState, on: ti.template()):
    """Find the margin of the step, for whoever asks: a kernel of its own, for its code is long and called seldom."""
    ti.loop_config(serialize=True)
    for _ in range(1):
        margin.step_margin(ring, on)
