"""Norms of errors over a run: summaries, the paper's error index and the pointwise distance.

All take series of RMS norms over particles, one entry a sampled time.
"""

from __future__ import annotations

import math

import numpy as np


def summary(series: np.ndarray) -> dict[str, float | None]:
    """Final, largest and mean value over the sampled times after the start; None where there is none.

    What a run that went bad left unrepresentable is passed over in the largest and the mean.
    """
    values = series[1:]
    known = values[np.isfinite(values)]
    if not len(known):
        return {"final": None, "max": None, "mean": None}
    return {"final": float(values[-1]) if np.isfinite(values[-1]) else None,
            "max": float(known.max()), "mean": float(known.mean())}


def error_index(estimated: np.ndarray, true: np.ndarray) -> float | None:
    """The paper's eq 35: the sum over time of estimated norms over that of true norms. 1 is perfect."""
    return _ratio(estimated, true)


def distance(apart: np.ndarray, true: np.ndarray) -> float | None:
    """Sum over time of ||estimate - truth|| over that of ||truth||. 0 is perfect, 1 no better than silence.

    An index of 1 can hide an estimate of the right size in the wrong place; this cannot.
    """
    return _ratio(apart, true)


def _ratio(above: np.ndarray, below: np.ndarray) -> float | None:
    total = float(np.sum(below))
    ratio = float(np.sum(above)) / total if total > 0 else math.nan
    return ratio if math.isfinite(ratio) else None
