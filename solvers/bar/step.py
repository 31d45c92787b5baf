"""Many steps of the bar in one kernel on one thread: at this size launches would cost more than the physics."""

import taichi as ti

from solvers.bar import margin, remedies
from solvers.bar.phases import find_weights, nodes_to_particles, update_grid
from solvers.bar.samples import sample
from solvers.bar.state import HOOKS, BarState
from solvers.estimators import running
from solvers.solver import CRUSHED, ESCAPED, INVERTED, SOUND

FLATTEST = 1e-3  # F below which a particle counts as crushed; the exact bar stays above 1 - 2 pi A
CHECK_EVERY = 8  # steps between two looks for a run that has gone bad


@ti.func
def check(bar: ti.template(), step):
    """Stop a run that has gone bad: F <= 0, tiny or NaN, or a particle far from where it can be.

    Without the middle one a run that collapses, all particles in a few clusters, would go on for ever.
    """
    flattest, bad = FLATTEST, -1
    for p in range(bar.particles):
        F = bar.deformation_gradient[p]
        if not F >= flattest:  # true for NaN too
            flattest, bad = -1e300 if ti.math.isnan(F) else F, p
            bar.verdict[0] = CRUSHED if F > 0 else INVERTED
        elif not abs(bar.position[p] - bar.material_position[p]) < bar.farthest and bad < 0:
            bad = p
            bar.verdict[0] = ESCAPED
    if bad >= 0:
        bar.verdict[1], bar.verdict[2] = step, bad


@ti.kernel
def advance(start: ti.i32, steps: ti.i32, bar: BarState, on: ti.template()):
    """Run ``steps`` steps from step ``start``; sample the norms every ``sample_interval`` steps."""
    ti.loop_config(serialize=True)
    for k in range(steps):
        if bar.verdict[0] == SOUND:
            step = start + k
            update_grid(bar, step * bar.dt, on)
            running.in_step(bar, step + 1, HOOKS, on)
            remedies.in_step(bar, step + 1, on)
            nodes_to_particles(bar, step + 1, on)
            remedies.after_step(bar, on)
            running.after_step(bar, step + 1, HOOKS, on)
            if (step + 1) % CHECK_EVERY == 0:
                check(bar, step + 1)
            if (step + 1) % bar.sample_interval == 0:
                row = (step + 1) // bar.sample_interval - start // bar.sample_interval - 1
                sample(bar, row, step + 1, (step + 1) % bar.look_interval == 0, on)


@ti.kernel
def measure(step: ti.i32, bar: BarState, on: ti.template()):
    """Check the state and sample it into row 0, wherever the run stands."""
    ti.loop_config(serialize=True)
    for _ in range(1):
        if bar.verdict[0] == SOUND:
            check(bar, step)
        sample(bar, 0, step, True, on)


@ti.kernel
def report(step: ti.i32, bar: BarState, on: ti.template()):
    """Bring the estimates up to date with the state, for whoever looks at the particles."""
    ti.loop_config(serialize=True)
    for _ in range(1):
        running.report(bar, step, HOOKS, on)


@ti.kernel
def freeze(bar: BarState, on: ti.template()):
    """Find the weights of a bar that keeps them."""
    ti.loop_config(serialize=True)
    for _ in range(1):
        find_weights(bar, on)


@ti.kernel
def find_margin(bar: BarState, on: ti.template()):
    """Find the margin of the step, for whoever asks: a kernel of its own, for its code is long and called seldom."""
    ti.loop_config(serialize=True)
    for _ in range(1):
        margin.step_margin(bar)
