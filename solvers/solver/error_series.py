"""Norms of errors over a run: summaries, the paper's error index and the pointwise distance.

All take series (T,) over the sampled times of a run (``solvers.solver.samples``), mostly RMS norms over particles. An
unstable run leaves numbers up to the largest floats and beyond, whose sums may not be finite: the result is None.
"""

import math

import numpy as np

#: Measures of an estimator, each with the norm that it divides by that of the true error (eq 35). Perfect are an index
#: of 1 and a distance of 0. An index of 1 can hide an estimate of the right size in the wrong place; a distance cannot:
#: it is 1 where the estimate is no better than zero.
RATIOS = {"index": "estimate", "distance": "difference"}

#: Context for arithmetic with the numbers of an unstable run.
IGNORE_OVERFLOW = np.errstate(over="ignore", invalid="ignore", divide="ignore")


@IGNORE_OVERFLOW
def summary(series: np.ndarray) -> dict[str, float | None]:
    """Returns ``final``, ``max`` and ``mean`` of a series (T,) over the times after the start, in its unit, None where
    there is none; the last two ignore what is not finite in an unstable run."""
    values = series[1:]
    known = values[np.isfinite(values)]
    if not len(known):
        return {"final": None, "max": None, "mean": None}
    return {"final": finite_or_none(values[-1]), "max": float(known.max()), "mean": finite_or_none(known.mean())}


def largest_finite_or_none(values: np.ndarray) -> float | None:
    """Returns the largest finite value of an array; None if there is none."""
    known = values[np.isfinite(values)]
    return float(known.max()) if len(known) else None


@IGNORE_OVERFLOW
def error_index(norms: np.ndarray, true: np.ndarray, rounding: float = 0.0) -> float | None:
    """Returns the ratio of eq 35: the sum over time of ``norms`` (T,), of an estimate or of its difference from the
    truth (:data:`RATIOS`), over that of the ``true`` error's norms (T,), in the same unit. None where the true error is
    unknown or never exceeds ``rounding``, in that unit (``solvers.solver.rounding``)."""
    if is_only_rounding(true, rounding):
        return None
    return finite_or_none(float(_sum_ratio(np.sum(norms), np.sum(true))))


def is_only_rounding(true: np.ndarray, rounding: float) -> bool:
    """Returns whether a true error (T,) is known and never exceeds ``rounding``, both in the same unit."""
    return bool(np.isfinite(true).any()) and not (np.isnan(true) | (true > rounding)).any()


class RunningEffectivityIndex:
    """Effectivity index at each time of a run in progress."""

    def __init__(self) -> None:
        self._norms = self._true = self._excess = 0.0

    @IGNORE_OVERFLOW
    def extend(self, norms: np.ndarray, true: np.ndarray, rounding: np.ndarray | float = 0.0) -> np.ndarray:
        """Returns the index at each of these further times (T,), from the norms at them of the estimate and of the
        ``true`` error; NaN as long as no true error has exceeded the ``rounding`` at its time."""
        sums, true_sums = np.cumsum(norms) + self._norms, np.cumsum(true) + self._true
        self._norms, self._true = float(sums[-1]), float(true_sums[-1])
        excess = np.maximum(self._excess, np.maximum.accumulate(true - rounding))
        self._excess = float(excess[-1])
        return np.where(excess > 0, _sum_ratio(sums, true_sums), np.nan)


def _sum_ratio(sums: np.ndarray, true_sums: np.ndarray) -> np.ndarray:
    return np.where(true_sums > 0, sums / true_sums, np.nan)


def finite_or_none(value: float | None) -> float | None:
    """Returns the value, or None where it is not finite, because JSON has no NaN."""
    return None if value is None or not math.isfinite(value) else float(value)
