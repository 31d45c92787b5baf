"""Error budget of a scene, and the effect of removing one cause: as predicted, and in a second run."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from solvers.problems import PROBLEMS
from solvers.problems.descriptor import BudgetProvider
from solvers.running.result import Result
from solvers.running.run import run
from solvers.scene.error_causes import CAUSES, FIELDS, NOTHING
from solvers.solver import budget_shares
from solvers.solver.soundness import LOST
from solvers.translatable_message import Message

SCHEMA = "mpm-lab/budget/1"

Progress = Callable[[float], None]


@dataclass(frozen=True)
class CauseRemovalResult:
    """A run's ``result`` with its budget, and that of running ``again`` without ``cause``, or "nothing" and None."""

    result: Result
    cause: str
    again: Result | None

    def take_away(self) -> dict | None:
        """Returns the RMS over particles and samples of the errors of x (m), v (m/s) and F: ``before``, ``predicted``
        by the budget without the cause, and ``again`` from the run without it; None where no cause was removed. Only
        samples that are finite in both runs count."""
        if self.again is None:
            return None
        before, after = _common_samples(self.result.series, self.again.series)
        return {"class": self.cause,
                "before": {field: budget_shares.rms_error_over_run(before, field) for field in FIELDS},
                "predicted": {field: budget_shares.rms_error_over_run(before, field,
                                                                      without=self.cause) for field in FIELDS},
                "again": {field: budget_shares.rms_error_over_run(after, field) for field in FIELDS}}

    def to_dict(self) -> dict:
        """Returns the object of ``mpm-lab budget --json``."""
        values = self.result.budget
        assert values is not None  # the scene has the effect
        return {"schema": SCHEMA, "scene": self.result.scene.to_dict(), "reference": values["reference"],
                "budget": values, "grid_crossings": self.result.grid_crossings, "take_away": self.take_away()}


def run_budget(scene: Any, cause: str = NOTHING, on_progress: Progress = lambda part: None) -> CauseRemovalResult:
    """Runs a scene that has the effect ``budget``, or whose problem has budgets on demand, and again without ``cause``,
    a key of ``CAUSES``, if one is given; ``on_progress`` is called with the part done, 0 to 1.

    Raises :class:`~solvers.scene.validation.SceneError` where there is no budget on demand of the scene."""
    on_demand = PROBLEMS[scene.problem].budget
    once = partial(_run_with_budget_effect, scene)
    if on_demand is not None:
        on_demand.require_budget(scene, cause)
        once = partial(_rerun_with_budget, on_demand, run(scene, prices=False, mid_run=False))
    if cause == NOTHING:
        return CauseRemovalResult(once(NOTHING, on_progress), cause, None)
    result = once(NOTHING, lambda part: on_progress(part / 2))
    again = once(cause, lambda part: on_progress((1 + part) / 2))
    if again.explanation is not None:  # of which run it is
        again = replace(again, explanation=Message("without {cause} {reason}", Message(CAUSES[cause]),
                                                   again.explanation))
    return CauseRemovalResult(result, cause, again)


def _run_with_budget_effect(scene: Any, cause: str, show: Progress) -> Result:
    """Runs a scene whose steps include the budget, without ``cause``; with "nothing", as it is."""
    return run(replace(scene, take_away=cause), show, prices=False, mid_run=cause == NOTHING)


def _rerun_with_budget(on_demand: BudgetProvider, plain: Result, cause: str, show: Progress) -> Result:
    """Repeats the run of ``plain`` step by step, with its budget and without ``cause``; with "nothing", as it is."""
    time = plain.series["time"]
    steps = np.rint(time / plain.scene.time_step).astype(int)
    series, solver = on_demand.budget_series(plain.scene, steps, cause, show)
    if cause == NOTHING:
        return replace(plain, series=plain.series | series)
    status, explanation, broken_at = solver.status(None)
    if solver.sound and solver.step < steps[-1]:
        status, broken_at = LOST, solver.time
        explanation = Message("the run is lost from t = {time:.4g} s on: the domain of a particle has turned inside "
                              "out or left the grid", solver.time)
    return replace(plain, series={"time": time, **series}, status=status, explanation=explanation,
                   broken_at=broken_at, advice=())


def _common_samples(first: Mapping[str, np.ndarray], second: Mapping[str, np.ndarray]) -> tuple[dict, dict]:
    """Returns the budget's series of two runs, each (T,), at the T times at which both have finite samples."""
    _, *places = np.intersect1d(first["time"], second["time"], return_indices=True)
    both = [{name: values[at] for name, values in series.items() if name.startswith("budget/")}
            for series, at in zip((first, second), places, strict=True)]
    known = np.all([np.isfinite(series[f"budget/error_{field}"]) for series in both for field in FIELDS], axis=0)
    before, after = ({name: values[known] for name, values in series.items()} for series in both)
    return before, after
