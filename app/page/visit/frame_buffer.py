"""The last frames of the present run, for whoever looks back once it has paused."""

import threading
from collections import deque
from dataclasses import replace

import numpy as np

from solvers.engine.engine_messages import FrameReport
from solvers.engine.shared_frames import FrameArrays

MOST_FRAMES = 200
FEW_BYTES = 4000  # of samples, that a frame may keep: to make a report without them takes time
MOST_BYTES = 48_000_000  # of one visitor: a large scene is remembered for less long

Frame = tuple[FrameReport, FrameArrays]


class FrameBuffer:
    """Frames and which of them is shown: ``back`` frames before the newest. One thread adds, any may look."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._frames: deque[Frame] = deque()
        self._bytes = self.back = 0
        self._wanted: float | None = None  # the time in s to show as soon as the run stands still

    def add(self, report: FrameReport, arrays: FrameArrays) -> None:
        """Take in the run's newest frame, and show it if the run has moved; a fresh one begins another run."""
        if report.rows.nbytes > FEW_BYTES:
            report = replace(report, rows=report.rows[:0].copy())  # the history has them
        with self._lock:
            if report.fresh:
                self._frames.clear()
                self._bytes = 0
            elif self._frames and self._frames[-1][0].step == report.step:  # asked for anew, to hold something else
                self._bytes -= frame_bytes(self._frames.pop()[1])
            else:
                self.back = 0
            self._frames.append((report, arrays))
            self._bytes += frame_bytes(arrays)
            while len(self._frames) > MOST_FRAMES or (self._bytes > MOST_BYTES and len(self._frames) > 1):
                self._bytes -= frame_bytes(self._frames.popleft()[1])
            self.back = 0 if report.playing else min(self.back, len(self._frames) - 1)
            if self._wanted is not None and not report.playing:
                self.back, self._wanted = self._back_to(self._wanted), None

    def go_back(self, count: int) -> None:
        """Show the frame so many before the newest, as long as the run stands still."""
        with self._lock:
            if self._frames and not self._frames[-1][0].playing:
                self.back = max(0, min(count, len(self._frames) - 1))

    def seek(self, time: float) -> bool:
        """Show the frame nearest to a time in s; while the run moves, as soon as it stands still. Whether it does."""
        with self._lock:
            if still := bool(self._frames) and not self._frames[-1][0].playing:
                self.back = self._back_to(time)
            else:
                self._wanted = time
            return still

    @property
    def span(self) -> tuple[float, float]:
        """The times in s of the oldest and of the newest frame."""
        with self._lock:
            return (self._frames[0][0].time, self._frames[-1][0].time) if self._frames else (0.0, 0.0)

    @property
    def frames(self) -> list[Frame]:
        """All of them, the oldest first."""
        with self._lock:
            return list(self._frames)

    @property
    def shown(self) -> Frame | None:
        """The frame to draw, standing still if it is an earlier one; None before the first."""
        with self._lock:
            if not self._frames:
                return None
            report, arrays = self._frames[-1 - self.back]
            return (replace(report, playing=False) if self.back else report), arrays

    @property
    def ago(self) -> float:
        """How many periods before the newest frame the one that is shown is."""
        return self._periods(self.back)

    @property
    def reach(self) -> tuple[int, float]:
        """How far back one can go, in frames and in periods."""
        most = max(0, len(self._frames) - 1)
        return most, self._periods(most)

    def _back_to(self, time: float) -> int:
        """How many frames before the newest one the nearest to a time is."""
        apart = [abs(report.time - time) for report, _ in self._frames]
        return len(apart) - 1 - int(np.argmin(apart))

    def _periods(self, back: int) -> float:
        with self._lock:
            if not 0 < back < len(self._frames):
                return 0.0
            newest, earlier = self._frames[-1][0], self._frames[-1 - back][0]
            return (newest.time - earlier.time) / newest.scene.period


def frame_bytes(arrays: FrameArrays) -> int:
    """Bytes of a frame's particles."""
    held = (arrays.position, arrays.displacement, arrays.deformation_gradient, arrays.steps_since_crossing,
            arrays.error, *arrays.estimate.values(), *arrays.difference.values(), arrays.plotted)
    return sum([array.nbytes for array in held])
