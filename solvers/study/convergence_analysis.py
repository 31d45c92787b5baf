"""Analysis of rows: series of rows that differ in one input, their order of convergence, the Pareto front, and the
balance of time and space error."""

import itertools
import json
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass

import numpy as np

from solvers.scene.estimator_registry import COMPANION
from solvers.solver.error_series import IGNORE_OVERFLOW
from solvers.solver.rounding import largest_rounding_error
from solvers.solver.samples import QUANTITIES
from solvers.solver.soundness import OK
from solvers.study.convergence_order import ConvergenceOrder, fit_order
from solvers.study.parameter_grid import Task

WIDEST = 1e12  # ratio of errors in one study, beyond which they are incomparable
TIME_INPUTS = ("dt", "cfl")
STEEP = 1.5  # times the growth of second order, beyond which a step is at the brink of stability


def pareto(seconds: Sequence[float], error: Sequence[float]) -> list[int]:
    """Returns the indices of the points that no other beats in both ``seconds`` and ``error``, sorted by time."""
    by_time = sorted(range(len(seconds)), key=lambda k: (seconds[k], error[k]))
    best_before = itertools.accumulate((error[k] for k in by_time), min, initial=np.inf)
    return [k for k, best in zip(by_time, best_before, strict=False) if error[k] < best]


@dataclass(frozen=True)
class SpaceTimeErrorFit:
    """Fit error = ``space`` + ``factor`` dt^``power`` over time steps from ``least`` to ``most`` (s); ``dt`` (s) is
    where both parts are equal, None if not within these; ``misfit`` is the RMS of the relative residual."""

    space: float
    factor: float
    power: int
    least: float
    most: float
    misfit: float

    def at(self, dt: np.ndarray) -> np.ndarray:
        return self.space + self.factor * np.asarray(dt) ** self.power

    @property
    def dt(self) -> float | None:
        if not self.space > 0 or not self.factor > 0:
            return None
        dt = (self.space / self.factor) ** (1 / self.power)
        return dt if self.least <= dt <= self.most else None

    @property
    def space_dominates(self) -> bool:
        """Whether the space error is the larger part at the longest step."""
        return self.space > self.factor * self.most**self.power


@IGNORE_OVERFLOW
def fit_space_time(steps: Sequence[float], errors: Sequence[float]) -> SpaceTimeErrorFit | None:
    """Splits the error at one h into the part of the step, of first or second order, and the rest for dt -> 0.

    Relative residuals are minimised, so small errors count too. Steps from which the error grows faster than such a
    power, at the brink of instability, are ignored. None with under three different steps, or errors too far apart.
    """
    dt, error = _positive_pairs(steps, errors)
    steep = error[1:] > STEEP * error[:-1] * (dt[1:] / dt[:-1]) ** 2
    sound = int(np.argmax(steep)) + 1 if steep.any() else len(dt)
    dt, error = dt[:sound], error[:sound]
    if len(np.unique(dt)) < 3 or not error.max() / error.min() < WIDEST:
        return None
    return min((_fit_split(dt, error, power) for power in (1, 2)), key=lambda fit: fit.misfit)


def _fit_split(dt: np.ndarray, error: np.ndarray, power: int) -> SpaceTimeErrorFit:
    unit = float(error.max())
    columns = np.stack([np.ones_like(dt), dt**power], axis=1) / (error / unit)[:, None]
    space, factor = _nonnegative_least_squares(columns)
    misfit = float(np.sqrt(np.mean((columns @ (space, factor) - 1) ** 2)))
    return SpaceTimeErrorFit(space * unit, factor * unit, power, float(dt[0]), float(dt[-1]), misfit)


def _nonnegative_least_squares(columns: np.ndarray) -> tuple[float, float]:
    """Returns the least-squares solution of columns @ (a, b) = 1 with a, b >= 0: both, or the better of one alone."""
    ones = np.ones(len(columns))
    scale = np.linalg.norm(columns, axis=0)
    a, b = np.linalg.lstsq(columns / scale, ones, rcond=None)[0] / scale
    if a >= 0 and b >= 0:
        return float(a), float(b)
    alone = [float(column @ ones / (column @ column)) for column in columns.T]
    rest = [float(np.sum((column * value - 1) ** 2)) for column, value in zip(columns.T, alone, strict=True)]
    return (alone[0], 0.0) if rest[0] <= rest[1] else (0.0, alone[1])


def _positive_pairs(x: Sequence[float], y: Sequence[float]) -> tuple[np.ndarray, np.ndarray]:
    """Returns the pairs of finite positive numbers as arrays x (n,) and y (n,), sorted by x."""
    pairs = np.array(sorted((a, b) for a, b in zip(x, y, strict=True)
                            if a and b and np.isfinite(a) and np.isfinite(b) and a > 0 and b > 0)).reshape(-1, 2)
    return pairs[:, 0], pairs[:, 1]


@dataclass(frozen=True)
class SingleInputSeries:
    """Series of ``rows`` of a study that differ in one input, sorted by it; ``inputs`` has the values of the others."""

    rows: tuple[dict, ...]
    inputs: dict

    @property
    def method(self) -> str:
        return self.rows[0]["scene"]["method"]

    @property
    def variant(self) -> tuple:
        """Inputs as (name, value) that distinguish the series from others of the same method."""
        return tuple((name, value) for name, value in self.inputs.items() if name != "method")

    @property
    def corrected_by(self) -> str:
        """Estimator whose estimates are subtracted, "" for none."""
        return self.rows[0].get("corrected_by", "")

    def label(self, names: dict[str, str] | None = None) -> str:
        """Returns the inputs as text, such as "mpm, A 0.1"; ``names`` maps methods to full names."""
        method = (names or {}).get(self.method, self.method)
        words = {"amplitude": "A", "modulus": "E"}
        corrected = [f"corrected by {self.corrected_by}"] if self.corrected_by else []
        return ", ".join([method, *(f"{words.get(name, name.replace('_', ' '))} {_format_value(value)}"
                                    for name, value in self.variant), *corrected])

    def fit(self, quantity: str, norm: str = "max") -> ConvergenceOrder | None:
        """Returns the order in h of a quantity's true error (x, v or sigma), over the rows with status "ok"."""
        rows = [row for row in self.rows if row["status"] == OK]
        scenes = [Task(row["problem"], row["asked"]).scene() for row in rows]
        return fit_order([row["h"] for row in rows], [error_of(row, quantity, norm) for row in rows],
                         max((scene.size_of(quantity) for scene in scenes), default=np.inf),
                         [float(largest_rounding_error(scene, quantity, row["steps"]))
                          for scene, row in zip(scenes, rows, strict=True)])


def error_of(row: dict, quantity: str, norm: str = "max") -> float | None:
    """Returns the max, mean or final RMS error of x, v or sigma (SI units) in a row; None if unknown."""
    return ((row.get("error") or {}).get(quantity) or {}).get(norm)


def corrected_rows(rows: Iterable[dict]) -> list[dict]:
    """Returns rows of the results minus their estimates, one for each run that stood and estimator that corrects it,
    named in ``corrected_by``: with the error that is left, and as ``min`` the seconds of the bare run and the estimator
    together. Without the companion's: no MPM is left in them."""
    found = []
    for row in rows:
        prices = (row.get("seconds") or {}).get("estimators") or {}
        for name, left in (row.get("corrected") or {}).items():
            if row["status"] == OK and name in prices and name != COMPANION:
                seconds = {**row["seconds"], "min": row["seconds"]["min"] + prices[name]}
                found.append({**row, "error": left, "estimate": {}, "index": {}, "budget": None, "rate": None,
                              "reason": None, "seconds": seconds, "corrected_by": name})
    return found


def completed_rows(rows: Iterable[dict]) -> list[dict]:
    """Returns the rows of runs that have been measured, without refused and failed ones."""
    return [row for row in rows if row.get("seconds")]


def varying_inputs(rows: Sequence[dict]) -> list[str]:
    """Returns the names of inputs, as requested by the user, that differ between rows."""
    names = dict.fromkeys(name for row in rows for name in row["asked"])
    return [name for name in names if len({json.dumps(row["asked"].get(name)) for row in rows}) > 1]


def group_series(rows: Sequence[dict], along: str = "cells") -> list[SingleInputSeries]:
    """Returns the measured rows as series along the input ``along``. For ``dt``, steps given as cfl count too."""
    rows = completed_rows(rows)
    ignored = TIME_INPUTS if along in TIME_INPUTS else (along,)
    others = [name for name in varying_inputs(rows) if name not in ignored]
    lines: dict[str, list[dict]] = {}
    for row in rows:
        same = [row["asked"].get(name) for name in others]
        lines.setdefault(json.dumps([*same, row.get("corrected_by")]), []).append(row)
    return [SingleInputSeries(tuple(sorted(line, key=lambda row: row["scene"][along])),
                              {name: line[0]["asked"].get(name) for name in others}) for line in lines.values()]


def fit_orders(rows: Sequence[dict]) -> list[dict]:
    """Returns a dict per series with several h: method, inputs, and :class:`ConvergenceOrder` dicts by quantity."""
    found = []
    for line in group_series(rows):
        orders = {quantity: line.fit(quantity) for quantity in QUANTITIES}
        if any(orders.values()):
            found.append({"method": line.method, **line.inputs, "norm": "max",
                          "orders": {quantity: fit and asdict(fit) for quantity, fit in orders.items()}})
    return found


def _format_value(value: object) -> str:
    if isinstance(value, bool):
        return "on" if value else "off"
    if isinstance(value, (list, tuple)):
        return " ".join(value) or "none"
    return "default" if value is None else f"{value:g}" if isinstance(value, float) else str(value)
