"""The last frames of the present run, for looking back while it is paused."""

import threading
from collections import deque
from dataclasses import replace

import numpy as np

from solvers.engine.engine_messages import FrameReport
from solvers.engine.shared_frames import FrameArrays

MOST_FRAMES = 200
FEW_BYTES = 4000  # of samples that stay in a frame: copying a report without them takes time
MOST_BYTES = 48_000_000  # per visitor: large scenes have fewer frames

Frame = tuple[FrameReport, FrameArrays]


class RecentFrames:
    """A run's last frames, at most 200; the one shown is ``back`` before the newest. One thread adds, any may read."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._frames: deque[Frame] = deque()
        self._bytes = self.back = 0
        self._target_time: float | None = None  # the time in s to show as soon as the run stands still

    def add(self, report: FrameReport, arrays: FrameArrays) -> None:
        """Stores the run's newest frame and shows it if the run has moved; a ``fresh`` one replaces all before it."""
        if report.rows.nbytes > FEW_BYTES:
            report = replace(report, rows=report.rows[:0].copy())  # the history has them
        with self._lock:
            if report.fresh:
                self._frames.clear()
                self._bytes = 0
            elif self._frames and self._frames[-1][0].step == report.step:  # requested again with other content
                self._bytes -= frame_bytes(self._frames.pop()[1])
            else:
                self.back = 0
            self._frames.append((report, arrays))
            self._bytes += frame_bytes(arrays)
            while len(self._frames) > MOST_FRAMES or (self._bytes > MOST_BYTES and len(self._frames) > 1):
                self._bytes -= frame_bytes(self._frames.popleft()[1])
            self.back = 0 if report.playing else min(self.back, len(self._frames) - 1)
            if self._target_time is not None and not report.playing:
                self.back, self._target_time = self._frames_back_to(self._target_time), None

    def go_back(self, count: int) -> None:
        """Shows the frame ``count`` frames before the newest, if the run is paused."""
        with self._lock:
            if self._frames and not self._frames[-1][0].playing:
                self.back = max(0, min(count, len(self._frames) - 1))

    def seek(self, time: float) -> bool:
        """Shows the frame nearest to a time in s; while the run plays, does so when it pauses, and returns False."""
        with self._lock:
            if still := bool(self._frames) and not self._frames[-1][0].playing:
                self.back = self._frames_back_to(time)
            else:
                self._target_time = time
            return still

    @property
    def span(self) -> tuple[float, float]:
        """The times in s of the oldest and the newest frame; (0, 0) without frames."""
        with self._lock:
            return (self._frames[0][0].time, self._frames[-1][0].time) if self._frames else (0.0, 0.0)

    @property
    def frames(self) -> list[Frame]:
        """All stored frames, the oldest first."""
        with self._lock:
            return list(self._frames)

    @property
    def shown_frame(self) -> Frame | None:
        """The frame to draw, marked as paused if it is an earlier one; None before the first."""
        with self._lock:
            if not self._frames:
                return None
            report, arrays = self._frames[-1 - self.back]
            return (replace(report, playing=False) if self.back else report), arrays

    @property
    def periods_back(self) -> float:
        """The time from the frame shown to the newest one, in periods."""
        return self._periods(self.back)

    @property
    def stored_frames_and_periods(self) -> tuple[int, float]:
        """How many frames before the newest are stored, and the time that they span in periods."""
        most = max(0, len(self._frames) - 1)
        return most, self._periods(most)

    def _frames_back_to(self, time: float) -> int:
        """Returns the number of frames from the one nearest to a time in s to the newest."""
        apart = [abs(report.time - time) for report, _ in self._frames]
        return len(apart) - 1 - int(np.argmin(apart))

    def _periods(self, back: int) -> float:
        with self._lock:
            if not 0 < back < len(self._frames):
                return 0.0
            newest, earlier = self._frames[-1][0], self._frames[-1 - back][0]
            return (newest.time - earlier.time) / newest.scene.period


def frame_bytes(arrays: FrameArrays) -> int:
    """Returns the size of a frame's arrays in bytes."""
    held = (arrays.position, arrays.displacement, arrays.deformation_gradient, arrays.steps_since_crossing,
            arrays.error, *arrays.estimate.values(), *arrays.difference.values(), arrays.plotted)
    return sum([array.nbytes for array in held])
