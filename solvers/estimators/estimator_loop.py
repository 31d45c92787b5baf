"""How kernels call the estimators of a scene: a loop over them that is unrolled when the kernel is compiled."""

import taichi as ti

from solvers.estimators.estimator_memory import packing
from solvers.kernels.packing import MemoryView
from solvers.kernels.scalar_hoisting import untranslated
from solvers.scene.estimator_hooks import NEVER


@untranslated
def with_memory(state, estimators, name):
    """The state with an estimator's memory, which it keeps packed, as attributes, while kernels are compiled."""
    return MemoryView(state, packing(estimators), estimators[name].memory)


@ti.func
def in_step(state: ti.template(), step, estimators: ti.template(), on: ti.template()):
    """The turn of the estimators between nodes and particles; ``step`` counts this step too."""
    for e in ti.static(range(len(on.estimators))):
        if ti.static(estimators[on.estimators[e]].in_step):
            if step % state.estimate_intervals[e] == 0:
                estimators[on.estimators[e]].in_step(
                    with_memory(state, estimators, on.estimators[e]), e * state.particles, on)


@ti.func
def after_step(state: ti.template(), step, estimators: ti.template(), on: ti.template()):
    """The turn of the estimators at the end of a step; ``step`` counts it."""
    for e in ti.static(range(len(on.estimators))):
        if ti.static(estimators[on.estimators[e]].after_step):
            if step % state.estimate_intervals[e] == 0:
                estimators[on.estimators[e]].after_step(
                    with_memory(state, estimators, on.estimators[e]), e * state.particles, step, on)


@ti.func
def report(state: ti.template(), step, estimators: ti.template(), on: ti.template()):
    """Bring every estimate up to date after ``step`` steps, unless its estimator is left out."""
    for e in ti.static(range(len(on.estimators))):
        if ti.static(estimators[on.estimators[e]].report):
            if state.estimate_intervals[e] != NEVER:
                estimators[on.estimators[e]].report(
                    with_memory(state, estimators, on.estimators[e]), e * state.particles, step, on)


@ti.func
def report_at_once(state: ti.template(), step, estimators: ti.template(), on: ti.template()):
    """The same on a GPU, from a kernel itself: every estimate of what the processor has brought to ``step`` steps."""
    for e in ti.static(range(len(on.estimators))):
        estimators[on.estimators[e]].report_at_once(
            with_memory(state, estimators, on.estimators[e]), e * state.particles, step, on)
