"""Fields that are known at some times, between these: their rates, and how they were a little earlier."""

from __future__ import annotations

import numpy as np


def rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values**2)))


def rate(times: np.ndarray, values: np.ndarray) -> np.ndarray:
    """The rate (T, ...) of values (T, ...) at the times (T,), of second order; three times at least."""
    return np.gradient(values, times, axis=0, edge_order=2)


def shifted(times: np.ndarray, values: np.ndarray, late: float) -> tuple[np.ndarray, np.ndarray]:
    """Which of the times (T,) are known a time ``late`` before, and the values (n, ...) there, by cubic Hermite
    polynomials."""
    before = times - late
    slack = 1e-9 * float(np.ptp(times))
    inside = (before >= times[0] - slack) & (before <= times[-1] + slack)
    at = np.clip(np.searchsorted(times, before[inside], side="right") - 1, 0, len(times) - 2)
    step = times[at + 1] - times[at]
    shape = (-1,) + (1,) * (values.ndim - 1)
    s, H = ((before[inside] - times[at]) / step).reshape(shape), step.reshape(shape)
    slopes = rate(times, values)
    return inside, ((1 + 2 * s) * (1 - s) ** 2 * values[at] + s * (1 - s) ** 2 * H * slopes[at]
                    + s * s * (3 - 2 * s) * values[at + 1] - s * s * (1 - s) * H * slopes[at + 1])
