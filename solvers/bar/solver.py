"""BarSolver: one bar in memory, ready to be stepped, sampled and looked at."""

from __future__ import annotations

import numpy as np

from solvers import runtime
from solvers.bar import exact
from solvers.bar.state import allocate, farthest, pack, switches
from solvers.bar.step import CRUSHED, ESCAPED, INVERTED, SOUND, advance, measure
from solvers.result import Snapshot
from solvers.samples import ROWS
from solvers.scene import Scene


class BarSolver:
    """Owns the arrays of one run. All calls must come from the thread that started Taichi."""

    def __init__(self, scene: Scene):
        self.scene = scene
        self.threads = 1  # the whole step loop runs in one serial kernel, whatever the scene allows
        self.arch = runtime.start(scene.arch, self.threads)
        self.step = 0
        self._switches = switches(scene)
        self._arrays = allocate(scene)
        self._arrays.samples[:] = np.nan
        self._pack = pack(scene, self._arrays)

    @property
    def time(self) -> float:
        return self.step * self.scene.time_step

    @property
    def bytes(self) -> int:
        """Memory of all arrays."""
        return self._arrays.bytes

    @property
    def sound(self) -> bool:
        """False once a check has found the run gone bad."""
        return self._arrays.verdict[0] == SOUND

    @property
    def longest_advance(self) -> int:
        """Steps that one :meth:`advance` may take before its samples have to be collected."""
        return (ROWS - 1) * self.scene.sample_interval

    def compile(self) -> None:
        """Compile (or load from the cache) the kernels of this scene, without stepping."""
        advance(0, 0, self._pack, self._switches)

    def advance(self, steps: int) -> np.ndarray:
        """Take ``steps`` steps and return the rows of samples (``solvers.samples``) taken on the way.

        A run that goes bad stops where it was noticed; :attr:`sound` and :meth:`reason` tell.
        """
        interval, before = self.scene.sample_interval, self.step
        advance(self.step, steps, self._pack, self._switches)
        self.step += steps
        rows = self.step // interval - before // interval
        if not self.sound:
            self.step = int(self._arrays.verdict[1])
            rows = self.step // interval - before // interval
        return self._arrays.samples[:max(0, rows)].copy()

    def measure(self) -> np.ndarray:
        """Check the state and sample it now: one row."""
        measure(self.step, self._pack, self._switches)
        return self._arrays.samples[:1].copy()

    def reason(self) -> str:
        """Why the run stopped, and what to change, in one sentence."""
        kind, step, p = (int(n) for n in self._arrays.verdict)
        X = self._arrays.material_position[p]
        what = {INVERTED: "turned inside out (its deformation gradient fell to zero or is not a number)",
                CRUSHED: "was crushed to less than a thousandth of its length",
                ESCAPED: f"moved {farthest(self.scene):.3g} m or more from where it began"}[kind]
        return (f"the run went unstable at t = {step * self.scene.time_step:.4g} s: particle {p} "
                f"(X = {X:.4f}) {what}; {self._advice()}")

    def _advice(self) -> str:
        scene = self.scene
        if scene.courant_number > 0.4:
            return f"take shorter steps (cfl {scene.courant_number:.2g} now; 0.3 is stable for most scenes)"
        if not scene.linearity_preserving:
            return "switch linearity preservation on or choose a smaller amplitude"
        return "choose a smaller amplitude or more cells"

    def snapshot(self) -> Snapshot:
        """The particles as they are now, with their true and estimated errors."""
        a, scene, t = self._arrays, self.scene, self.time
        X = a.material_position
        errors = None
        if self._switches.truth:
            before = t - scene.time_step if self.step else 0.0
            true_a = a.acceleration - exact.acceleration(scene, X, before) \
                if self._switches.acceleration and self.step else np.zeros_like(X)
            with np.errstate(over="ignore", invalid="ignore"):  # a run gone bad holds anything
                stretch = a.deformation_gradient - exact.deformation_gradient(scene, X, t)
                errors = np.stack([a.position - X - exact.displacement(scene, X, t),
                                   a.velocity - exact.velocity(scene, X, t), scene.modulus * stretch, true_a],
                                  axis=1)
        estimates = {name: a.estimate[k * len(X):(k + 1) * len(X)].copy()
                     for k, name in enumerate(self._switches.estimators)}
        return Snapshot(step=self.step, time=t, material_position=X, position=a.position.copy(),
                        error=errors, estimate=estimates,
                        last_crossing=a.last_crossing.copy() if self._switches.crossings else None,
                        velocity=a.velocity.copy(), deformation_gradient=a.deformation_gradient.copy())
