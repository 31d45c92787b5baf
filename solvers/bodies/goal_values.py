"""Values of goals in a body's run, each with its bar.

With the value J of the particles and J_p, J_(p+2) of the companions at the same particles the bar is
|J - J_(p+2)| + |J_(p+2) - J_p|, for stresses twice that. The first term alone would hold in about half of all runs. The
second is more than the finer companion's own error wherever that is at most half of the coarser one's: of the
difference it is up to 0.7 at fronts, right angles of clamped and free sides.
"""

from typing import NamedTuple

import numpy as np

from solvers.bodies.goal import Goal
from solvers.running.quantities_of_interest import point_weights

STRESS_SAFETY = 2.0  # factor of a stress's bar
COLUMNS = {"x": 0, "y": 1, "xx": 4, "xy": 5, "yy": 7}  # of u, v and stress side by side
EARLY = 0.75  # of the run, in which what later returns must have turned round


class GoalValue(NamedTuple):
    """Value of a goal in its ``unit`` and half the width of its bar; None where there is none."""

    value: float | None
    bar: float | None
    unit: str


def goal_weights(goal: Goal, X: np.ndarray) -> np.ndarray:
    """Returns the weights (P,) of values at particles, at material points X (P, 2) in m, in that at the goal's
    point: of its position interpolated, of a stress that of the nearest particle."""
    at = np.array(goal.at, float)
    if not goal.is_stress:
        return point_weights(X, at)
    weights = np.zeros(len(X))
    weights[np.argmin(np.sum((X - at)**2, axis=1))] = 1.0
    return weights


class GoalSeries:
    """Values over time of what a goal is about, in the run and in both companions, with ``weights`` (M,) of particles'
    values (:func:`goal_weights`)."""

    def __init__(self, goal: Goal, weights: np.ndarray):
        self.goal, self._weights, self._column = goal, weights, COLUMNS[goal.parts[1]]
        self._start = 0.0 if goal.is_stress else float(goal.at[self._column])
        self._rows = [np.full(3, self._start)]

    def add(self, fields: np.ndarray) -> None:
        """Adds a sample: u, v and Cauchy stress xx, xy, yx, yy at the particles (3, M, 8), of the run, of the coarser
        and of the finer companion."""
        self._rows.append(self._start + fields[:, :, self._column] @ self._weights)

    def evaluate(self, times: np.ndarray, known: int) -> GoalValue:
        """Returns the goal's value at the samples' ``times`` in s; and its bar if the ``known`` first samples, in which
        the companions are to be believed, are all or contain what decides it and one more."""
        series = np.array(self._rows).T
        found = [self._functional(times[:last], one[:last])
                 for one, last in zip(series, (len(times), known, known), strict=True)]
        (run, _), (coarse, _), (fine, _) = found
        bar = None
        if run is not None and fine is not None and coarse is not None and (
                known == len(times) or max(at for _, at in found) + 1 < known):
            bar = self._bar(run, coarse, fine)
        return GoalValue(run, bar, self.goal.unit)

    def companion_value(self, times: np.ndarray) -> float | None:
        """Returns the finer companion's value of the goal at the samples' ``times`` in s."""
        return self._functional(times, np.array(self._rows)[:, 2])[0]

    def last_value_and_bar(self, has_bar: bool) -> tuple[float, float | None]:
        """Returns at the last sample the coordinate in m or the stress in Pa that the goal is about, and its bar."""
        run, coarse, fine = self._rows[-1].tolist()
        return run, self._bar(run, coarse, fine) if has_bar else None

    def _bar(self, run: float, coarse: float, fine: float) -> float:
        return (STRESS_SAFETY if self.goal.is_stress else 1.0) * (abs(run - fine) + abs(fine - coarse))

    def _functional(self, times: np.ndarray, series: np.ndarray) -> tuple[float | None, int]:
        """Returns the value, None where there is none, and the sample that decides it."""
        what = self.goal.parts[0]
        if not np.isfinite(series).all():
            return None, 0
        if what == "end":
            return float(series[-1]), len(series) - 1
        if what == "time of return":
            back = _sample_of_return(series)
            return (_vertex(times, series, back)[1] if back else None), back
        size = np.abs(series) if self.goal.is_stress else -series if what == "min" else series
        at = int(np.argmax(size))
        return (float(size[at]) if self.goal.is_stress else _vertex(times, series, at)[0]), at


def _sample_of_return(series: np.ndarray) -> int:
    """Returns in which sample the motion is at its extreme again after its farthest excursion; 0 if not by the end."""
    away = series - series[0]
    turn = int(np.argmax(np.abs(away[:int(EARLY * len(away))])))
    back = turn + int(np.argmin(np.sign(away[turn]) * away[turn:]))
    return 0 if back in (turn, len(series) - 1) else back


def _vertex(times: np.ndarray, series: np.ndarray, k: int) -> tuple[float, float]:
    """Returns the extreme near sample ``k`` and its time in s, of the parabola through it and its neighbours."""
    if not 0 < k < len(series) - 1:
        return float(series[k]), float(times[k])
    a, b, c = series[k - 1:k + 2]
    curvature = a - 2 * b + c
    s = float(np.clip(0.5 * (a - c) / curvature, -1, 1)) if curvature else 0.0
    return float(b - 0.25 * (a - c) * s), float(times[k] + s * (times[k + 1] - times[k]))
