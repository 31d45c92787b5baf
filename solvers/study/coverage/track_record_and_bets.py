"""Stored counts of a thousand runs of each problem, in ``assets/coverage``; and the bets of estimators based on them:
two sizes between which the error at the end of a run should lie in 80 of 100 runs.

An estimator bets by its track record: the multiples of its estimate between which 80 of 100 true errors of the thousand
runs in ``assets/coverage`` were, for its problem and quantity. So the bet contains its usual error, and no more about
the run than its own number. Where it is not valid it does not bet.

The grid convergence index bets by its own definition: 3 times the two-grid estimate of the error contains the truth in
95 of 100 cases. If errors are normal that is 1.96 standard deviations, and their sizes lie between 0.13 and 1.64 of
these in 80 of 100. It bets on every run, as in practice, from the estimate of ``two-grid``, valid or not."""

import functools
import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from statistics import NormalDist
from typing import Any

from solvers.running.quantities_of_interest import DISPLACEMENT, SAFETY
from solvers.scene.scene import Scene
from solvers.solver.soundness import OK
from solvers.study.coverage.estimate_coverage_counts import CENTRAL, FACTORS, NORMAL, TWO_GRIDS, motion_regime
from solvers.study.coverage.random_runs import (
    FORCES,
    QUANTITIES,
    allow_refused_estimators,
    draw_ranges_of,
    refusal_kind,
)
from solvers.translatable_message import Message

FOLDER = Path(__file__).parents[3] / "assets" / "coverage"
FEWEST = 20  # runs: no statement for fewer
GCI, RICHARDSON = "GCI", "two-grid"
ESTIMATORS = ("companion", "recovered", RICHARDSON, "transport")
JUDGES = (*ESTIMATORS, GCI)
LEVEL = CENTRAL
ALWAYS_DEFAULT = ("remedies", "motion", "displacement", "law", "take_away")  # fields that every random run leaves alone
EFFECTS = ("truth", "estimate", "soundness")
Ends = tuple[float, float]


@functools.cache
def load_counts(problem: str) -> Mapping[str, Any] | None:
    """Returns a problem's stored counts (:func:`~solvers.study.coverage.estimate_coverage_counts.tally`), or None."""
    path = FOLDER / f"{problem}.json"
    return json.loads(path.read_text(encoding="utf-8")) if path.exists() else None


@dataclass(frozen=True)
class RunSoFar:
    """A run as random runs are compared with it: its ``scene``, its ``status`` ("ok") and the ``time`` in s it has
    reached."""

    scene: Scene
    status: str
    time: float

    @property
    def why_not_counted(self) -> Message | str:
        """Why no counted random run is like this one, as part of a sentence; "" if some are."""
        scene = self.scene
        if self.status != OK:
            return Message("only runs that end as ok were counted")
        if load_counts(scene.problem) is None:
            return Message("no runs of this problem were drawn")
        for name in ALWAYS_DEFAULT:
            if getattr(scene, name, None) != getattr(type(scene), name, None):
                return Message("no runs with {name} were drawn", Message(name.replace("_", "-")))
        if scene.body_force not in FORCES.get(scene.problem, ("material",)):
            return Message("no runs with the body force {force} were drawn", scene.body_force)
        ranges = draw_ranges_of(scene.problem)
        numbers = ((Message("cells"), scene.cells, ranges.cells),
                   (Message("particles per cell"), scene.ppc, ranges.ppc),
                   (Message("as amplitude"), scene.amplitude, ranges.amplitude),
                   (Message("periods"), self.time / scene.period, ranges.periods))
        return next((Message("runs were drawn with {least:g} to {most:g} {name}, and this one has {value:.3g}",
                             least=ends[0], most=ends[1], name=name, value=value)
                     for name, value, ends in numbers if not ends[0] <= value <= ends[1]), "")


def accurate_run_counts(run: RunSoFar, estimator: str, quantity: str = "x") -> tuple[int, int] | None:
    """Returns (n, all): in n of ``all`` random runs like a run the estimate of a quantity ("x") was within a factor of
    1.1 of the true error; None if there were too few."""
    split = _counts_of_similar_runs(run, "estimators", estimator)
    found = split and split.get(quantity)
    return (found["within"][f"{FACTORS[0]:g}"], found["runs"]) if found and found["runs"] >= FEWEST else None


def central_ratios(problem: str, estimator: str, quantity: str) -> tuple[float, float] | None:
    """Returns the two ratios of estimated to true error, at the end of a run, between which 80 of 100 random runs of a
    problem were; None if there were too few, or a tenth of the estimates were zero."""
    known = load_counts(problem)
    found = known and known["estimators"].get(estimator, {}).get("all", {}).get(quantity, {}).get("at the end")
    if not found or found["runs"] < FEWEST or not found["middle"][0] > 0:
        return None
    low, high = found["middle"]
    return low, high


def bars_held(run: RunSoFar, goal: str, estimator: str) -> tuple[int, int] | None:
    """Returns (n, all): in n of ``all`` random runs like a run the interval of twice the estimated error around a goal
    (by its name) contained the truth; None if there were too few."""
    split = _counts_of_similar_runs(run, "goals", DISPLACEMENT if goal.startswith(DISPLACEMENT) else goal)
    found = split and split.get(f"{SAFETY:g} x {estimator}")
    return (found["held"], found["runs"]) if found and found["runs"] >= FEWEST else None


def _counts_of_similar_runs(run: RunSoFar, group: str, name: str) -> Mapping[str, Any] | None:
    """Returns counts of random runs with a run's method and regime of motion, of a ``group`` ("estimators" or "goals")
    and a name in it; None where no random run was like it."""
    scene, known = run.scene, load_counts(run.scene.problem)
    if known is None or name not in known[group] or run.why_not_counted:
        return None
    methods = known[group][name]["method and regime"]
    return methods.get(scene.method, {}).get(motion_regime(scene.motion_amplitude / scene.spacing, scene.ppc))


def bets(scene: Scene) -> dict[str, dict[str, Ends | None]]:
    """Runs a scene with all estimators; returns by quantity (x in m, v in m/s, sigma in Pa) and estimator the ends of
    the bet on the RMS error over the particles at the end of the run; None for no bet."""
    from solvers.running.run import run  # here: what a judge is called can be known without Taichi

    asked = replace(scene, estimators=scene.choices("estimators"), effects=EFFECTS)
    result = run(allow_refused_estimators(asked), mid_run=False, prices=False)

    def positive_estimate(name: str, quantity: str) -> float | None:
        """Returns an estimator's final estimate, refused or not; None if it is not positive and finite."""
        series = result.series.get(f"{name}/estimate_{quantity}")
        found = math.nan if series is None else float(series[-1])
        return found if math.isfinite(found) and found > 0 else None

    valid = [name for name in asked.estimators if not refusal_kind(name, asked, result)]
    found: dict[str, dict[str, Ends | None]] = {}
    for q in QUANTITIES:
        by_record = {name: bet_by_record(scene.problem, name, q, positive_estimate(name, q)) if name in valid else None
                     for name in ESTIMATORS}
        found[q] = {**by_record, GCI: bet_by_grid_index(positive_estimate(RICHARDSON, q))}
    return found


def bet_by_record(problem: str, estimator: str, quantity: str, estimate: float | None) -> Ends | None:
    """Returns the bet (low, high) on the true error by an estimate, in its unit; None without estimate or record."""
    ratios = central_ratios(problem, estimator, quantity)
    return None if estimate is None or ratios is None else (estimate / ratios[1], estimate / ratios[0])


def bet_by_grid_index(estimate: float | None) -> Ends | None:
    """Returns the bet (low, high) on the true error by the two-grid ``estimate``, in its unit, if errors are normal and
    the index is 1.96 deviations; None for None."""
    if estimate is None:
        return None
    deviation = TWO_GRIDS * estimate / NORMAL
    # The sizes of normal errors have the quantile q where the errors themselves have (1 + q)/2.
    low, high = (NormalDist().inv_cdf((1 + q) / 2) for q in ((1 - LEVEL) / 2, (1 + LEVEL) / 2))
    return low * deviation, high * deviation
