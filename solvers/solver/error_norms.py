"""Norms of errors over a run: summaries, the paper's error index and the pointwise distance.

All take series (T,) over the sampled times of a run (``solvers.solver.samples``), mostly RMS norms over particles. A
run that went bad leaves numbers up to the largest there are, and beyond: what they add up to may be no number, which is
None.
"""

import math

import numpy as np

#: What an estimator is judged by, and the norm that each sums over that of the truth (eq 35): an index of 1 is perfect,
#: and so is a distance of 0. An index of 1 can hide an estimate of the right size in the wrong place; a distance, 1
#: where the estimate is no better than silence, cannot.
RATIOS = {"index": "estimate", "distance": "difference"}

#: Around arithmetic with what a run gone bad left.
IGNORE_OVERFLOW = np.errstate(over="ignore", invalid="ignore", divide="ignore")


@IGNORE_OVERFLOW
def summary(series: np.ndarray) -> dict[str, float | None]:
    """Sum up a series.

    Parameters
    ----------
    series : (T,) array

    Returns
    -------
    dict
        ``final``, ``max`` and ``mean`` over the times after the start, in the series' unit; None where there is none.
        The last two pass over what a run that went bad left unrepresentable.
    """
    values = series[1:]
    known = values[np.isfinite(values)]
    if not len(known):
        return {"final": None, "max": None, "mean": None}
    return {"final": finite(values[-1]), "max": float(known.max()), "mean": finite(known.mean())}


def largest(values: np.ndarray) -> float | None:
    """The largest of those that are numbers; None where none is."""
    known = values[np.isfinite(values)]
    return float(known.max()) if len(known) else None


@IGNORE_OVERFLOW
def error_index(norms: np.ndarray, true: np.ndarray, rounding: float = 0.0) -> float | None:
    """The paper's eq 35: the sum over time of norms over that of the true error's norms.

    Parameters
    ----------
    norms : (T,) array
        One of :data:`RATIOS`.
    true : (T,) array, in the same unit
    rounding
        What an error must exceed once to be one (``solvers.solver.rounding``).

    Returns
    -------
    float or None
        None where there was no error but rounding, or nothing is known of it.
    """
    if is_only_rounding(true, rounding):
        return None
    return finite(float(_sum_ratio(np.sum(norms), np.sum(true))))


def is_only_rounding(true: np.ndarray, rounding: float) -> bool:
    """Whether a true error (T,) is known and never exceeds what ``rounding`` may make."""
    return bool(np.isfinite(true).any()) and not (np.isnan(true) | (true > rounding)).any()


class RunningIndex:
    """The error index at each time of a run that goes on."""

    def __init__(self) -> None:
        self._norms = self._true = self._excess = 0.0

    @IGNORE_OVERFLOW
    def extend(self, norms: np.ndarray, true: np.ndarray, rounding: np.ndarray | float = 0.0) -> np.ndarray:
        """The index up to each of these further times (T,), from the norms at them; NaN where there is none, as long as
        no true error has exceeded the ``rounding`` up to its time."""
        sums, true_sums = np.cumsum(norms) + self._norms, np.cumsum(true) + self._true
        self._norms, self._true = float(sums[-1]), float(true_sums[-1])
        excess = np.maximum(self._excess, np.maximum.accumulate(true - rounding))
        self._excess = float(excess[-1])
        return np.where(excess > 0, _sum_ratio(sums, true_sums), np.nan)


def _sum_ratio(sums: np.ndarray, true_sums: np.ndarray) -> np.ndarray:
    return np.where(true_sums > 0, sums / true_sums, np.nan)


def finite(value: float | None) -> float | None:
    """JSON has no NaN: what is not a finite number is None."""
    return None if value is None or not math.isfinite(value) else float(value)
