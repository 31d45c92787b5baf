"""What every problem's solver shares: stepping, sampling and saying why a run stopped."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import ClassVar

import numpy as np

from solvers.result import Snapshot
from solvers.samples import ROWS
from solvers.scene import Scene

SOUND, INVERTED, CRUSHED, ESCAPED = 0, 1, 2, 3  # the first number of a verdict
SAFE_CFL = 0.4  # up to which the length of the step is hardly to blame


class Solver(ABC):
    """Owns the arrays of one run. All calls must come from the thread that started Taichi.

    A problem's solver sets ``_arrays`` (with ``samples``, ``verdict``, ``material_position`` and ``bytes``), ``arch``
    and ``threads``, and supplies the kernels.
    """

    plan: ClassVar[str] = "serial"

    def __init__(self, scene: Scene):
        self.scene = scene
        self.step = 0
        self.arch = ""
        self.threads = 1

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
        self._run(0)

    def advance(self, steps: int) -> np.ndarray:
        """Take ``steps`` steps and return the rows of samples (``solvers.samples``) taken on the way.

        A run that goes bad stops where it was noticed; :attr:`sound` and :meth:`reason` tell.
        """
        interval, before = self.scene.sample_interval, self.step
        self._run(steps)
        self.step = self.step + steps if self.sound else int(self._arrays.verdict[1])
        rows = self.step // interval - before // interval
        return self._arrays.samples[:max(0, rows)].copy()

    def measure(self) -> np.ndarray:
        """Check the state and sample it now: one row."""
        self._measure()
        return self._arrays.samples[:1].copy()

    def reason(self) -> str:
        """Why the run stopped, and what to change, in one sentence."""
        kind, step, p = (int(n) for n in self._arrays.verdict)
        place = ", ".join(f"{x:.4f}" for x in np.atleast_1d(self._arrays.material_position[p]))
        what = {INVERTED: "turned inside out (its deformation gradient fell to zero or is not a number)",
                CRUSHED: "was crushed to less than a thousandth of its size",
                ESCAPED: self._escape()}[kind]
        cfl = self.scene.courant_number
        advice = f"take shorter steps (cfl {cfl:.2g} now; 0.3 is stable for most scenes)" if cfl > SAFE_CFL \
            else self._advice()
        return (f"the run went unstable at t = {step * self.scene.time_step:.4g} s: particle {p} "
                f"(X = {place}) {what}; {advice}")

    @abstractmethod
    def snapshot(self) -> Snapshot:
        """The particles as they are now, with their true and estimated errors."""

    @abstractmethod
    def _run(self, steps: int) -> None:
        """Launch the kernels for ``steps`` steps from ``self.step``."""

    @abstractmethod
    def _measure(self) -> None:
        """Launch the kernel that checks the state and samples it into row 0."""

    @abstractmethod
    def _escape(self) -> str:
        """What a particle did that is where it cannot be."""

    @abstractmethod
    def _advice(self) -> str:
        """What to change when the step is short enough."""
