"""What the fold *Who made this error?* has found beside the stage: budgets on demand, and maps."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from app.language.heard import heard
from app.language.spoken import later, tr
from app.page.features.background import SLOTS, Background, JobStatus
from solvers.scene.causes import NOTHING
from solvers.scene.scene import Scene
from solvers.study.grid import task_of
from solvers.workers.pool import Slots

BUDGET, MAP = "budget", "where_and_when"
PATIENCE = 180.0  # seconds that one may take

Series = dict[str, np.ndarray]


@dataclass(frozen=True)
class Found(JobStatus):
    """Of a ``scene``: how far (``part``) it is; of a budget the samples, and ``again`` those of the run without the
    ``cause``; of a map of a ``field`` at a ``time`` in s the ``picture``, a PNG in base64."""

    scene: Scene | None = None
    cause: str = NOTHING
    field: str = ""
    time: float = 0.0
    part: float = 0.0
    series: Series | None = None
    again: Series | None = None
    picture: str = ""


class BudgetJobs(Background[Found]):
    """One visitor's."""

    WORK = "app.page.features.budget.work"
    BUSY = later("Other visitors' questions keep this server busy: it answers {n} at a time. Try again in a while.")

    def __init__(self, slots: Slots = SLOTS):
        super().__init__(Found(), slots)

    def budget(self, scene: Scene, cause: str = NOTHING) -> None:
        """Find the budget of a scene, and what is left without a cause; until then the one without it stays."""
        before = self.status.series if self.status.scene == scene else None
        self._start(Found(BUDGET, scene=scene, cause=cause, series=before),
                    {"task": task_of(scene).to_dict(), "cause": cause}, PATIENCE)
        self.give_way()

    def map(self, scene: Scene, time: float, field: str, particle: int | None) -> None:
        """Find where and when the error of a field at a time was made: of a particle, or of all."""
        end: dict[str, Any] = {"t_end": time, "periods": None}
        self._start(Found(MAP, scene=scene, field=field, time=time),
                    {"task": task_of(replace(scene, **end)).to_dict(), "field": field, "particle": particle}, PATIENCE)
        self.give_way()

    def heard(self, before: Found, message: dict[str, Any]) -> Found:
        given: dict[str, Any] = message | {name: _arrays(message[name]) for name in ("series", "again")
                                           if name in message}
        if (reason := given.pop("bad", None)) is not None:
            given["trouble"] = tr("the run goes bad: {reason}", reason=heard(reason)) if reason else \
                tr("the run goes bad before this moment")
        return replace(before, **given)


def _arrays(columns: dict[str, list[float | None]] | None) -> Series | None:
    return None if columns is None else {name: np.array(values, float) for name, values in columns.items()}
