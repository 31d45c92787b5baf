"""The two plans of a plane body on a processor: one serial kernel for many steps, or slabs side by side."""

from solvers.kernels.launch import Launch
from solvers.problems.planar.plans.step import Kernels
from solvers.problems.planar.state import WatchedBody
from solvers.scene.scene import Scene
from solvers.scene.switches import Switches
from solvers.solver.base import REPORT, SOUND, STEP
from solvers.solver.loop import CHECK_EVERY


class OnProcessor:
    """Steps the arrays as they are, on so many ``threads``; on one with the serial kernel unless ``parallel``."""

    def __init__(self, kernels: Kernels, scene: Scene, arrays: WatchedBody, on: Switches, parallel: bool, threads: int):
        self.pack = pack = kernels.state(**arrays.members())
        self._scene, self._arrays, self._parallel, self._threads = scene, arrays, parallel, threads
        self._advance, self._step, self._inspect, self.find_margin = (
            Launch(kernel, pack, on)
            for kernel in (kernels.advance, kernels.step_in_slabs, kernels.inspect, kernels.find_margin))
        if on.frozen:
            kernels.freeze(pack, on)

    def compile(self) -> None:
        """Compile what steps and samples, without stepping."""
        self.run(0, 0)
        if self._parallel:
            self._step(0, 0)
            self._inspect(0, -1, REPORT)

    def run(self, before: int, steps: int) -> None:
        """Take steps after ``before`` of them, or until a check finds the run gone bad."""
        if not self._parallel:
            self._advance(before, steps, STEP)
            return
        interval, row = self._scene.sample_interval, 0
        for step in range(before, before + steps):
            self._step(step, self._threads)
            sampled = (step + 1) % interval == 0
            if sampled or (step + 1) % CHECK_EVERY == 0:
                self._inspect(step + 1, row if sampled else -1, STEP)
                row += sampled
            if self._arrays.verdict[0] != SOUND:
                break

    def look(self, step: int, purpose: int) -> None:
        """Sample the state, after ``step`` steps, into line 0, or only bring the estimates up to date."""
        if self._parallel:
            self._inspect(step, 0, purpose)
        else:
            self._advance(step, 1, purpose)

    def fetch(self) -> None:
        """The arrays are what they are."""

    def upload(self) -> None:
        """The arrays are what they are."""
