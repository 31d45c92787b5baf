"""One session inside an engine: a solver, a clock that says how far it should be, and its frames."""

from __future__ import annotations

from multiprocessing.shared_memory import SharedMemory
from time import perf_counter

import numpy as np

from solvers.engine import memory
from solvers.engine.messages import FrameReport, Wish
from solvers.run import build
from solvers.scene import MOST_STEPS

SLICE_SECONDS = 0.008  # one turn of one session: short, because a launch cannot be interrupted
FRAME_SECONDS = 1 / 30
LAG_SECONDS = 0.1  # further behind than this, the clock gives up the arrears: the session is capped
SPEED_WINDOW = 1.0  # seconds over which the real speed is measured
EXPECTED_RATE = 3e7  # particle-steps per second, before the first measurement
LAST_STEP = MOST_STEPS - 1_000_000_000  # a page left open for days stops here


class Stepper:
    """Steps a session's solver towards its wish, a slice at a time. Lives in the engine's one thread."""

    def __init__(self, wish: Wish):
        self._block: SharedMemory | None = None
        self._unseen = False
        self.wish: Wish | None = None
        self.accept(wish)

    def accept(self, wish: Wish) -> None:
        """Take over a newer wish; rebuild if it is another scene or a restart."""
        old, self.wish = self.wish, wish
        if self._block is None or self._block.name != wish.memory:
            self.close()
            self._block = SharedMemory(wish.memory)
        if old is None or old.scene != wish.scene or old.restarts != wish.restarts:
            self._rebuild()
        elif wish.single_steps > old.single_steps and not wish.playing:
            self._single_steps(wish.single_steps - old.single_steps)
        self._start_clock()
        self._frame_wanted = True

    def close(self) -> None:
        if self._block is not None:
            self._block.close()
            self._block = None

    def seen(self) -> None:
        """The page has copied the last frame."""
        self._unseen = False

    @property
    def behind(self) -> bool:
        """Whether the solver is behind the time that its clock shows."""
        return self._running and self._target(perf_counter()) >= self.solver.time + self.solver.scene.time_step

    @property
    def next_due(self) -> float:
        """When the session next has something to do, by ``perf_counter``."""
        if self._unseen:
            return float("inf")
        if self._frame_wanted:
            return 0.0
        return self._last_frame + FRAME_SECONDS if self._running else float("inf")

    def turn(self) -> None:
        """Step for at most one slice towards the clock's time."""
        now = perf_counter()
        arrears = self._target(now) - self.solver.time
        wanted = int(arrears / self.solver.scene.time_step)
        fits = max(1, int(SLICE_SECONDS / self._seconds_a_step))
        self._advance(max(1, min(wanted, fits, self.solver.longest_advance)))
        if arrears > LAG_SECONDS * self.wish.speed and wanted > fits:
            self._anchor = (now, self.solver.time)

    def frame(self) -> FrameReport:
        """Write the particles into the block and report. Call when ``next_due`` has come."""
        now, solver = perf_counter(), self.solver
        memory.write(self._block, solver.scene, solver.snapshot())
        self._measure_speed(now)
        report = FrameReport(
            session=self.wish.session, number=self.wish.number, scene=solver.scene, fresh=self._fresh,
            playing=self._running, step=solver.step, time=solver.time, rows=np.concatenate(self._rows),
            reason=None if solver.sound else solver.reason(), rate=self._rate, real_speed=self._real_speed,
            arch=solver.arch)
        self._rows = [report.rows[:0]]
        self._fresh, self._frame_wanted, self._unseen, self._last_frame = False, False, True, now
        return report

    # ---- inside -------------------------------------------------------------------------------------------

    @property
    def _running(self) -> bool:
        return self.wish.playing and self.solver.sound and self.solver.step < LAST_STEP

    def _rebuild(self) -> None:
        self.solver = build(self.wish.scene)
        self.solver.compile()
        self._rows = [self.solver.measure()]
        self._fresh, self._last_frame = True, 0.0
        self._rate, self._real_speed = 0.0, None
        self._seconds_a_step = self.wish.scene.particles / EXPECTED_RATE

    def _start_clock(self) -> None:
        self._anchor = self._window = (perf_counter(), self.solver.time)

    def _target(self, now: float) -> float:
        wall, simulated = self._anchor
        return simulated + (now - wall) * self.wish.speed

    def _single_steps(self, steps: int) -> None:
        if self.solver.sound:
            self._advance(min(steps, self.solver.longest_advance))

    def _advance(self, steps: int) -> None:
        begun = perf_counter()
        self._rows.append(self.solver.advance(steps))
        took = max(perf_counter() - begun, 1e-7)
        self._seconds_a_step = took / steps
        self._rate = 1e-6 * steps * self.solver.scene.particles / took
        self._frame_wanted |= not self.solver.sound  # the last frame says why

    def _measure_speed(self, now: float) -> None:
        wall, simulated = self._window
        if now - wall > 0.2:
            self._real_speed = (self.solver.time - simulated) / (now - wall)
        if now - wall > SPEED_WINDOW:
            self._window = (now, self.solver.time)
