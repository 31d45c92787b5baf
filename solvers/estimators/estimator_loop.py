"""The loop over a scene's estimators in kernels, unrolled when the kernel is compiled."""

import taichi as ti

from solvers.estimators.estimator_arrays import packing
from solvers.kernels.packing import PackedAttributesView
from solvers.kernels.scalar_hoisting import mark_untranslated_by_taichi
from solvers.scene.estimator_hooks import NEVER


@mark_untranslated_by_taichi
def with_memory(state, estimators, name):
    """Returns ``state`` with the memory of estimator ``name`` as further attributes, while a kernel is compiled;
    ``estimators`` are all hooks by name, as their memory is packed together."""
    return PackedAttributesView(state, packing(estimators), estimators[name].memory)


@ti.func
def in_step(state: ti.template(), step, estimators: ti.template(), on: ti.template()):
    """Calls the active estimators' hooks ``in_step``, after the nodes of step number ``step`` (from 1) have moved."""
    for e, name in ti.static(enumerate(on.estimators)):
        if ti.static(estimators[name].in_step):
            if step % state.estimate_intervals[e] == 0:
                estimators[name].in_step(with_memory(state, estimators, name), e * state.particles, on)


@ti.func
def after_step(state: ti.template(), step, estimators: ti.template(), on: ti.template()):
    """Calls the active estimators' hooks ``after_step``, at the end of step number ``step`` (from 1)."""
    for e, name in ti.static(enumerate(on.estimators)):
        if ti.static(estimators[name].after_step):
            if step % state.estimate_intervals[e] == 0:
                estimators[name].after_step(with_memory(state, estimators, name), e * state.particles, step, on)


@ti.func
def report(state: ti.template(), step, estimators: ti.template(), on: ti.template()):
    """Writes all estimates to the state's ``estimate`` arrays after ``step`` steps, unless an estimator is left out."""
    for e, name in ti.static(enumerate(on.estimators)):
        if ti.static(estimators[name].report):
            if state.estimate_intervals[e] != NEVER:
                estimators[name].report(with_memory(state, estimators, name), e * state.particles, step, on)


@ti.func
def report_at_once(state: ti.template(), step, estimators: ti.template(), on: ti.template()):
    """Writes all estimates on a GPU, inside a kernel, from the estimators' bodies that the CPU solved to ``step``."""
    for e, name in ti.static(enumerate(on.estimators)):
        estimators[name].report_at_once(with_memory(state, estimators, name), e * state.particles, step, on)
