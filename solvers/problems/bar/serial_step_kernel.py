"""Many steps of the bar in one kernel on one thread: at this size launches would cost more than the physics."""

import taichi as ti

from solvers.estimators import estimator_loop
from solvers.problems.bar.budget import error_propagation, reference_motion
from solvers.problems.bar.budget.budget_arrays import state_with_budget_arrays
from solvers.problems.bar.method import stabilisations
from solvers.problems.bar.method.error_and_energy_sums import write_sample_row
from solvers.problems.bar.method.phases import find_weights, nodes_to_particles, update_grid
from solvers.problems.bar.method.stability_margin import step_margin
from solvers.problems.bar.state import HOOKS, BarState
from solvers.scene.effects import samplers
from solvers.scene.typed_motion_scene import TYPED
from solvers.solver.serial_stepping import StepFunctions, check_particles, sample_effects, serial_kernels

SAMPLERS = samplers("bar", {})


@ti.func
def jacobian(bar: ti.template(), p):
    return bar.deformation_gradient[p]


@ti.func
def has_escaped(bar: ti.template(), p, step):
    """Returns whether particle p is ``bar.farthest`` m or more from its start after ``step`` steps, less any drift."""
    moved = bar.drift_velocity * bar.dt * step
    return not abs(bar.position[p] - bar.material_position[p] - moved) < bar.farthest


@ti.func
def check_state(bar: ti.template(), step):
    """Stops an unstable run after ``step`` steps, by ``bar.verdict`` (:func:`check_particles`)."""
    check_particles(bar, step, jacobian, has_escaped)


@ti.func
def one_step(bar: ti.template(), step, on: ti.template()):
    """Takes step ``step`` (from one) on the arrays: method, estimators, remedies and budget. ``on``: kernel options."""
    update_grid(bar, (step - 1) * bar.dt, on)
    estimator_loop.in_step(bar, step, HOOKS, on)
    if ti.static(on.budget):
        error_propagation.update_grid(state_with_budget_arrays(bar), (step - 1) * bar.dt, on)
    stabilisations.in_step(bar, step, on)
    if ti.static(on.budget):
        error_propagation.in_step(state_with_budget_arrays(bar), step, on)
    nodes_to_particles(bar, step, on)
    if ti.static(on.budget):
        error_propagation.correct_particles_after_step(state_with_budget_arrays(bar), on)
    stabilisations.subtract_mean_velocity(bar, on)
    estimator_loop.after_step(bar, step, HOOKS, on)
    if ti.static(on.budget and on.truth and on.motion == TYPED):
        reference_motion.add_typed_time_step_error(state_with_budget_arrays(bar), step)
    elif ti.static(on.budget and not on.truth):
        reference_motion.add_companion_time_step_error(
            estimator_loop.with_memory(state_with_budget_arrays(bar), HOOKS, "companion"), step)


@ti.func
def sample_all(bar: ti.template(), row, step, looks, on: ti.template()):
    """Writes a row of ``bar.samples`` after ``step`` steps; with ``looks`` it has the checks for contradictions too.
    ``on``: compile-time options."""
    write_sample_row(bar, row, step, looks, on)
    sample_effects(bar, row, step, SAMPLERS, on)
    if ti.static(on.budget):
        error_propagation.sample_budget_sums(state_with_budget_arrays(bar), row, step, on)


PHASES = StepFunctions(one_step, check_state, sample_all, HOOKS, find_weights, step_margin)
KERNELS = serial_kernels(BarState, PHASES)
