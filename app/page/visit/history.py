"""The history of a live run: the sampled norms from its start until now, at a resolution that fits a plot."""

import math
import threading
from collections import defaultdict
from itertools import product

import numpy as np

from app.frame.crossings import WINDOW
from app.page.visit.downsampled import RunSeries
from solvers.scene.scene import Scene
from solvers.scene.step_bound import margin_unit
from solvers.solver import samples
from solvers.solver.norms import RATIOS, RunningIndex
from solvers.solver.rounding import rounding
from solvers.solver.samples import QUANTITIES

MOST_WAITING = 500  # frames' samples that may wait for a reader


class History(RunSeries):
    """Sampled norms and the running error index of one run. One thread adds, any may read.

    Its series are named as in ``solvers.solver.samples.read``, and up to that time the error index (eq 35) and the
    pointwise distance as ``transport/index_x`` and ``transport/distance_x``. Frames come more often than anybody reads,
    and a few samples cost as much work as many: they wait for the next reader.
    """

    def __init__(self, scene: Scene, particles: int):
        super().__init__(scene.period)
        self.scene, self._particles = scene, particles
        self._lock = threading.Lock()
        self._waiting: list[np.ndarray] = []
        self._margin = math.nan
        self._ratios: defaultdict[str, RunningIndex] = defaultdict(RunningIndex)

    def add(self, rows: np.ndarray) -> None:
        """Append rows of samples (``solvers.solver.samples``)."""
        with self._lock:
            if len(rows):
                self._waiting.append(rows)
            many = len(self._waiting) > MOST_WAITING
        if many:
            self._take_in()

    @property
    def margin(self) -> float:
        """Of the step, as last looked at: few samples do."""
        self._take_in()
        return self._margin

    def _take_in(self) -> None:
        with self._lock:
            waiting, self._waiting = self._waiting, []
            if waiting:
                self._extend(np.concatenate(waiting))

    def _extend(self, rows: np.ndarray) -> None:
        scene = self.scene
        new = samples.read(rows, scene, self._particles, margin_unit(scene))
        for estimator, q, (ratio, norm) in product(scene.active_estimators, QUANTITIES, RATIOS.items()):
            name = f"{estimator}/{ratio}_{q}"
            new[name] = self._ratios[name].extend(new[f"{estimator}/{norm}_{q}"], new[f"error_{q}"], rounding(
                scene, q, new["time"] / scene.time_step))
        looked = np.flatnonzero(np.isfinite(new["margin"]))
        self._margin = float(new["margin"][looked[-1]]) if len(looked) else self._margin
        self.append(new)

    def crossings_per_second(self, series: dict[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        """Times and grid crossings per second of simulated time, each over a twentieth of a period or more, from
        :attr:`series` or :attr:`latest`."""
        if len(series.get("time", ())) < 2:
            return np.zeros(0), np.zeros(0)
        time, count = series["time"], series["crossings"]
        spacing = (time[-1] - time[0]) / (len(time) - 1)
        lag = max(1, min(len(time) - 1, round(WINDOW * self.scene.period / spacing)))
        return time[lag:], (count[lag:] - count[:-lag]) / (time[lag:] - time[:-lag])
