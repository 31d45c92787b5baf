"""Steps of a plane body on a CPU, by two plans that run the same phases, and the other kernels of a run.

One kernel takes any number of steps on one thread (``solvers.solver.serial_stepping``), ``step_in_slabs`` one on
several threads, slabs of particles side by side; ``solvers.problems.planar.plans.gpu_kernels`` has a GPU's kernels.
"""

from typing import Any, NamedTuple

import numpy as np
import taichi as ti

from solvers.estimators import estimator_loop
from solvers.estimators.estimator_arrays import packing
from solvers.kernels.launch import Launch
from solvers.problems.planar.method import phases, stabilisations, stability_margin
from solvers.problems.planar.method.body import InstrumentedBody
from solvers.problems.planar.method.error_and_energy_sums import sample
from solvers.problems.planar.plans.gpu_kernels import GpuKernels, make_gpu_kernels
from solvers.problems.planar.problem_kernel_functions import PlanarKernelFunctions
from solvers.scene.kernel_options import KernelOptions
from solvers.scene.scene import Scene
from solvers.solver import serial_stepping
from solvers.solver.base import MEASURE, REPORT, SOUND, STEP
from solvers.solver.serial_stepping import SerialKernels, SerialStepper, StepFunctions, check_particles, serial_kernels

INDICES_PER_TASK = 512  # indices that a parallel loop never splits between threads


class CpuKernels(NamedTuple):
    """Compiled functions of a problem's runs, and the type of their argument ``state``; ``step`` and ``slabs`` are
    numbers, ``line`` a row of samples, ``purpose`` of ``solvers.solver.base``, ``on`` compile-time options."""

    state: Any
    phases: StepFunctions
    serial: SerialKernels
    step_in_slabs: Any  # (step, slabs, state, on)
    inspect: Any  # (step, line, purpose, state, on)
    gpu_kernels: GpuKernels  # those for a GPU


def make_cpu_kernels(parts: PlanarKernelFunctions) -> CpuKernels:
    """Returns the kernels of the problem with these ``parts``."""
    HOOKS, TRAITS, MEASURES = parts.hooks, parts.traits, parts.measures
    # Numbers and arrays as one argument: nothing of a scene is baked into compiled code but its switches.
    State = ti.types.argpack(**InstrumentedBody.types(), **packing(HOOKS).types)

    @ti.func
    def one_step(body: ti.template(), step, on: ti.template()):
        """Takes step number ``step`` (from 1) on one thread."""
        phases.map_and_update_nodes(body, (step - 1) * body.dt, TRAITS, on)
        estimator_loop.in_step(body, step, HOOKS, on)
        stabilisations.in_step(body, step, TRAITS, on)
        phases.nodes_to_particles(body, 0, step, TRAITS, on)
        estimator_loop.after_step(body, step, HOOKS, on)

    @ti.func
    def sample_it(body: ti.template(), row, step, looks, on: ti.template()):
        sample(body, row, step, looks, MEASURES, on)

    @ti.func
    def check_it(body: ti.template(), step):
        check_particles(body, step, phases.jacobian, TRAITS.has_escaped)

    @ti.func
    def find_weights(body: ti.template(), on: ti.template()):
        phases.find_weights(body, 0, body.particles, on)

    @ti.func
    def compute_step_margin(body: ti.template(), on: ti.template()):
        stability_margin.store_step_margin(body, TRAITS, on)

    in_turn = StepFunctions(one_step, check_it, sample_it, HOOKS, find_weights, compute_step_margin)

    @ti.kernel
    def step_in_slabs(step: ti.i32, slabs: ti.i32, body: State, on: ti.template()):
        """Takes the step after ``step`` steps on as many threads as there are slabs; ``slabs`` = 0 only compiles."""
        for _ in range(ti.min(slabs, 1)):
            TRAITS.forces(body, step * body.dt, on)
        for task in range(INDICES_PER_TASK * slabs):
            if task % INDICES_PER_TASK == 0:
                phases.particles_to_nodes(body, task // INDICES_PER_TASK, TRAITS, on)
        for task in range(INDICES_PER_TASK * slabs):
            if task % INDICES_PER_TASK == 0:
                first, last = phases.slab_range(body.active, task // INDICES_PER_TASK, body.slabs)
                for j in range(first, last):
                    phases.sum_slabs_in_row(body, j)
        for _ in range(ti.min(slabs, 1)):
            TRAITS.fold(body, phases.fold_ghost_sums)
        for task in range(INDICES_PER_TASK * slabs):
            if task % INDICES_PER_TASK == 0:
                first, last = phases.slab_range(body.active - TRAITS.first, task // INDICES_PER_TASK, body.slabs)
                for j in range(first, last):
                    phases.update_node_row(body, TRAITS.first + j, TRAITS, on)
        for _ in range(ti.min(slabs, 1)):
            TRAITS.mirror(body, body.node_motion)
            estimator_loop.in_step(body, step + 1, HOOKS, on)
            stabilisations.in_step(body, step + 1, TRAITS, on)
        for task in range(INDICES_PER_TASK * slabs):
            if task % INDICES_PER_TASK == 0:
                phases.nodes_to_particles(body, task // INDICES_PER_TASK, step + 1, TRAITS, on)
        for _ in range(ti.min(slabs, 1)):
            estimator_loop.after_step(body, step + 1, HOOKS, on)

    @ti.kernel
    def inspect(step: ti.i32, line: ti.i32, purpose: ti.i32, body: State, on: ti.template()):
        """Checks the state after ``step`` steps unless the purpose is ``REPORT``, and samples it into row ``line``
        unless that is negative, with contradictions where they are due or the purpose is ``MEASURE``."""
        ti.loop_config(serialize=True)
        for _ in range(1):
            if purpose != REPORT and body.verdict[0] == SOUND:
                check_it(body, step)
            if line >= 0:
                estimator_loop.report(body, step, HOOKS, on)
            if line >= 0 and purpose != REPORT:
                sample(body, line, step, purpose == MEASURE or step % body.look_interval == 0, MEASURES, on)

    return CpuKernels(State, in_turn, serial_kernels(State, in_turn), step_in_slabs, inspect,
                      make_gpu_kernels(State, parts))


class CpuStepper(SerialStepper):
    """Stepper of a run's arrays in place, on ``threads`` threads if ``parallel``, else on one by the serial kernel; the
    ``arrays`` are parts of the ``buffers`` by name."""

    def __init__(self, kernels: CpuKernels, scene: Scene, arrays: InstrumentedBody, buffers: dict[str, np.ndarray],
                 on: KernelOptions, parallel: bool, threads: int):
        super().__init__(kernels.serial, kernels.state(**arrays.members() | buffers), on)
        self._scene, self._arrays, self._parallel, self._threads = scene, arrays, parallel, threads
        self._step, self._inspect = (Launch(one, self.pack, on) for one in (kernels.step_in_slabs, kernels.inspect))
        self._main_launch = self._step if parallel else self._advance

    def restart(self, scene: Scene, state: InstrumentedBody) -> bool:
        self._scene, self._arrays = scene, state
        return super().restart(scene, state)

    def compile(self) -> None:
        if self._parallel:
            self._step(0, 0)
            self._inspect(0, -1, REPORT)

    def run(self, before: int, steps: int) -> None:
        if not self._parallel:
            super().run(before, steps)
            return
        interval, row = self._scene.sample_interval, 0
        for step in range(before, before + steps):
            self._step(step, self._threads)
            sampled = (step + 1) % interval == 0
            if sampled or (step + 1) % serial_stepping.CHECK_EVERY == 0:
                self._inspect(step + 1, row if sampled else -1, STEP)
                row += sampled
            if self._arrays.verdict[0] != SOUND:
                break

    def inspect_state(self, step: int, purpose: int) -> None:
        if self._parallel:
            self._inspect(step, 0, purpose)
        else:
            super().inspect_state(step, purpose)
