"""Error budget of a run, from its series: the share of each cause in the error (``solvers.solver.samples``)."""

from collections.abc import Mapping

import numpy as np

from solvers.scene.error_causes import CAUSES, FIELDS
from solvers.solver.error_series import IGNORE_OVERFLOW, finite_or_none
from solvers.translatable_message import Message

#: The largest :func:`cancellation` at which shares are meaningful. In 600 random runs, each with three causes removed
#: in turn (``tests.budget``), the budget predicted the remaining errors of x, v and F to 0.15 of the original error in
#: 97 % of the cases up to 3, in 94 % from 3 to 10, and in 50 % beyond, where it was wrong by many times the error
#: (``assets/budget.md``). 3 is on the safe side: shares of parts that cancel are also hard to interpret.
MOST_CANCELLED = 3.0
ROUND_OFF = 1e-12  # m: an error of x up to this size may be round-off


@IGNORE_OVERFLOW
def shares(series: Mapping[str, np.ndarray], field: str) -> dict[str, float | None]:
    """Returns each cause's share of the error of "x", "v" or "F" (``field``): the sum over samples of mean(e_c e) over
    that of mean(e^2). They add up to 1; a negative share reduces the error. None without error."""
    error = series[f"budget/error_{field}"]
    known = np.isfinite(error)
    total = float(np.sum(error[known] ** 2))
    return {cause: finite_or_none(float(np.sum((series[f"budget/part_{field}_{cause}"] * error)[known])) / total)
            if total > 0 else None for cause in CAUSES}


def has_crossed(series: Mapping[str, np.ndarray], time: float = np.inf) -> bool:
    """Returns whether a particle has changed its cell up to a time in s, by a run's series; True if nobody counted."""
    counts = series.get("crossings")
    return counts is None or not np.interp(time, series["time"], counts) <= 0  # NaN: not counted


@IGNORE_OVERFLOW
def shares_at(series: Mapping[str, np.ndarray], field: str, time: float) -> dict[str, float]:
    """Returns each cause's part of the RMS error of "x", "v" or "F" at a ``time`` in s over that error; {} if the error
    is 0 or not finite there."""
    at = {name: float(np.interp(time, series["time"], series[f"budget/{name}"]))
          for name in (f"error_{field}", *(f"part_{field}_{cause}" for cause in CAUSES))}
    if not at[f"error_{field}"] or not np.isfinite([*at.values()]).all():
        return {}
    return {cause: at[f"part_{field}_{cause}"] / at[f"error_{field}"] for cause in CAUSES}


@IGNORE_OVERFLOW
def final_parts(series: Mapping[str, np.ndarray], field: str) -> dict[str, float | None]:
    """Returns each cause's part of the RMS error of "x" (m), "v" (m/s) or "F" at the end; they add up to it."""
    return {cause: finite_or_none(series[f"budget/part_{field}_{cause}"][-1]) for cause in CAUSES}


@IGNORE_OVERFLOW
def rms_error_over_run(series: Mapping[str, np.ndarray], field: str, without: str | None = None) -> float | None:
    """Returns the RMS over particles and samples of the error of "x" (m), "v" (m/s) or "F"; with ``without`` what the
    budget predicts for a run without that cause: e - e_c, with the mean square e^2 - 2 e_c e + e_c^2."""
    error = series[f"budget/error_{field}"]
    squares = error**2
    if without is not None:
        squares = squares - 2 * series[f"budget/part_{field}_{without}"] * error \
            + series[f"budget/size_{field}_{without}"] ** 2
    return finite_or_none(float(np.sqrt(np.maximum(np.mean(squares), 0.0))))  # rounding may make it slightly negative


@IGNORE_OVERFLOW
def cancellation(series: Mapping[str, np.ndarray], field: str) -> float:
    """Returns the sum of the causes' RMS errors of a field over the run, over its own RMS error: 1 if none cancel."""
    error = np.sqrt(np.mean(series[f"budget/error_{field}"] ** 2))
    causes = sum(np.sqrt(np.mean(series[f"budget/size_{field}_{cause}"] ** 2)) for cause in CAUSES)
    return 0.0 if error == 0 else float(causes / error)


@IGNORE_OVERFLOW
def why_not_valid(series: Mapping[str, np.ndarray]) -> str | None:
    """Returns why shares are meaningless for this run, as a sentence, or None."""
    if np.sqrt(np.mean(series["budget/error_x"] ** 2)) <= ROUND_OFF:
        return Message("not valid here: the error is only round-off and has no cause")
    worst = {field: cancellation(series, field) for field in FIELDS}
    field = max(worst, key=lambda name: worst[name] if np.isfinite(worst[name]) else np.inf)
    if worst[field] <= MOST_CANCELLED:
        return None
    if not np.isfinite(worst[field]):
        return Message("not valid here: the numbers of the run are too large for shares")
    times = f"{worst[field]:,.0f}" if worst[field] >= 10 else f"{worst[field]:.2g}"
    return Message("not valid here: the causes have errors of {field} that cancel and are {times} times as large as "
                   "the total; shares are valid up to {most:g} times", field, times, MOST_CANCELLED)


def summary(series: Mapping[str, np.ndarray], reference: str) -> dict:
    """Returns the budget as in results: shares by field and cause, ``at_end`` the parts of the RMS error at the end,
    ``rms`` the error over the run and ``predicted`` that without each cause, the ``reference`` ("exact" or
    "companion"), and ``not_valid``, a sentence or None."""
    return {**{field: shares(series, field) for field in FIELDS},
            "at_end": {field: final_parts(series, field) for field in FIELDS},
            "rms": {field: rms_error_over_run(series, field) for field in FIELDS},
            "predicted": {field: {cause: rms_error_over_run(series, field, cause) for cause in CAUSES}
                          for field in FIELDS}, "reference": reference, "not_valid": why_not_valid(series)}
