"""Fields known at some times: their rates, their values at earlier times, and fits of other fields."""

from collections.abc import Sequence

import numpy as np

GROUPS = 10  # of times, each left out once to see how sure a number is


def rms(values: np.ndarray) -> float:
    """Returns the root mean square of all numbers."""
    return float(np.sqrt(np.mean(values**2)))


def time_derivative(times: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Returns the rate (T, ...) of values (T, ...) at the times (T,), at least three, to second order."""
    return np.gradient(values, times, axis=0, edge_order=2)


def interpolate_before(times: np.ndarray, values: np.ndarray, late: float) -> tuple[np.ndarray, np.ndarray]:
    """Returns which of the times (T,) are known ``late`` s before (a mask), and the values (n, ...) then, from those
    (T, ...) at the times, by Hermite polynomials."""
    before = times - late
    slack = 1e-9 * float(np.ptp(times))
    inside = (before >= times[0] - slack) & (before <= times[-1] + slack)
    at = np.clip(np.searchsorted(times, before[inside], side="right") - 1, 0, len(times) - 2)
    step = times[at + 1] - times[at]
    shape = (-1,) + (1,) * (values.ndim - 1)
    s, H = ((before[inside] - times[at]) / step).reshape(shape), step.reshape(shape)
    slopes = time_derivative(times, values)
    return inside, ((1 + 2 * s) * (1 - s) ** 2 * values[at] + s * (1 - s) ** 2 * H * slopes[at]
                    + s * s * (3 - 2 * s) * values[at + 1] - s * s * (1 - s) * H * slopes[at + 1])


def jackknife_least_squares(target: np.ndarray, parts: Sequence[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Returns the coefficients (1 + n, parts) of the parts (T, ...) in the target (T, ...), by least squares: first for
    all times, then with each of n groups of times left out; and their standard errors (parts,) by the jackknife."""
    def products(one: np.ndarray, other: np.ndarray) -> np.ndarray:
        return (one * other).reshape(len(one), -1).sum(axis=1)

    scale = [rms(part) or 1.0 for part in parts]
    scaled = [part / size for part, size in zip(parts, scale, strict=True)]
    matrix = np.array([[products(one, other) for other in scaled] for one in scaled])
    right, T = np.array([products(one, target) for one in scaled]), len(target)

    if not (np.isfinite(matrix).all() and np.isfinite(right).all()):
        return np.full((2, len(parts)), np.nan), np.full(len(parts), np.nan)

    def solve(kept: np.ndarray) -> np.ndarray:
        return np.linalg.lstsq(matrix[:, :, kept].sum(axis=2), right[:, kept].sum(axis=1), rcond=1e-12)[0]

    every = np.arange(T)
    left_out = [solve(np.setdiff1d(every, group)) for group in np.array_split(every, min(T, GROUPS))]
    found = np.array([solve(every), *left_out]) / np.array(scale)
    return found, np.array([jackknife_error(column) for column in found.T])


def cross_validation_error(target: np.ndarray, parts: Sequence[np.ndarray], found: np.ndarray) -> float:
    """Returns the RMS of what the coefficients ``found`` by :func:`jackknife_least_squares` miss of the target, in each
    group of times by those that were found without it."""
    groups = np.array_split(np.arange(len(target)), len(found) - 1)
    return rms(np.concatenate([target[at] - sum(share * part[at] for share, part in zip(shares, parts, strict=True))
                               for at, shares in zip(groups, found[1:], strict=True)]))


def jackknife_error(estimates: np.ndarray) -> float:
    """Returns the standard error of a number, whose first estimate uses all groups of data and each other omits one."""
    others = estimates[1:]
    return float(np.sqrt((len(others) - 1) / len(others) * np.sum((others - others.mean()) ** 2)))
