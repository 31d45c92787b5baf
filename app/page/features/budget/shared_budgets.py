"""Error budgets of runs of the bar, computed for all visitors in one background process, and the last ones found."""

import functools
import threading
from collections import OrderedDict
from concurrent.futures import Future
from dataclasses import replace
from typing import Any

import numpy as np

from app.page.features.budget import jobs
from app.page.shutdown import run_in_background
from solvers.scene.scene import Scene
from solvers.scene.validation import SceneError
from solvers.study.parameter_grid import task_of
from solvers.workers.worker_pool import WorkerPool

EFFECTS = ("truth", "crossings", "budget")
MOST_KEPT = 64
MOST_WORK = 2e7  # particle-steps: what takes longer is found on request


class SharedBudgets:
    """Budgets by scene. The process starts with the first question and ends when the last visitor leaves."""

    def __init__(self) -> None:
        self._lock, self._visitors = threading.Lock(), 0
        self._pool: WorkerPool | None = None
        self._found: OrderedDict[Scene, jobs.Series | None] = OrderedDict()  # None while it is computed

    def open(self) -> None:
        """Registers a visitor."""
        with self._lock:
            self._visitors += 1

    def close(self) -> None:
        """Ends the process if no other visitor is left."""
        with self._lock:
            self._visitors -= 1
            pool = self._pool
            if self._visitors or pool is None:
                return
            self._pool = None
        run_in_background(pool.close)

    def find(self, scene: Scene, time: float, starts: bool) -> jobs.Series | None:
        """Returns the budget columns of a scene's run until a ``time`` in s or later, {} if it has none, and None while
        they are not known; then it ``starts`` computing them."""
        # Of 1, 2, 4, ... periods, so that a run that goes on needs few.
        asked = _budget_scene(scene, 2.0 ** max(0, np.ceil(np.log2(max(time / scene.period * (1 - 1e-9), 1e-9)))))
        if asked is None or asked.steps * asked.particles > MOST_WORK:
            return {}
        with self._lock:
            if asked in self._found:
                self._found.move_to_end(asked)
                return self._found[asked]
            if not starts:
                return None
            self._found[asked] = None
            while len(self._found) > MOST_KEPT:
                self._found.popitem(last=False)
            self._pool = pool = self._pool or WorkerPool(f"{jobs.__name__}:budget")
        pool.submit({"task": task_of(asked).to_dict(), "cause": "nothing"},
                    patience=jobs.PATIENCE).add_done_callback(lambda job: self._store(asked, job))
        pool.lower_priority()
        return None

    def _store(self, scene: Scene, job: Future[dict[str, Any]]) -> None:
        answer = {} if job.exception() else job.result()
        with self._lock:
            if job.exception() and self._pool is None:  # it has been closed
                self._found.pop(scene, None)
                return
            self._found[scene] = {name: np.array(values, float)
                                  for name, values in (answer.get("series") or {}).items()}


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
