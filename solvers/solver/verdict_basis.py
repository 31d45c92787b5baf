"""Basis of a run's verdict: which quantities were checked, and which have errors as large as themselves.

A verdict is about positions (``solvers.solver.soundness``). Velocity, stress and acceleration can have errors as large
as themselves while positions are right: this is reported where the truth or a judging estimator shows it; where neither
is available, that is reported too.
"""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace

import numpy as np

from solvers.scene import estimator_registry
from solvers.scene.scene import Scene
from solvers.solver.error_series import IGNORE_OVERFLOW, largest_finite_or_none
from solvers.solver.samples import QUANTITIES
from solvers.solver.soundness import NOUNS, momentum_balance_distance
from solvers.translatable_message import Message, join_messages

LARGE_ERROR = 1.0  # an error, as RMS over particles, over the quantity's own RMS over particles and a period
POSITIONS_HOLD = Message("positions are ok, but ")
LONG_SAMPLE_INTERVAL = 0.2  # periods from one sample to the next, beyond which errors come and go unseen


@dataclass(frozen=True)
class LargeRelativeError:
    """Error of a quantity that has been as large as the quantity itself: ``since`` when in s, ``size`` the largest
    error so far over the quantity's own RMS (``scene.rms_of``), and its source ``by``, "truth" or an estimator."""

    since: float
    size: float
    by: str


@IGNORE_OVERFLOW
def large_errors(scene: Scene, series: Mapping[str, np.ndarray],
                 not_valid: Collection[str] = ()) -> dict[str, LargeRelativeError]:
    """Returns, by quantity, errors of v, sigma and a that were once as large as the quantity itself in a ``series`` of
    samples, by the truth where it is on, else by a judging estimator that is not one of those ``not_valid``."""
    judges, found = _judging_estimators(scene, not_valid), {}
    for quantity in NOUNS:
        unit = scene.rms_of(quantity)
        known = [("truth", f"error_{quantity}")] if scene.has("truth") else \
            [(name, f"{name}/estimate_{quantity}") for name in judges]
        for who, name in known:
            beyond = np.flatnonzero(series[name] > LARGE_ERROR * unit)
            if len(beyond):
                size = largest_finite_or_none(series[name]) or np.inf
                found[quantity] = LargeRelativeError(float(series["time"][beyond[0]]), size / unit, who)
                break
    return found


def _judging_estimators(scene: Scene, not_valid: Collection[str]) -> list[str]:
    return [name for name in scene.active_estimators
            if estimator_registry.ESTIMATORS[name].judges and name not in not_valid]


def merge_large_errors(before: Mapping[str, LargeRelativeError],
                       now: Mapping[str, LargeRelativeError]) -> dict[str, LargeRelativeError]:
    """Returns, by quantity, the :func:`large_errors` of earlier and later samples as if all were judged together."""
    return {**now, **{quantity: replace(one, size=max(one.size, now[quantity].size if quantity in now else 0.0))
                      for quantity, one in before.items()}}


def large_error_warning(scene: Scene, errors: Mapping[str, LargeRelativeError]) -> str | None:
    """Returns a sentence about :func:`large_errors` in a run of a scene that is ok for positions, and about its step if
    that is too long; None without such errors."""
    parts = [Message("the {quantity} is off by up to {size:.2g} times its own size, from t = {since:.4g} s on",
                     NOUNS[quantity], one.size, one.since)
             + Message(" (according to {by})", one.by) * (one.by != "truth") for quantity, one in errors.items()]
    if parts and scene.time_step > scene.step_bound:
        parts.append(Message("the time step is {times:.2g} times the longest stable one (linear theory)",
                             scene.time_step / scene.step_bound))
    return POSITIONS_HOLD + join_messages("; ", parts) if parts else None


def checks_by_quantity(scene: Scene, not_valid: Collection[str], balance: bool) -> dict[str, list[str]]:
    """Returns what each of x, v, sigma and a was checked against: "truth", judging estimators that hold, and for x
    "contradictions" and the ``balance`` of momentum, if it was :func:`is_balance_motion_known`."""
    held = {q: ["truth"] * scene.has("truth") + _judging_estimators(scene, not_valid) for q in QUANTITIES}
    if not scene.has("acceleration"):
        held["a"] = []
    if scene.has("soundness"):
        held["x"] += ["contradictions"] + ["balance"] * balance
    return held


def missing_checks_sentence(scene: Scene, checks: Mapping[str, list[str]]) -> str | None:
    """Returns which of the ``checks`` (:func:`checks_by_quantity`) are missing, in one sentence; None if none is."""
    if not checks["x"]:
        return Message("only two checks were made: numbers stay finite, and no particle turns inside out; switch on "
                       "the effect soundness or truth, or the estimator companion")
    parts = []
    if checks["x"] == ["contradictions"]:
        parts.append(Message("positions were compared only with each other, not with the reduced model, which could "
                             "not be computed to the end"))
    alone = [NOUNS[q] for q in ("v", "sigma", "a") if not checks[q] and (q != "a" or scene.has("acceleration"))]
    if alone:
        parts.append(Message("{alone} were not checked: switch on the effect truth or the estimator companion",
                             join_messages(" and ", filter(None, (join_messages(", ", alone[:-1]), alone[-1])))))
    apart = min(scene.sample_interval, scene.steps) * scene.time_step / scene.period
    if apart > LONG_SAMPLE_INTERVAL and scene.sample_interval > 1:
        parts.append(Message("nothing was checked between two samples, {apart:.2g} periods apart: give a smaller "
                             "--sample-every", apart))
    return join_messages("; ", parts) or None


def is_balance_motion_known(scene: Scene, series: Mapping[str, np.ndarray]) -> bool:
    """Returns whether the motion by the balance of momentum was known at the last check for contradictions in a run."""
    looked = np.flatnonzero(~np.isnan(series["motion_square"]))[-1:]
    last = {name: series[name][looked] for name in series if name == "time" or name.startswith("motion_")}
    return bool(np.isfinite(momentum_balance_distance(scene, last)).any())
