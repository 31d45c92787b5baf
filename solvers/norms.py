"""Norms of errors over a run: summaries, the paper's error index, the pointwise distance, and the drift of the energy.

All take series over the sampled times of a run (``solvers.samples``), mostly RMS norms over particles.
"""

import math
from collections.abc import Mapping

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


def distance(difference: np.ndarray, true: np.ndarray) -> float | None:
    """Sum over time of ||estimate - truth|| over that of ||truth||. 0 is perfect, 1 no better than silence.

    An index of 1 can hide an estimate of the right size in the wrong place; this cannot.
    """
    return _ratio(difference, true)


def energy_drift(series: Mapping[str, np.ndarray]) -> float | None:
    """(E - W - E0)/E0 at the end, E kinetic plus strain energy, W the body force's work; None where it is unknown."""
    total = series["kinetic"] + series["strain"]
    drift = float(total[-1] - series["work"][-1] - total[0]) / float(total[0]) if total[0] > 0 else math.nan
    return drift if math.isfinite(drift) else None


def _ratio(above: np.ndarray, below: np.ndarray) -> float | None:
    total = float(np.sum(below))
    ratio = float(np.sum(above)) / total if total > 0 else math.nan
    return ratio if math.isfinite(ratio) else None
