"""PlanarSolver: one plane body in memory, ready to be stepped, sampled and looked at."""

import time
from abc import abstractmethod
from typing import Any, ClassVar

import numpy as np

from solvers import runtime
from solvers.launch import Launch
from solvers.planar.errors import Fields, difference, estimated_fields, sizes
from solvers.planar.state import WatchedBody
from solvers.planar.step import Kernels
from solvers.result import Snapshot
from solvers.solver import MEASURE, REPORT, SOUND, STEP, Solver
from solvers.switches import switches
from solvers.turn import CHECK_EVERY

PARALLEL_FROM = 300_000  # particles from which on two threads beat one: a parallel step has a launch to pay for


class PlanarSolver(Solver):
    """Owns the arrays of one body. Two plans: one serial kernel for many steps, or slabs side by side.

    The scene of such a problem has a field ``plan``. A problem names its kernels and the type of their argument.
    """

    KERNELS: ClassVar[Kernels]
    STATE: ClassVar[Any]
    scene: Any
    _arrays: WatchedBody

    def __init__(self, scene: Any):
        super().__init__(scene)
        large = scene.threads > 1 and scene.particles >= PARALLEL_FROM
        self.plan = ("parallel" if large else "serial") if scene.plan == "auto" else scene.plan
        self.threads = scene.threads if self.plan == "parallel" else 1
        self.arch = runtime.start(scene.arch, self.threads)
        begun = time.perf_counter()
        self._switches = switches(scene)
        self._arrays = self._allocate(self.threads)
        self._pack = self.STATE(**self._arrays.members())
        kernels = self.KERNELS
        self._advance, self._step, self._inspect, self._find_margin = (
            Launch(kernel, self._pack, self._switches)
            for kernel in (kernels.advance, kernels.step_in_slabs, kernels.inspect, kernels.find_margin))
        if self._switches.frozen:
            kernels.freeze(self._pack, self._switches)
        self.setup_seconds = time.perf_counter() - begun

    def snapshot(self, differences: bool = False, plotted: str | None = None) -> Snapshot:
        a, on = self._arrays, self._switches
        self._look(REPORT)
        F = a.deformation_gradient.reshape(-1, 2, 2)
        true = self._true_fields() if on.truth else None
        estimates = {name: estimated_fields(a, k) for k, name in enumerate(on.estimators)}
        missed = {name: difference(fields, true) for name, fields in estimates.items()} if true and differences else {}
        return Snapshot(step=self.step, time=self.time, material_position=a.material_position,
                        position=a.motion[:, :2].copy(), velocity=a.motion[:, 2:].copy(),
                        deformation_gradient=F.copy(), error=sizes(true) if true else None,
                        estimate={name: sizes(fields) for name, fields in estimates.items()},
                        last_crossing=a.last_crossing.copy() if on.crossings else None, difference=missed,
                        plotted=None if plotted is None else self._field(plotted))

    def compile(self) -> None:
        super().compile()
        if self.plan == "parallel":
            self._step(0, 0)
            self._inspect(0, -1, REPORT)

    def _run(self, steps: int) -> None:
        if self.plan == "serial":
            self._advance(self.step, steps, STEP)
            return
        interval, row = self.scene.sample_interval, 0
        for step in range(self.step, self.step + steps):
            self._step(step, self.threads)
            sampled = (step + 1) % interval == 0
            if sampled or (step + 1) % CHECK_EVERY == 0:
                self._inspect(step + 1, row if sampled else -1, STEP)
                row += sampled
            if self._arrays.verdict[0] != SOUND:
                break

    def _measure(self) -> None:
        self._look(MEASURE)

    def _look(self, purpose: int) -> None:
        """Launch what samples the state into line 0."""
        if self.plan == "serial":
            self._advance(self.step, 1, purpose)
        else:
            self._inspect(self.step, 0, purpose)

    @abstractmethod
    def _allocate(self, slabs: int) -> WatchedBody:
        """The arrays at the start of the run, for so many slabs of particles."""

    @abstractmethod
    def _true_fields(self) -> Fields:
        """The true errors now."""

    @abstractmethod
    def _field(self, quantity: str) -> np.ndarray:
        """A quantity of the particles and how far it is from the exact one (P, 2), for a plot."""
