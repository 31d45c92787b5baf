"""Order of convergence: the slope of errors over the cell size h, or the reason why no order can be believed.

One rule for sweeps and for files of other codes. Runs whose error is rounding, or a large part of the motion, are left
out of the fit; there is no order where those that remain contradict each other.
"""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from solvers.solver.error_series import IGNORE_OVERFLOW, finite_or_none

STEEPEST = 5.0  # order: no method of particles on a grid converges faster, and what seems to is luck or a broken run
LARGE = 0.3  # of the motion: a run with that error says nothing of the limit h -> 0
SAME = 1e-3  # relative difference of errors, within which h does not matter at all
APART = 1.25  # ratio of cell sizes: of closer grids a slope is mostly noise
CLOSE = 1.7  # ratio of the largest to the smallest, below which that is worth a remark
DISAGREE, DOUBT = 1.0, 0.3  # differences of orders that contradict each other, and that are worth a remark


@dataclass(frozen=True)
class ConvergenceOrder:
    """Fit error = ``factor`` h^``order`` to so many ``points``, or the ``reason`` why there is none, "short: details";
    ``pairwise`` are the orders between neighbouring h. ``remark`` says what makes an order doubtful, and ``left_out``
    has the h in m of errors that are not fitted."""

    order: float | None
    factor: float | None
    points: int
    pairwise: tuple[float, ...]
    reason: str | None = None
    remark: str | None = None
    left_out: tuple[float, ...] = ()

    def at(self, h: np.ndarray) -> np.ndarray:
        """Returns the fitted errors at cell sizes h in m; NaN without an order."""
        return np.full(np.shape(h), np.nan) if self.order is None or self.factor is None else \
            self.factor * np.asarray(h) ** self.order


@IGNORE_OVERFLOW
def fit_order(spacings: Sequence[float], errors: Sequence[float | None], size: float = np.inf,
              rounding: Sequence[float] | float = 0.0) -> ConvergenceOrder | None:
    """Returns the order of errors over cell sizes in m, by least squares of the logarithms; None where fewer than two
    different sizes have a known error. ``size`` is that of the motion and ``rounding`` the error that rounding alone
    may make, one for all or one for each, in the errors' unit."""
    floors = np.broadcast_to(rounding, len(spacings)).tolist()
    known = np.array(sorted((h, error, floor) for h, error, floor in zip(spacings, errors, floors, strict=True)
                            if error is not None and np.isfinite(error))).reshape(-1, 3)
    (h, error, floor), size = known.T, size or np.inf
    if len(np.unique(h)) < 2:
        return None
    pairs = [pair for pair in itertools.pairwise(np.flatnonzero(error > 0)) if h[pair[0]] < h[pair[1]]]
    pairwise = tuple(_slope(h[list(pair)], error[list(pair)]) for pair in pairs)
    kept, remarks = error > floor, list[str]()
    reason = _why_nothing_converges(h[kept], error[kept], floor.max())
    if reason is None and (error > LARGE * size).any():
        broken = _name_broken_runs(h, error, size)
        kept &= error <= LARGE * size
        if len(np.unique(h[kept])) < 3:  # two alone have not shown that they are fine enough
            reason = broken
        remarks.append(f"left out: {broken}")
    reason = reason or _why_grids_contradict(h[kept], error[kept])
    if reason is not None:
        return ConvergenceOrder(None, None, 0, pairwise, reason, None, tuple(h.tolist()))
    if (error <= floor).any():
        remarks.append(f"left out: {np.sum(error <= floor)} of {len(h)} errors are round-off")
    order, intercept = np.polyfit(np.log(h[kept]), np.log(error[kept]), 1)
    return ConvergenceOrder(float(order), finite_or_none(np.exp(intercept)), int(kept.sum()), pairwise, None,
                            "; ".join([*remarks, *_doubts(h[kept], error[kept])]) or None, tuple(h[~kept].tolist()))


def _why_nothing_converges(h: np.ndarray, error: np.ndarray, floor: float) -> str | None:
    """Returns the reason why errors (n,) above rounding, at cell sizes (n,), are no convergence at all; or None."""
    if len(np.unique(h)) < 2:
        return f"round-off: {'one error alone is' if len(h) else 'no error is'} above the {floor:.1e} of rounding"
    if np.ptp(error) <= SAME * error.max():
        return f"the same error on every grid: {error.max():.4g}"
    least = min(_separate_slopes(h, error), key=abs)
    return f"steeper than the method can be: {least:.2f}" if abs(least) > STEEPEST else None


def _name_broken_runs(h: np.ndarray, error: np.ndarray, size: float) -> str:
    """Returns which runs have errors (n,) that are a large part of the motion's ``size``."""
    large = np.flatnonzero(error > LARGE * size)
    if len(large) == len(h):
        return f"all runs are broken: their errors are {100 * error.min() / size:.2g} % of the motion and more"
    which = "the coarse run is" if large[0] == len(h) - 1 else \
        f"the run{'s' * (len(large) > 1)} with h = {', '.join(f'{h[k]:.3g}' for k in large)} m " \
        f"{'are' if len(large) > 1 else 'is'}"
    return f"{which} broken: an error of {100 * error[large].max() / size:.2g} % of the motion"


def _why_grids_contradict(h: np.ndarray, error: np.ndarray) -> str | None:
    """Returns the reason why errors (n,) at cell sizes (n,) are of no common order; None where they are."""
    slopes = _separate_slopes(h, error)
    if min(slopes) < 0 < max(slopes):
        return "not monotone: from one grid to a finer one the error falls and grows"
    every = [*slopes, *_orders_without_one(h, error)]
    if max(every) - min(every) > DISAGREE:
        return f"the grids disagree: {min(every):.2f} to {max(every):.2f}"
    order = _slope(h, error)
    return f"steeper than the method can be: {order:.2f}" if abs(order) > STEEPEST else None


def _doubts(h: np.ndarray, error: np.ndarray) -> list[str]:
    """Returns what makes an order of errors (n,) at cell sizes (n,) doubtful, in words."""
    ratio, others = h[-1] / h[0], _orders_without_one(h, error)
    if ratio < CLOSE:
        return [f"the cell sizes differ by a ratio of {ratio:.3g} only, which makes much of small errors"]
    if len(np.unique(h)) == 2:
        return ["of two grids, so that nothing confirms it"]
    return [f"{min(others):.2f} to {max(others):.2f} without one of the grids"] if np.ptp(others) > DOUBT else []


def _slope(h: np.ndarray, error: np.ndarray) -> float:
    return float(np.polyfit(np.log(h), np.log(error), 1)[0])


def _separate_slopes(h: np.ndarray, error: np.ndarray) -> list[float]:
    """Returns the orders from grid to grid, at increasing sizes h (n,), without those between close ones."""
    at = [0]
    for k in range(1, len(h)):
        if h[k] >= APART * (1 - 1e-9) * h[at[-1]]:
            at.append(k)
    if at[-1] < len(h) - 1:
        at[max(1, len(at) - 1):] = [len(h) - 1]
    return [_slope(h[[a, b]], error[[a, b]]) for a, b in itertools.pairwise(at)]


def _orders_without_one(h: np.ndarray, error: np.ndarray) -> list[float]:
    """Returns the orders of all but one error each, of those that the others can do without."""
    others = [np.delete(np.arange(len(h)), k) for k in range(len(h))]
    return [_slope(h[rest], error[rest]) for rest in others if h[rest].max() >= APART * (1 - 1e-9) * h[rest].min()] \
        or [_slope(h, error)]
