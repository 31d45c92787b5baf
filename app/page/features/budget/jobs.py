"""Background jobs of *Who made this error?* for runs without a recorded budget. The worker function ``budget`` sends::

    {"part": .3}                        its progress
    {"series": {...}, "again": {...}}   the samples of the run, and of that without the cause, or None
    {"trouble": a sentence}             why there is no budget
    {"bad": a sentence}                 why a run goes bad
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from app.language.translation import lazy, tr, translate_message
from app.page.features.background_job import SLOTS, BackgroundJobs, JobStatus
from solvers.running.result import Result
from solvers.scene.error_causes import NOTHING
from solvers.scene.scene import Scene
from solvers.scene.validation import SceneError
from solvers.solver.error_series import finite_or_none
from solvers.study.parameter_grid import Task, task_of
from solvers.workers.worker_pool import Slots

PATIENCE = 180.0  # timeout of a job in s
OFTEN = 0.02  # share of the work between two reports of progress

Series = dict[str, np.ndarray]
Tell = Callable[[dict[str, Any]], object]


@dataclass(frozen=True)
class BudgetJobStatus(JobStatus):
    """Budget of a ``scene``: progress (``part`` of 1), samples, and those ``again`` of its run without ``cause``."""

    scene: Scene | None = None
    cause: str = NOTHING
    part: float = 0.0
    series: Series | None = None
    again: Series | None = None


class BudgetJobs(BackgroundJobs[BudgetJobStatus]):
    """Budget jobs of one visitor, in the background."""

    WORK = __name__
    BUSY = lazy("Other visitors' questions keep this server busy: it answers {n} at a time. Try again in a while.")

    def __init__(self, slots: Slots = SLOTS):
        super().__init__(BudgetJobStatus(), slots)

    def start_budget(self, scene: Scene, cause: str = NOTHING) -> None:
        """Starts the budget of a scene, and of its run without ``cause``; results of the same scene stay shown."""
        before = self.status.series if self.status.scene == scene else None
        self._start(BudgetJobStatus("budget", scene=scene, cause=cause, series=before),
                    {"task": task_of(scene).to_dict(), "cause": cause}, PATIENCE)
        self.lower_priority()

    def update_status(self, before: BudgetJobStatus, message: dict[str, Any]) -> BudgetJobStatus:
        given: dict[str, Any] = message | {
            name: columns and {key: np.array(values, float) for key, values in columns.items()}
            for name, columns in message.items() if name in ("series", "again")}
        if (reason := given.pop("bad", None)) is not None:
            given["trouble"] = tr("the run goes bad: {reason}", reason=translate_message(reason))
        return replace(before, **given)


def budget(question: dict[str, Any], tell: Tell) -> None:
    """Computes a budget in a worker process for {"task": ..., "cause": ...}; ``tell`` sends a message to the page."""
    from solvers.running.budget_cause_removal import run_budget

    said = 0.0

    def show(part: float) -> None:
        nonlocal said
        if part >= said + OFTEN:
            said = part
            tell({"part": part})

    try:
        found = run_budget(Task(**question["task"]).scene(), question["cause"], show)
    except SceneError as error:
        tell({"trouble": str(error)})
        return
    bad = [result.reason for result in (found.result, found.again) if result is not None and result.status != "ok"]
    tell({"series": _columns(found.result), "again": found.again and _columns(found.again),
          **({"bad": bad[0]} if bad else {})})


def _columns(result: Result) -> dict[str, list[float | None]]:
    """Returns times, crossings and budget columns of a run as JSON values, None where not finite."""
    return {name: [finite_or_none(value) for value in np.asarray(values).tolist()]
            for name, values in result.series.items() if name in ("time", "crossings") or name.startswith("budget/")}
