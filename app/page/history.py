"""The history of a live run: the sampled norms from its start until now, at a resolution that fits a plot."""

import math

import numpy as np

from app.page.course import Courses
from solvers import samples
from solvers.samples import QUANTITIES
from solvers.scene import Scene

CROSSING_WINDOW = 1 / 20  # of a period, over which crossings per second are counted


class History(Courses):
    """Sampled norms and the running error index of one run. One thread adds, any may read.

    Its series are named as in ``solvers.samples.read``, and up to that time the error index (eq 35) and the pointwise
    distance as ``transport/index_x`` and ``transport/distance_x``.
    """

    def __init__(self, scene: Scene, particles: int):
        super().__init__(scene.period)
        self.scene, self._particles = scene, particles
        self.margin = math.nan  # of the step, as last looked at: few samples do
        self._sums: dict[str, float] = {}

    def add(self, rows: np.ndarray) -> None:
        """Append rows of samples (``solvers.samples``)."""
        if not len(rows):
            return
        scene = self.scene
        new = samples.read(rows, scene.active_estimators, self._particles, scene.time_step)
        for estimator in scene.active_estimators:
            for q in QUANTITIES:
                true = self._running(f"error_{q}", new, key=f"{estimator}/{q}")
                for ratio, norm in (("index", "estimate"), ("distance", "difference")):
                    with np.errstate(divide="ignore", invalid="ignore"):
                        new[f"{estimator}/{ratio}_{q}"] = np.where(
                            true > 0, self._running(f"{estimator}/{norm}_{q}", new) / true, np.nan)
        looked = np.flatnonzero(np.isfinite(new["margin"]))
        self.margin = float(new["margin"][looked[-1]]) if len(looked) else self.margin
        self.append(new)

    def crossings_per_second(self, series: dict[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        """Times and grid crossings per second of simulated time, each over a twentieth of a period or more, from
        :attr:`series` or :attr:`latest`."""
        if len(series.get("time", ())) < 2:
            return np.zeros(0), np.zeros(0)
        time, count = series["time"], series["crossings"]
        spacing = (time[-1] - time[0]) / (len(time) - 1)
        lag = max(1, min(len(time) - 1, round(CROSSING_WINDOW * self.scene.period / spacing)))
        return time[lag:], (count[lag:] - count[:-lag]) / (time[lag:] - time[:-lag])

    def _running(self, name: str, new: dict[str, np.ndarray], key: str | None = None) -> np.ndarray:
        totals = np.cumsum(new[name]) + self._sums.get(key or name, 0.0)
        self._sums[key or name] = float(totals[-1])
        return totals
