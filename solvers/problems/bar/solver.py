"""BarSolver: solver of one bar, which steps and samples it."""

from typing import Any

import numpy as np

from solvers.kernels import runtime
from solvers.problems.bar import exact_solution, particle_step_breakdown
from solvers.problems.bar.scene import BarScene
from solvers.problems.bar.serial_step_kernel import KERNELS, PHASES
from solvers.problems.bar.state import HOOKS, BarState, InstrumentedBar, escape_distance, initial_state
from solvers.solver.base import REPORT, Solver
from solvers.solver.particle_snapshot import TRUTH, ParticleFields, ParticleValues, Snapshot
from solvers.solver.serial_stepping import SerialStepper
from solvers.translatable_message import Message

HATS_LIMIT = 0.14  # amplitude from which on no rate of a remedy holds hat functions together


class BarSolver(Solver):
    """Solver of a bar, which owns its arrays. All steps run in one serial kernel, whatever threads the scene allows."""

    HOOKS, PHASES, STATE, STEP_BREAKDOWN = HOOKS, PHASES, InstrumentedBar, particle_step_breakdown
    scene: BarScene
    _arrays: InstrumentedBar

    def __init__(self, scene: BarScene):
        super().__init__(scene)
        self._start(scene)

    def _start(self, scene: Any) -> None:
        self.arch = runtime.start("cpu", self.threads)  # also for "gpu": one step after another gains nothing there
        super()._start(scene)

    def _initial_state(self, scene: Any) -> dict[str, Any]:
        return initial_state(scene, self._switches)

    def _make_stepper(self) -> SerialStepper:
        return SerialStepper(KERNELS, BarState(**self._arrays.members() | self._buffers.arrays), self._switches)

    def snapshot(self, differences: bool = False, plotted: str | None = None) -> Snapshot:
        self._stepping.inspect_state(self.step, REPORT)
        a, scene, t = self._arrays, self.scene, self.time
        X, F = a.material_position, a.deformation_gradient / a.unstretched
        errors = None
        if self._switches.truth:
            before = t - scene.time_step if self.step else 0.0
            true_a = a.acceleration - exact_solution.acceleration(scene, X, before) \
                if self._switches.acceleration and self.step else np.zeros_like(X)
            with np.errstate(over="ignore", invalid="ignore"):  # for unstable runs
                u, v = (a.position - X - exact_solution.displacement(scene, X, t),
                        a.velocity - exact_solution.velocity(scene, X, t))
                stretch = F - exact_solution.deformation_gradient(scene, X, t)
                errors = np.stack([u, v, scene.modulus * stretch, true_a], axis=1)
        estimates = {name: a.estimate[k * len(X):(k + 1) * len(X)].copy()
                     for k, name in enumerate(self._switches.estimators)}
        missed = {} if errors is None or not differences else {
            name: np.abs(estimate - errors) for name, estimate in estimates.items()}
        return Snapshot(step=self.step, time=t, material_position=X.copy(), position=a.position.copy(),
                        velocity=a.velocity.copy(), deformation_gradient=F, error=errors, estimate=estimates,
                        difference=missed, plotted=None if plotted is None else self.plotted(plotted),
                        last_crossing=a.last_crossing.copy() if self._switches.crossings else None)

    def plotted(self, quantity: str) -> np.ndarray:
        scene, a, X, t = self.scene, self._arrays, self._arrays.material_position, self.time
        with np.errstate(over="ignore", invalid="ignore"):  # for unstable runs
            moved = exact_solution.displacement(scene, X, t) if scene.is_patch else 0.0
            values = {"x": a.position - X - moved, "v": a.velocity,
                      "sigma": a.modulus * (a.deformation_gradient - a.unstretched),
                      "a": a.acceleration if scene.has("acceleration") else np.nan}[quantity]
            deviation = values - exact_solution.field_as_sampled(scene, quantity, X, t)
        return np.stack(np.broadcast_arrays(values, deviation, X)[:2], axis=1)

    def fields(self) -> ParticleFields:
        a, shot = self._arrays, self.snapshot()
        said = shot.estimate if shot.error is None else {TRUTH: shot.error, **shot.estimate}
        values = np.stack([shot.position - shot.material_position, shot.velocity,
                           self.scene.modulus * (shot.deformation_gradient - 1)], axis=1)
        return ParticleFields(a.material_position[:, None].copy(), np.full(a.particles, a.density * a.volume),
                              np.full(a.particles, a.volume), _without_acceleration(values),
                              {name: _without_acceleration(errors) for name, errors in said.items()})

    def _escape_sentence(self) -> str:
        return Message("moved {scene:.3g} m or more from where it began", escape_distance(self.scene))


def _without_acceleration(values: np.ndarray) -> ParticleValues:
    """Returns the values or errors of x, v and sigma, which are the first three of four columns (P, 4)."""
    return ParticleValues(values[:, :1], values[:, 1:2], values[:, 2:3])
