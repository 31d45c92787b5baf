"""Many steps of the bar in one kernel on one thread: at this size launches would cost more than the physics."""

import taichi as ti

from solvers.estimators import estimator_loop
from solvers.problems.bar.budget import error_propagation, reference
from solvers.problems.bar.budget.budget_arrays import with_budget
from solvers.problems.bar.method import remedies
from solvers.problems.bar.method.phases import find_weights, nodes_to_particles, update_grid
from solvers.problems.bar.method.samples import sample
from solvers.problems.bar.method.stability_margin import step_margin
from solvers.problems.bar.state import HOOKS, BarState
from solvers.scene.effects import samplers
from solvers.scene.typed import TYPED
from solvers.solver.run_loop import Phases, check_particles, sample_effects, serial_kernels

SAMPLERS = samplers("bar", {})


@ti.func
def jacobian(bar: ti.template(), p):
    return bar.deformation_gradient[p]


@ti.func
def has_escaped(bar: ti.template(), p, step):
    """Returns whether a particle is far outside the possible range."""
    moved = bar.drift_velocity * bar.dt * step
    return not abs(bar.position[p] - bar.material_position[p] - moved) < bar.farthest


@ti.func
def check_state(bar: ti.template(), step):
    check_particles(bar, step, jacobian, has_escaped)


@ti.func
def one_step(bar: ti.template(), step, on: ti.template()):
    """Takes step number ``step``, counted from one."""
    update_grid(bar, (step - 1) * bar.dt, on)
    estimator_loop.in_step(bar, step, HOOKS, on)
    if ti.static(on.budget):
        error_propagation.update_grid(with_budget(bar), (step - 1) * bar.dt, on)
    remedies.in_step(bar, step, on)
    if ti.static(on.budget):
        error_propagation.in_step(with_budget(bar), step, on)
    nodes_to_particles(bar, step, on)
    if ti.static(on.budget):
        error_propagation.after_step(with_budget(bar), on)
    remedies.after_step(bar, on)
    estimator_loop.after_step(bar, step, HOOKS, on)
    if ti.static(on.budget and on.truth and on.motion == TYPED):
        reference.typed_after_step(with_budget(bar), step)
    elif ti.static(on.budget and not on.truth):
        reference.companion_after_step(estimator_loop.with_memory(with_budget(bar), HOOKS, "companion"), step)


@ti.func
def sample_all(bar: ti.template(), row, step, looks, on: ti.template()):
    """Writes one row of samples: the method's, the effects', and the budget's."""
    sample(bar, row, step, looks, on)
    sample_effects(bar, row, step, SAMPLERS, on)
    if ti.static(on.budget):
        error_propagation.sample_budget_sums(with_budget(bar), row, step, on)


PHASES = Phases(one_step, check_state, sample_all, HOOKS, find_weights, step_margin)
KERNELS = serial_kernels(BarState, PHASES)
