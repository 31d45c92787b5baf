"""The history of a live run: the sampled norms from its start until now, at a resolution that fits a plot."""

import math
import threading
from collections import defaultdict
from collections.abc import Mapping
from itertools import product

import numpy as np

from solvers.scene.scene import Scene
from solvers.scene.step_bound import gershgorin_to_linear_factor
from solvers.solver import samples
from solvers.solver.error_series import RATIOS, RunningEffectivityIndex
from solvers.solver.rounding import largest_rounding_error
from solvers.solver.samples import QUANTITIES

MOST_ROWS = 800  # then every other row is dropped: a long run keeps its whole course, more coarsely
LAST_PERIODS = 2  # that plots show on request: fine enough however long the run
WINDOW = 1 / 20  # of a period, over which crossings are counted
ROOM = 2 * MOST_ROWS  # rows of a table, copied when it is full, not with every frame


class DownsampledSeries:
    """Series thinned to 800 rows, perhaps of the ``last`` seconds only. One thread adds, any may read them."""

    def __init__(self, last: float = math.inf):
        self._last, self._row_count, self._stride = last, 0, 1
        #: A table (names, rows) and which of its rows count. Replaced at once, and rows that count are never written
        #: again, so that a plot always has series of equal length.
        self._names: tuple[str, ...] = ()
        self._table = (np.empty((0, 0)), 0, 0)

    @property
    def series(self) -> dict[str, np.ndarray]:
        """The arrays (n,) by name, all of one length; {} before the first row."""
        table, start, end = self._table
        return dict(zip(self._names, table[:, start:end], strict=False))  # names may come before the first table

    def add(self, new: Mapping[str, np.ndarray]) -> None:
        """Appends rows: arrays (n,) by name, ``time`` in s among them, with the same names every time."""
        kept = slice(-self._row_count % self._stride, None, self._stride)  # row 0, stride, 2 stride, ... of the run
        self._row_count += len(new["time"])
        rows = np.array([values[kept] for values in new.values()])
        if not rows.shape[1]:
            return
        table, start, end = self._table if self._names else (np.empty((len(new), 0)), 0, 0)
        self._names = tuple(new)
        if end + rows.shape[1] > table.shape[1]:
            table, start, end = _with_room(table[:, start:end], rows.shape[1])
        table[:, end:end + rows.shape[1]] = rows
        end += rows.shape[1]
        time = table[self._names.index("time"), start:end]
        start += int(np.searchsorted(time, time[-1] - self._last))
        while end - start > MOST_ROWS:
            table, start, end = _with_room(table[:, start:end:2], 0)
            self._stride *= 2
        self._table = table, start, end


class RunSeries:
    """Sampled series of one run, kept twice: over its whole time, and over its last periods, finer for long runs."""

    scene: Scene

    def __init__(self, period: float):
        self._whole, self._latest = DownsampledSeries(), DownsampledSeries(LAST_PERIODS * period)

    @property
    def series(self) -> dict[str, np.ndarray]:
        self._append_pending_rows()
        return self._whole.series

    @property
    def latest_periods_series(self) -> dict[str, np.ndarray]:
        """The arrays (n,) by name over the run's last two periods."""
        self._append_pending_rows()
        return self._latest.series

    def append(self, new: Mapping[str, np.ndarray]) -> None:
        """Appends rows, given as for :meth:`DownsampledSeries.add`, to both."""
        self._whole.add(new)
        self._latest.add(new)

    def _append_pending_rows(self) -> None:
        """Appends rows that were stored until somebody reads the series, if the class stores any."""

    def crossings_per_second(self, series: dict[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        """Returns times (n,) in s and grid crossings per s of simulated time (n,), as means over a twentieth of a
        period or more, from ``series`` with ``time`` and ``crossings``."""
        if len(series.get("time", ())) < 2:
            return np.zeros(0), np.zeros(0)
        time, count = series["time"], series["crossings"]
        spacing = (time[-1] - time[0]) / (len(time) - 1)
        lag = max(1, min(len(time) - 1, round(WINDOW * self.scene.period / spacing)))
        return time[lag:], (count[lag:] - count[:-lag]) / (time[lag:] - time[:-lag])


def _with_room(values: np.ndarray, more: int) -> tuple[np.ndarray, int, int]:
    """Copies a table (names, rows) into one with space for ``more`` rows; returns it, its first row and its end row."""
    names, rows = values.shape
    table = np.empty((names, max(ROOM, rows + more)))
    table[:, :rows] = values
    return table, 0, rows


def series_until(series: dict[str, np.ndarray], time: float) -> dict[str, np.ndarray]:
    """Returns the part of sampled series up to a time in s, at least one row if there is any."""
    times = series.get("time", np.zeros(0))
    if not len(times) or times[-1] <= time:
        return series
    return {name: values[:max(1, int(np.searchsorted(times, time, "right")))] for name, values in series.items()}


def last_value(series: Mapping[str, np.ndarray], name: str) -> float:
    """Returns the last value of the series of this name; NaN if there is none."""
    values = series.get(name, np.zeros(0))
    return float(values[-1]) if len(values) else math.nan


MOST_WAITING = 500  # frames' samples that may wait for a reader


class NormHistory(RunSeries):
    """Error norms and running error index of one run over time. One thread adds, any may read.

    Series are named as by ``solvers.solver.samples.read_rows``, and ``transport/index_x`` (error index so far, eq 35)
    and ``transport/distance_x`` (pointwise) for each estimator and quantity. Frames come more often than they are read,
    and few samples cost as much work as many, so they wait for the next reader."""

    def __init__(self, scene: Scene, particles: int):
        super().__init__(scene.period)
        self.scene, self._particles = scene, particles
        self._lock = threading.Lock()
        self._waiting: list[np.ndarray] = []
        self._margin = math.nan
        self._ratios: defaultdict[str, RunningEffectivityIndex] = defaultdict(RunningEffectivityIndex)

    def add(self, rows: np.ndarray) -> None:
        """Stores rows of samples (n, columns), as in ``FrameReport.rows``."""
        with self._lock:
            if len(rows):
                self._waiting.append(rows)
            many = len(self._waiting) > MOST_WAITING
        if many:
            self._append_pending_rows()

    @property
    def step_to_bound_ratio(self) -> float:
        """The time step over its stability bound in the last sample that has it; NaN before the first."""
        self._append_pending_rows()
        return self._margin

    def _append_pending_rows(self) -> None:
        with self._lock:
            waiting, self._waiting = self._waiting, []
            if waiting:
                self._extend(np.concatenate(waiting))

    def _extend(self, rows: np.ndarray) -> None:
        scene = self.scene
        new = samples.read_rows(rows, scene, self._particles, gershgorin_to_linear_factor(scene))
        rounding = {q: largest_rounding_error(scene, q, new["time"] / scene.time_step) for q in QUANTITIES}
        for estimator, q, (ratio, norm) in product(scene.active_estimators, QUANTITIES, RATIOS.items()):
            name = f"{estimator}/{ratio}_{q}"
            new[name] = self._ratios[name].extend(new[f"{estimator}/{norm}_{q}"], new[f"error_{q}"], rounding[q])
        looked = np.flatnonzero(np.isfinite(new["margin"]))
        self._margin = float(new["margin"][looked[-1]]) if len(looked) else self._margin
        self.append(new)
