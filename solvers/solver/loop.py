"""One turn of a kernel that holds a whole run on one thread: a step and what is due after it, for every problem."""

from collections.abc import Callable
from typing import NamedTuple

import taichi as ti

from solvers.estimators import running
from solvers.solver.base import MEASURE, REPORT, SOUND, STEP

CHECK_EVERY = 8  # steps between two looks for a run that has gone bad


class Phases(NamedTuple):
    """What a problem does in a turn."""

    one_step: Callable  # (state, step, on)
    check: Callable  # (state, step): stop a run that has gone bad
    sample: Callable  # (state, row, step, whether to look for contradictions, on)
    hooks: dict  # of its estimators


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
            running.report(state, step, phases.hooks, on)
            if purpose != REPORT:
                phases.sample(state, row, step, looks, on)
