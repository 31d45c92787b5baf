"""Execution plan of a plane body on a GPU: its arrays stay there, and steps are queued without waiting. The CPU solves
a companion in parallel, which is evaluated at the samples."""

import contextlib
import copy
from collections.abc import Mapping
from typing import Any

import numpy as np
import taichi as ti

from solvers.estimators.companion_solution import MOST_INTERVAL, NOW
from solvers.estimators.standalone_companion import ElasticBody, MotionDivergedError, NystromIntegrator
from solvers.kernels import runtime
from solvers.kernels.launch import Launch
from solvers.problems.planar.method import stabilisations
from solvers.problems.planar.method.body import InstrumentedBody
from solvers.problems.planar.plans.gpu_kernels import GpuKernels
from solvers.scene.estimator_hooks import NEVER
from solvers.scene.kernel_options import KernelOptions
from solvers.scene.scene import Scene
from solvers.solver.base import MEASURE, REPORT
from solvers.solver.serial_stepping import CHECK_EVERY

INSTANTS = 8  # instants to which the companion can go back, as for timings, which take some steps again; and the start
COMPANION_NODES = "companion_nodes"  # what the processor brings to each sample
FETCHED = ("verdict", "samples", "step_margin", "memory_reals")  # what is fetched whenever steps have been taken


class CompanionOnCpu:
    """Companion solved on the CPU beside a GPU: its ``body``, the estimator's arrays by name, ``memory``, which get its
    nodes, and the run's step ``dt`` in s."""

    def __init__(self, body: ElasticBody, memory: Mapping[str, np.ndarray], dt: float):
        self._body, self._nodes, self._dt = body, memory["companion_nodes"], dt
        self._instants = [NystromIntegrator(body, MOST_INTERVAL * dt)]

    def advance_to(self, step: int) -> None:
        """Writes the layer ``NOW`` of ``companion_nodes``: u (m) and v (m/s) after ``step`` steps of the run, and a
        (m/s^2) one step before; NaN where the companion itself is lost."""
        integrator = self._integrator_at(max(0, step - 1))
        a = integrator.a
        if step:
            integrator = self._integrator_at(step)
        N = len(integrator.u)
        self._nodes[NOW * N:(NOW + 1) * N, :6] = np.concatenate([integrator.u, integrator.v, a], axis=1)

    def _integrator_at(self, step: int) -> NystromIntegrator:
        """Returns the body's integrator after ``step`` steps of the run, advanced from the last cached state before."""
        time = step * self._dt
        while self._instants[-1].time > time:
            self._instants.pop()
        integrator = copy.copy(self._instants[-1])
        with np.errstate(all="ignore"), contextlib.suppress(MotionDivergedError):
            integrator.advance_to(time)
        self._instants.append(integrator)
        if len(self._instants) > INSTANTS:
            del self._instants[1]
        return integrator


class DeviceArrays:
    """Copies on the GPU of ``arrays`` by name; ``types`` are those of a kernel's arguments.

    :meth:`free` exists because Taichi 1.7.4 never frees arrays of vectors, and other arrays only in Python's garbage
    collection, by an address at which the next program may have allocated another by then.
    """

    def __init__(self, arrays: dict[str, np.ndarray], types: dict[str, Any]):
        self.arrays = arrays
        self.copies: dict[str, ti.Ndarray] = {}
        self.copies = {name: ti.ndarray(types[name].dtype, array.shape[:types[name].ndim])
                       for name, array in arrays.items()}
        runtime.holders.add(self)
        self.upload(*arrays)

    def __del__(self) -> None:
        self.free()

    def fetch(self, *names: str) -> None:
        """Copies the arrays of these names from the GPU."""
        for name in names:
            self.arrays[name][...] = self.copies[name].to_numpy()

    def upload(self, *names: str) -> None:
        """Copies the arrays of these names to the GPU."""
        for name in names:
            self.copies[name].from_numpy(self.arrays[name])

    def free(self) -> None:
        """Frees the copies, when they are no longer used or Taichi is about to end."""
        if self.copies:
            ti.sync()  # queued kernels may use them
            program = ti.lang.impl.get_runtime().prog
            for device_copy in self.copies.values():
                program.delete_ndarray(device_copy.arr)
                device_copy.arr = None
            self.copies = {}


class GpuStepper:
    """Stepper of copies of a run's ``arrays`` on a GPU. These have the state of the last fetch; steps fetch only
    verdict and samples. The CPU advances the companion ``beside`` while the GPU works. Nodal sums are atomic."""

    def __init__(self, kernels: GpuKernels, State: Any, scene: Scene, arrays: InstrumentedBody, on: KernelOptions,
                 beside: CompanionOnCpu | None):
        self._scene, self._arrays, self._on, self._companion = scene, arrays, on, beside
        members = arrays.members()
        self._names = [name for name, value in members.items() if isinstance(value, np.ndarray)]
        self._device_arrays = DeviceArrays({name: members[name] for name in self._names}, State.members)
        self.pack = State(**{**members, **self._device_arrays.copies})
        self._kernels = GpuKernels(*(Launch(kernel, self.pack, on) for kernel in kernels))
        runtime.holders.add(self)
        if on.frozen:
            self._kernels.freeze()

    def free(self) -> None:
        """Releases all objects of Taichi, which is about to end."""
        self.pack = None

    def compile(self) -> None:
        """Compiles all kernels that step and sample, without stepping."""
        kernels, on = self._kernels, self._on
        for launch in (kernels.to_nodes, kernels.to_particles, kernels.check):
            launch.compile(0)
        kernels.sample.compile(0, 0)
        if on.soundness:
            kernels.contradictions.compile(0)
        if on.filtered or on.coupled:
            kernels.begin_remedies.compile()
            kernels.sharpen.compile(0)
            kernels.end_remedies.compile()
        if self._companion:
            kernels.report.compile(0)

    def run(self, before: int, steps: int) -> None:
        """Takes ``steps`` steps after the first ``before``; once a check finds the run unstable they do nothing."""
        kernels, scene, line = self._kernels, self._scene, 0
        for step in range(before + 1, before + steps + 1):
            kernels.to_nodes(step - 1)
            if (self._on.filtered or self._on.coupled) and step % self._arrays.remedy_interval == 0:
                kernels.begin_remedies()
                for pass_number in range(stabilisations.PASSES if self._on.coupled else 1):
                    kernels.sharpen(pass_number)
                kernels.end_remedies()
            kernels.to_particles(step)
            if step % CHECK_EVERY == 0:
                kernels.check(step)
            if step % scene.sample_interval == 0:
                self._sample(step, line, step % scene.look_interval == 0)
                line += 1
        self._device_arrays.fetch(*FETCHED)

    def inspect_state(self, step: int, purpose: int) -> None:
        """Samples the state after ``step`` steps into row 0, with a check before if ``purpose`` is ``MEASURE``; if it
        is ``REPORT``, only updates the estimates."""
        if purpose == MEASURE:
            self._kernels.check(step)
        if purpose == REPORT:
            self._report_estimates(step)
        else:
            self._sample(step, 0, True)
            self._device_arrays.fetch(*FETCHED)

    def compute_step_margin(self) -> None:
        self._kernels.compute_step_margin()
        self._device_arrays.fetch(*FETCHED)

    def fetch(self) -> None:
        """Copies all arrays of the run from the GPU."""
        self._device_arrays.fetch(*self._names)

    def upload(self) -> None:
        """Copies all arrays of the run to the GPU, which continues from them."""
        self._device_arrays.upload(*self._names)

    def _sample(self, step: int, line: int, looks: bool) -> None:
        self._report_estimates(step)
        self._kernels.sample(step, line)
        if looks and self._on.soundness:
            self._kernels.contradictions(line)

    def _report_estimates(self, step: int) -> None:
        """Updates the estimates to ``step`` steps. The CPU advances its part while the GPU has work in its queue."""
        if self._companion and self._arrays.estimate_intervals[0] != NEVER:
            self._companion.advance_to(step)
            self._device_arrays.upload(COMPANION_NODES)
            self._kernels.report(step)
