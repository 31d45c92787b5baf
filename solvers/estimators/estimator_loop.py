"""The loop over a scene's estimators in kernels, unrolled when the kernel is compiled."""

import taichi as ti

from solvers.estimators.estimator_memory import packing
from solvers.kernels.packing import PackedMembersView
from solvers.kernels.scalar_hoisting import mark_untranslated_by_taichi
from solvers.scene.estimator_hooks import NEVER


@mark_untranslated_by_taichi
def with_memory(state, estimators, name):
    """Returns the state with an estimator's packed memory as attributes, while kernels are compiled."""
    return PackedMembersView(state, packing(estimators), estimators[name].memory)


@ti.func
def in_step(state: ti.template(), step, estimators: ti.template(), on: ti.template()):
    """Runs the estimators' hooks between nodes and particles; ``step`` includes this step."""
    for e in ti.static(range(len(on.estimators))):
        if ti.static(estimators[on.estimators[e]].in_step):
            if step % state.estimate_intervals[e] == 0:
                estimators[on.estimators[e]].in_step(
                    with_memory(state, estimators, on.estimators[e]), e * state.particles, on)


@ti.func
def after_step(state: ti.template(), step, estimators: ti.template(), on: ti.template()):
    """Runs the estimators' hooks at the end of a step; ``step`` includes it."""
    for e in ti.static(range(len(on.estimators))):
        if ti.static(estimators[on.estimators[e]].after_step):
            if step % state.estimate_intervals[e] == 0:
                estimators[on.estimators[e]].after_step(
                    with_memory(state, estimators, on.estimators[e]), e * state.particles, step, on)


@ti.func
def report(state: ti.template(), step, estimators: ti.template(), on: ti.template()):
    """Updates every estimate after ``step`` steps, unless its estimator is left out."""
    for e in ti.static(range(len(on.estimators))):
        if ti.static(estimators[on.estimators[e]].report):
            if state.estimate_intervals[e] != NEVER:
                estimators[on.estimators[e]].report(
                    with_memory(state, estimators, on.estimators[e]), e * state.particles, step, on)


@ti.func
def report_at_once(state: ti.template(), step, estimators: ti.template(), on: ti.template()):
    """Updates every estimate on a GPU, inside a kernel, from what the CPU has advanced to ``step`` steps."""
    for e in ti.static(range(len(on.estimators))):
        estimators[on.estimators[e]].report_at_once(
            with_memory(state, estimators, on.estimators[e]), e * state.particles, step, on)
