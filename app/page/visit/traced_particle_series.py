"""The trace: one particle's true error, its estimates and its crossings over time."""

import threading
from collections.abc import Sequence

import numpy as np

from app.language.translation import tr
from app.names_and_units import format_coordinates
from app.page.visit.history import MOST_ROWS, RunSeries
from app.page.visit.recent_frames import Frame, RecentFrames
from solvers.engine.engine_messages import FrameReport
from solvers.engine.shared_frames import FrameArrays
from solvers.solver.samples import QUANTITIES


class TracedParticle(RunSeries):
    """Sampled series of one particle, named as those of :class:`NormHistory`, with the sizes of its own errors."""

    def __init__(self, particle: int, frames: Sequence[Frame]):
        report, arrays = frames[-1]
        super().__init__(report.scene.period)
        self.particle, self.scene = particle, report.scene
        self.at_rest = reference_positions(arrays)[particle]  # (D,) in metres
        self._step = -1
        self._crossings: tuple[int, ...] = ()  # steps
        for frame in frames:
            self.add(*frame)

    def add(self, report: FrameReport, arrays: FrameArrays) -> None:
        """Adds a frame's errors, if it is a later one. Of several crossings between frames only the last is known."""
        if report.step <= self._step:
            return
        self._step, p = report.step, self.particle
        new = {"time": np.array([report.time])}
        for q, name in enumerate(QUANTITIES):
            new[f"error_{name}"] = np.abs(arrays.error[p:p + 1, q].astype(float))
            for estimator, estimate in arrays.estimate.items():
                new[f"{estimator}/estimate_{name}"] = np.abs(estimate[p:p + 1, q].astype(float))
        self.append(new)
        since = arrays.steps_since_crossing[p]
        crossed = report.step - int(since) if since >= 0 else -1
        if crossed > max(self._crossings, default=-1):
            self._crossings = (*self._crossings, crossed)[-MOST_ROWS:]

    def crossing_marks(self, times: np.ndarray) -> np.ndarray:
        """Returns whether each of the times (n,), in s, of a series is the first after a crossing, (n,) of bool."""
        crossings = np.array(self._crossings) * self.scene.time_step
        after = np.searchsorted(times, crossings[crossings >= times[0]] - 0.5 * self.scene.time_step)
        marks = np.zeros(len(times), bool)
        marks[after[after < len(times)]] = True
        return marks

    @property
    def title(self) -> str:
        digits = 5 - len(self.at_rest)  # one line of the narrowest panel
        place = format_coordinates(self.at_rest, digits)
        return tr("particle {particle}, X = {place} m", particle=self.particle,
                  place=f"({place})" if len(self.at_rest) > 1 else place)


class ParticleTracer:
    """The particle that one visitor traces (``traced``), or None. Frames come on one thread, choices on any."""

    def __init__(self, recent: RecentFrames):
        self._recent, self._lock = recent, threading.Lock()
        self.traced: TracedParticle | None = None
        self._next: int | None = None  # to be followed in the next run

    def choose(self, particle: int | None, in_next_run: bool = False) -> None:
        """Traces a particle, by its number, from the earliest stored frame or the next run's first; None ends it."""
        with self._lock:
            frames = () if in_next_run else self._recent.frames
            self._next = particle if in_next_run else None
            self.traced = None
            if particle is not None and frames and particle < frames[-1][0].particles:
                self.traced = TracedParticle(particle, frames)

    def on_frame(self, report: FrameReport, arrays: FrameArrays) -> None:
        """Adds the newest frame. In another run, the particle with the nearest initial position is traced."""
        with self._lock:
            if report.fresh and self._next is not None and self._next < report.particles:
                self.traced, self._next = TracedParticle(self._next, [(report, arrays)]), None
                return
            traced = self.traced
            if traced is None:
                return
            if not report.fresh:
                traced.add(report, arrays)
            elif report.scene.problem != traced.scene.problem:
                self.traced = None
            else:
                squares = ((reference_positions(arrays) - traced.at_rest) ** 2).sum(axis=1)
                self.traced = TracedParticle(int(np.argmin(squares)), [(report, arrays)])


def reference_positions(arrays: FrameArrays) -> np.ndarray:
    """Returns the particles' initial positions, (P, D) in m; 0 where unknown."""
    return np.nan_to_num(arrays.position.astype(float) - arrays.displacement)
