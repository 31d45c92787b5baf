"""RingSolver: one ring in memory, ready to be stepped, sampled and looked at."""

import time

from solvers import runtime
from solvers.anatomy import Anatomy, Carried
from solvers.launch import Launch
from solvers.remedies import COUPLED, FILTER, FROZEN
from solvers.result import Snapshot
from solvers.ring.anatomy import anatomy, carried
from solvers.ring.body import FARTHEST_MOVE
from solvers.ring.errors import difference, estimated_fields, sizes, true_fields
from solvers.ring.field import field
from solvers.ring.scene import RESONANCE, RingScene
from solvers.ring.state import HOOKS, RingState, WatchedRing, allocate, farthest
from solvers.ring.step import advance, find_margin, freeze, inspect, step_in_slabs
from solvers.solver import MEASURE, REPORT, SOUND, STEP, Solver
from solvers.switches import switches
from solvers.turn import CHECK_EVERY

PARALLEL_FROM = 300_000  # particles from which on two threads beat one: a parallel step has a launch to pay for


class RingSolver(Solver):
    """Owns the arrays of one ring. Two plans: one serial kernel for many steps, or slabs side by side."""

    HOOKS = HOOKS
    scene: RingScene
    _arrays: WatchedRing

    def __init__(self, scene: RingScene):
        super().__init__(scene)
        large = scene.threads > 1 and scene.particles >= PARALLEL_FROM
        self.plan = ("parallel" if large else "serial") if scene.plan == "auto" else scene.plan
        self.threads = scene.threads if self.plan == "parallel" else 1
        self.arch = runtime.start(scene.arch, self.threads)
        begun = time.perf_counter()
        self._switches = switches(scene)
        self._arrays = allocate(scene, self.threads)
        self._pack = RingState(**self._arrays.members())
        self._advance, self._step, self._inspect, self._find_margin = (
            Launch(kernel, self._pack, self._switches) for kernel in (advance, step_in_slabs, inspect, find_margin))
        if self._switches.frozen:
            freeze(self._pack, self._switches)
        self.setup_seconds = time.perf_counter() - begun

    def snapshot(self, differences: bool = False, plotted: str | None = None) -> Snapshot:
        a, on = self._arrays, self._switches
        self._look(REPORT)
        F = a.deformation_gradient.reshape(-1, 2, 2)
        true = true_fields(self.scene, a, self.step, on.acceleration) if on.truth else None
        estimates = {name: estimated_fields(a, k) for k, name in enumerate(on.estimators)}
        missed = {name: difference(fields, true) for name, fields in estimates.items()} if true and differences else {}
        return Snapshot(step=self.step, time=self.time, material_position=a.material_position,
                        position=a.motion[:, :2].copy(), velocity=a.motion[:, 2:].copy(),
                        deformation_gradient=F.copy(), error=sizes(true) if true else None,
                        estimate={name: sizes(fields) for name, fields in estimates.items()},
                        last_crossing=a.last_crossing.copy() if on.crossings else None, difference=missed,
                        plotted=None if plotted is None else field(self.scene, a, plotted, self.time))

    def compile(self) -> None:
        super().compile()
        if self.plan == "parallel":
            self._step(0, 0)
            self._inspect(0, -1, REPORT)

    def _carried(self) -> Carried:
        return carried(self._arrays)

    def _anatomy(self, particle: int, before: Carried) -> Anatomy:
        return anatomy(self.scene, self._arrays, particle, self.step, before)

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

    def _escape(self) -> str:
        return (f"left the ring's place (it is {farthest(self.scene):.3g} m or more from the centre, beyond a plane, "
                f"or {FARTHEST_MOVE:g} amplitudes from where it began)")

    def _other_advice(self) -> str:
        scene = self.scene
        if scene.amplitude >= RESONANCE:
            return (f"from A = {RESONANCE} on the ring's own motion is unstable (parametric resonance) and no remedy "
                    "helps: choose a smaller amplitude or fewer periods")
        if scene.method == "mpm" and not scene.frozen:
            return f"hat functions hold only with the remedy {FROZEN}; or choose CPDI"
        if scene.method != "cpdi" and not scene.remedies:
            return f"call for the remedies {FILTER},{COUPLED}, or choose CPDI"
        return "choose more particles per cell, a smaller amplitude or fewer periods"

