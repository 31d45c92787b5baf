"""Error budgets of runs of the bar, computed for all visitors in one background process, and the last ones found."""

import functools
from dataclasses import replace
from typing import Any

import numpy as np

from app.page.features.budget import jobs
from app.page.features.shared_answers import SharedAnswers
from solvers.scene.scene import Scene
from solvers.scene.validation import SceneError

EFFECTS = ("truth", "crossings", "budget")


class SharedBudgets(SharedAnswers):
    """Budgets by scene."""

    def __init__(self) -> None:
        super().__init__(f"{jobs.__name__}:budget", cause="nothing")

    def find(self, scene: Scene, time: float, starts: bool) -> jobs.Series | None:
        """Returns the budget columns of a scene's run until a ``time`` in s or later, {} if it has none, and None while
        they are not known; then it ``starts`` computing them."""
        # Of 1, 2, 4, ... periods, so that a run that goes on needs few.
        periods = 2.0 ** max(0, np.ceil(np.log2(max(time / scene.period * (1 - 1e-9), 1e-9))))
        return self.answer(_budget_scene(scene, periods), starts)

    def usable(self, answer: dict[str, Any]) -> jobs.Series:
        return {name: np.array(values, float) for name, values in (answer.get("series") or {}).items()}


@functools.lru_cache(maxsize=256)  # called at every refresh of every page
def _budget_scene(scene: Scene, periods: float) -> Scene | None:
    """Returns the scene that computes the budget of another one over so many ``periods``: without estimators where the
    exact solution is known; None if there is none."""
    changes: dict[str, Any] = {"effects": EFFECTS, "periods": periods, "t_end": None,
                               "estimators": () if scene.solution_known else scene.estimators}
    try:
        return replace(scene, **changes)
    except SceneError:
        return None


SHARED = SharedBudgets()
