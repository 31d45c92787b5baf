"""One iteration of a kernel that runs on one thread: a step and what is due after it, for every problem."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import taichi as ti

from solvers.estimators import estimator_loop
from solvers.kernels.launch import Launch
from solvers.kernels.scalar_hoisting import hoist_scalars
from solvers.scene.kernel_options import KernelOptions
from solvers.scene.scene import Scene
from solvers.solver.base import CRUSHED, ESCAPED, INVERTED, MEASURE, REPORT, SOUND, STEP
from solvers.solver.state_arrays import Members

CHECK_EVERY = 8  # steps between two checks for an unstable run
MIN_JACOBIAN = 1e-3  # det F below which a particle counts as crushed; the exact bar stays above 1 - 2 pi A
NAN_JACOBIAN = -1e300  # stands for a det F that is NaN: smaller than any other


class StepFunctions(NamedTuple):
    """Parts of a problem's step and of what is evaluated beside it, as Taichi functions of the problem's state."""

    one_step: Callable  # (state, step, on)
    check: Callable  # (state, step): stops an unstable run
    sample: Callable  # (state, row, step, whether to look for contradictions, on)
    hooks: dict  # of its estimators
    find_weights: Callable  # (state, on): computes the frozen weights of all particles
    compute_step_margin: Callable  # (state, on): computes the step margin


class SerialKernels(NamedTuple):
    """Kernels of a run on one thread; ``on`` are a scene's compile-time options."""

    advance: Any  # (start, turns, purpose, state, on)
    freeze: Any  # (state, on)
    compute_step_margin: Any  # (state, on)


def serial_kernels(State: Any, phases: StepFunctions) -> SerialKernels:
    """Returns the kernels of a problem whose state has the Taichi type ``State``, from the parts of its step."""
    @ti.kernel
    def advance(start: ti.i32, turns: ti.i32, purpose: ti.i32, state: State, on: ti.template()):
        """Runs ``turns`` iterations from step ``start`` on, for ``purpose``: see :func:`step_or_sample`. ``on``:
        compile-time options."""
        ti.loop_config(serialize=True)
        for turn in range(turns):
            step_or_sample(hoist_scalars(state), turn, start, purpose, phases, on)

    @ti.kernel
    def freeze(state: State, on: ti.template()):
        """Computes the weights of a body with frozen weights. ``on``: compile-time options."""
        ti.loop_config(serialize=True)
        for _ in range(1):
            phases.find_weights(state, on)

    @ti.kernel
    def compute_step_margin(state: State, on: ti.template()):
        """Computes the step margin, in its own kernel: its code is long and rarely called. ``on``: kernel options."""
        ti.loop_config(serialize=True)
        for _ in range(1):
            phases.compute_step_margin(state, on)

    return SerialKernels(advance, freeze, compute_step_margin)


class SerialStepper:
    """Stepper of the arrays of a ``pack``, the kernels' argument, in place, on one thread, with the options ``on``."""

    def __init__(self, kernels: SerialKernels, pack: Any, on: KernelOptions):
        self.pack = pack
        self._advance, self.compute_step_margin = (
            Launch(kernel, pack, on) for kernel in (kernels.advance, kernels.compute_step_margin))
        self._main_launch = self._advance
        self._freeze = Launch(kernels.freeze, pack, on) if on.frozen else None
        if self._freeze:
            self._freeze()

    def restart(self, scene: Scene, state: Members) -> bool:
        """Starts another run with the numbers of its initial ``state``, whose arrays have been written to those of the
        pack. Returns False if the pack cannot be used again: it has not been yet, or Taichi has restarted."""
        if not self._main_launch.is_kept:
            return False
        for name, value in state.members().items():
            if not isinstance(value, np.ndarray) and value != self.pack[name]:
                self.pack[name] = value
        if self._freeze:
            self._freeze()
        return True

    def compile(self) -> None:
        """Does nothing: all kernels are compiled by :meth:`run`."""

    def run(self, before: int, steps: int) -> None:
        """Takes ``steps`` steps after the first ``before``, or fewer if a check finds the run unstable."""
        self._advance(before, steps, STEP)

    def inspect_state(self, step: int, purpose: int) -> None:
        """Samples the state after ``step`` steps into row 0, or, for the purpose ``REPORT``, only updates estimates."""
        self._advance(step, 1, purpose)

    def fetch(self) -> None:
        """Does nothing: the kernels work on the arrays themselves."""

    def upload(self) -> None:
        """Does nothing: the kernels work on the arrays themselves."""


@ti.func
def step_or_sample(state: ti.template(), turn, start, purpose, phases: ti.template(), on: ti.template()):
    """Runs iteration ``turn``, from zero, of a launch at step ``start``: takes one step and samples the norms if it is
    a multiple of ``sample_interval`` (``STEP``); or checks the present state and samples it into row 0 (``MEASURE``),
    or only updates the estimates (``REPORT``). ``on``: compile-time options.

    One function serves all three: sampling is most of the code, and compile time grows with the code.
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
    """Calls the samplers of all active effects (``solvers.scene.effects.samplers``) for a row of ``state.samples``.
    ``on``: compile-time options."""
    for e in ti.static(range(len(on.effects))):
        if ti.static(on.effects[e] in samplers):
            samplers[on.effects[e]](state, row, step, on)


@ti.func
def check_particles(state: ti.template(), step, jacobian: ti.template(), has_escaped: ti.template()):
    """Stops a run, by ``state.verdict``, with a particle whose det F, which ``jacobian(state, p)`` returns, is <= 0,
    tiny or NaN, the smallest of them, or else the first for which ``has_escaped(state, p, step)`` is true.

    Without the limit on tiny ones, a run that collapses into a few clusters of particles would never stop.
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
