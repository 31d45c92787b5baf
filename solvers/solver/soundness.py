"""Soundness of a run: contradictions within it, which need no exact solution, and its known error.

A run is *unstable* where a particle is inverted, crushed, far away or not finite (``solvers.solver.base`` stops it),
*lost* where its particles no longer represent the motion, though every number is finite. A rule below finds it lost at
a sample; the run continues, because it is instructive. Four rules compare the particles with each other, one with the
motion by the balance of momentum (``solvers.scene.displacement_moments``): it finds errors that are consistent,
such as a ring that turns as a whole or late waves of a free bar. All rules check positions;
``solvers.solver.verdict_basis`` reports which other quantities were checked.
"""

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from solvers.scene import estimator_registry
from solvers.scene.scene import Scene
from solvers.solver.error_series import IGNORE_OVERFLOW, largest_finite_or_none
from solvers.translatable_message import Message

OK, UNSTABLE, LOST = "ok", "unstable", "lost"
BROKEN = (UNSTABLE, LOST)
NOUNS = {"v": Message("velocity"), "sigma": Message("stress"), "a": Message("acceleration")}
LOST_FROM = 0.5  # error of x, in amplitudes of the motion, from which on a run is lost


@dataclass(frozen=True)
class ContradictionRule:
    """Kind of evidence against a run: ``name``, that of a column of the samples, in m, and ``most``, the share of the
    motion's amplitude that no sound run reaches. ``sentence`` explains it; {size} is the share found."""

    name: str
    most: float
    sentence: str


CONTRADICTIONS: dict[str, ContradictionRule] = {rule.name: rule for rule in (
    # D <= 2 rms(e_x) and what F adds, beside what few particles do (``scene.neighbour_mismatch``): derived, not fitted.
    ContradictionRule("neighbour_gap", 0.2, "neighbouring particles are not where their deformation implies (off by "
                      "{size} of the amplitude); do not trust positions or stress"),
    # The forces sum to zero: a strict lower bound of the error.
    ContradictionRule("mean_drift", 0.1, "the body as a whole has moved by {size} of the amplitude though no net force "
                      "acts; its shape may still be right"),
    # Motion around the centre, and differences along a material circle: a strict lower bound of the error.
    ContradictionRule("out_of_shape", 0.1, "the ring is no longer round (by {size} of the amplitude)"),
    # Occurs on fine grids, where neighbours are too close to have large gaps; sound runs reach 0.3.
    ContradictionRule("displacement_mismatch", 0.4, "displacements and deformation contradict each other (off by "
                      "{size} of the amplitude)"),
    # A lower bound of the error, up to the error of the balance itself, a hundredth or less.
    ContradictionRule("balance_gap", LOST_FROM, "the particles are not where the balance of momentum requires (off by "
                      "{size} of the amplitude)"),
)}


@dataclass(frozen=True)
class SoundnessFinding:
    """First sample at which a run is found lost: its ``time`` in s, a ``sentence`` that says why, the ``size`` of what
    is wrong, mostly in amplitudes, and the ``rule`` that found it, a key of :func:`findings`."""

    time: float
    sentence: str
    size: float
    particle: int | None = None  # where it is worst, if known
    rule: str = ""


def findings(scene: Scene, series: Mapping[str, np.ndarray]) -> dict[str, SoundnessFinding]:
    """Returns the first finding of each rule, of the truth and of each judging estimator in the ``series`` of a run
    (:func:`solvers.solver.samples.read_rows`), by their names; those without are left out.

    The truth, where it is on, and the estimators count from an error of half the motion's amplitude on.
    """
    series = {**series, "balance_gap": momentum_balance_distance(scene, series)}
    A, judges = scene.motion_amplitude, [n for n in scene.active_estimators if estimator_registry.ESTIMATORS[n].judges]
    rules = {name: (series[name], rule.most + (scene.neighbour_mismatch if name == "neighbour_gap" else 0.0), A,
                    partial(Message, rule.sentence)) for name, rule in CONTRADICTIONS.items()}
    rules["error_x"] = (series["error_x"], LOST_FROM, A, partial(
        Message, "the particles have lost the solution (the true error of x is {size} of the amplitude)"))
    for name in judges:
        sentence = partial(Message, "the particles have lost the solution ({name} puts the error of x at {size} of "
                           "the amplitude)", name=name)
        rules[name] = (series[f"{name}/estimate_x"], LOST_FROM, A, sentence)
    for quantity, most in scene.loss_limits.items():
        noun, unit = NOUNS[quantity], scene.size_of(quantity)
        rules[f"error_{quantity}"] = (series[f"error_{quantity}"], most, unit, partial(
            Message, "the {noun} is wrong (its true error is {size} of it)", noun=noun))
        for name in judges:
            sentence = partial(Message, "the {noun} is wrong ({name} estimates its error as {size} of it)", noun=noun,
                               name=name)
            rules[f"{name}/{quantity}"] = (series[f"{name}/estimate_{quantity}"], most, unit, sentence)
    return {name: replace(found, rule=name) for name, (values, most, unit, sentence) in rules.items()
            if (found := _first_exceedance(series, values, most, unit, sentence))}


def earliest_finding(found: Mapping[str, SoundnessFinding], not_valid: Collection[str]) -> SoundnessFinding | None:
    """Returns the first of several :func:`findings`, without those of estimators that are ``not_valid``: the run is
    lost from then on. None where nothing was found, which is no proof."""
    return min((finding for name, finding in found.items() if name.partition("/")[0] not in not_valid),
               key=lambda one: one.time, default=None)


def _first_exceedance(series: Mapping[str, np.ndarray], values: np.ndarray, most: float, unit: float,
                      sentence: Callable[..., str]) -> SoundnessFinding | None:
    beyond = np.flatnonzero(values > most * unit)  # never NaN, which stands for what is off
    if not len(beyond):
        return None
    at = int(beyond[0])
    time, size, places = float(series["time"][at]), float(values[at]) / unit, series["place"][:at + 1]
    known = places[np.isfinite(places)]
    return SoundnessFinding(time, sentence(size=f"{size:.2g}"), size, int(known[-1]) if len(known) else None)


@IGNORE_OVERFLOW
def momentum_balance_distance(scene: Scene, series: Mapping[str, np.ndarray]) -> np.ndarray:
    """Returns a lower bound (T,) of the RMS distance, in m, of the particles from the motion by the balance of
    momentum; NaN where it was not evaluated or that motion is unknown."""
    gap, squares = np.full(len(series["time"]), np.nan), series["motion_square"]
    looked = np.flatnonzero(~np.isnan(squares))
    if len(looked):
        known = scene.momentum_balance_moments(series["time"][looked])
        sums = np.stack([series[f"motion_{k}"][looked] for k in range(known.sums.shape[1])], axis=1)
        gap[looked] = known.rms_distance_bound(sums, squares[looked])
    return gap


@IGNORE_OVERFLOW
def evidence(scene: Scene, series: Mapping[str, np.ndarray]) -> dict[str, float | None]:
    """Returns by rule the largest share of the motion's amplitude that its evidence reached, for the JSON object; None
    where it was not evaluated."""
    A, series = scene.motion_amplitude, {**series, "balance_gap": momentum_balance_distance(scene, series)}
    return {name: largest_finite_or_none(series[name] / A) for name in CONTRADICTIONS}
