"""One turn of a kernel that holds a whole run on one thread: a step and what is due after it, for every problem."""

from collections.abc import Callable
from typing import Any, NamedTuple

import taichi as ti

from solvers.estimators import estimator_loop
from solvers.kernels.launch import Launch
from solvers.kernels.scalar_hoisting import hoist_scalars
from solvers.scene.kernel_options import KernelOptions
from solvers.solver.base import CRUSHED, ESCAPED, INVERTED, MEASURE, REPORT, SOUND, STEP

CHECK_EVERY = 8  # steps between two looks for a run that has gone bad
MIN_JACOBIAN = 1e-3  # det F below which a particle counts as crushed; the exact bar stays above 1 - 2 pi A
NAN_JACOBIAN = -1e300  # stands for a det F that is not a number: flatter than any


class Phases(NamedTuple):
    """What a problem does in a turn, and beside it."""

    one_step: Callable  # (state, step, on)
    check: Callable  # (state, step): stop a run that has gone bad
    sample: Callable  # (state, row, step, whether to look for contradictions, on)
    hooks: dict  # of its estimators
    find_weights: Callable  # (state, on): of all particles, where they are kept
    find_margin: Callable  # (state, on): of the step


class SerialKernels(NamedTuple):
    """The kernels of a run on one thread; ``on`` are the switches of a scene."""

    advance: Any  # (start, turns, purpose, state, on)
    freeze: Any  # (state, on)
    find_margin: Any  # (state, on)


def serial_kernels(State: Any, phases: Phases) -> SerialKernels:
    """Those of a problem whose kernels take a ``State``."""
    @ti.kernel
    def advance(start: ti.i32, turns: ti.i32, purpose: ti.i32, state: State, on: ti.template()):
        """From step ``start`` on, ``turns`` turns for ``purpose``: see :func:`run_loop`."""
        ti.loop_config(serialize=True)
        for turn in range(turns):
            run_loop(hoist_scalars(state), turn, start, purpose, phases, on)

    @ti.kernel
    def freeze(state: State, on: ti.template()):
        """Find the weights of a body that keeps them."""
        ti.loop_config(serialize=True)
        for _ in range(1):
            phases.find_weights(state, on)

    @ti.kernel
    def find_margin(state: State, on: ti.template()):
        """Find the margin of the step, for whoever asks: a kernel of its own, for its code is long, its calls rare."""
        ti.loop_config(serialize=True)
        for _ in range(1):
            phases.find_margin(state, on)

    return SerialKernels(advance, freeze, find_margin)


class SerialStepper:
    """Steps the arrays of a ``pack`` as they are, on one thread."""

    def __init__(self, kernels: SerialKernels, pack: Any, on: KernelOptions):
        self.pack = pack
        self._advance, self.find_margin = (Launch(one, pack, on) for one in (kernels.advance, kernels.find_margin))
        if on.frozen:
            kernels.freeze(pack, on)

    def compile(self) -> None:
        """Compile what steps and samples, without stepping, beside what :meth:`run` needs."""

    def run(self, before: int, steps: int) -> None:
        """Take steps after ``before`` of them, or until a check finds the run gone bad."""
        self._advance(before, steps, STEP)

    def look(self, step: int, purpose: int) -> None:
        """Sample the state, after ``step`` steps, into line 0, or only bring the estimates up to date."""
        self._advance(step, 1, purpose)

    def fetch(self) -> None:
        """The arrays are what they are."""

    def upload(self) -> None:
        """The arrays are what they are."""


@ti.func
def run_loop(state: ti.template(), turn, start, purpose, phases: ti.template(), on: ti.template()):
    """Turn number ``turn``, from zero, of a run at step ``start``: take one step and sample the norms if it is one of
    every ``sample_interval`` (``STEP``); or, wherever the run stands, check and sample it into row 0 (``MEASURE``) or
    only bring the estimates up to date (``REPORT``).

    One function for all three: what samples is most of the code, and the compiler's time goes with the code.
    """
    if purpose != STEP or state.verdict[0] == SOUND:
        step, row, due, looks = start, 0, True, purpose == MEASURE
        if purpose == STEP:
            step += turn + 1
            phases.one_step(state, step, on)
            row = step // state.sample_interval - start // state.sample_interval - 1
            due = step % state.sample_interval == 0
            looks = step % state.look_interval == 0
        if (purpose == STEP and step % CHECK_EVERY == 0) or (purpose == MEASURE and state.verdict[0] == SOUND):
            phases.check(state, step)
        if due:
            estimator_loop.report(state, step, phases.hooks, on)
            if purpose != REPORT:
                phases.sample(state, row, step, looks, on)


@ti.func
def sample_effects(state: ti.template(), row, step, samplers: ti.template(), on: ti.template()):
    """What each effect has found, by ``solvers.scene.effects.samplers``."""
    for e in ti.static(range(len(on.effects))):
        if ti.static(on.effects[e] in samplers):
            samplers[on.effects[e]](state, row, step, on)


@ti.func
def check_particles(state: ti.template(), step, jacobian: ti.template(), has_escaped: ti.template()):
    """Stop a run with a particle with det F, which ``flatness(state, p)`` gives, <= 0, tiny or NaN, the flattest of
    them, or else the first for which ``has_escaped(state, p, step)`` says that none of a sound run is there.

    Without the middle one a run that collapses, all particles in a few clusters, would go on for ever.
    """
    flattest, bad = MIN_JACOBIAN, -1
    for p in range(state.particles):
        J = jacobian(state, p)
        if not J >= flattest:  # true for NaN too
            flattest, bad = NAN_JACOBIAN if ti.math.isnan(J) else J, p
            state.verdict[0] = CRUSHED if J > 0 else INVERTED
        elif bad < 0 and has_escaped(state, p, step):
            bad = p
            state.verdict[0] = ESCAPED
    if bad >= 0:
        state.verdict[1], state.verdict[2] = step, bad
