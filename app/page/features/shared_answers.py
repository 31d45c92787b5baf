"""Answers about scenes, found for all visitors in one background process, and the last ones kept."""

import threading
from collections import OrderedDict
from collections.abc import Callable
from concurrent.futures import Future
from typing import Any

from app.page.shutdown import run_in_background
from solvers.scene.scene import Scene
from solvers.study.parameter_grid import task_of
from solvers.workers.cpu_count import available_cpus
from solvers.workers.worker_pool import WorkerPool

MOST_KEPT = 64
MOST_WORK = 2e7  # particle-steps of a scene: what takes longer is not begun unasked
MOST_STAGES = 2  # running ones of all visitors for each processor, beside which work is begun unasked
PATIENCE = 180.0  # timeout of an answer in s


class SharedAnswers:
    """Answers by scene of the function ``work`` ("module:function"), which is asked with a scene's task and with
    ``more``, one at a time. The process starts with the first question and ends when the last visitor leaves."""

    def __init__(self, work: str, **more: object):
        self._lock, self._visitors, self._work, self._more = threading.Lock(), 0, work, more
        self._running_stages: Callable[[], int] = lambda: 0
        self._pool: WorkerPool | None = None
        self._found: OrderedDict[Scene, Any] = OrderedDict()  # None while it is computed

    def open(self, running_stages: Callable[[], int] = lambda: 0) -> None:
        """Registers a visitor; ``running_stages`` returns the number of running stages of all."""
        with self._lock:
            self._visitors, self._running_stages = self._visitors + 1, running_stages

    def close(self) -> None:
        """Ends the process if no other visitor is left."""
        with self._lock:
            self._visitors -= 1
            pool = self._pool
            if self._visitors or pool is None:
                return
            self._pool = None
        run_in_background(pool.close)

    def answer(self, scene: Scene | None, starts: bool = True) -> Any:
        """Returns the :meth:`usable` answer about a scene, that of {} if it has none, and None while it is not known;
        then it ``starts`` finding it, unless another one is being found or many stages run."""
        if scene is None or scene.steps * scene.particles > MOST_WORK:
            return self.usable({})
        with self._lock:
            if scene in self._found:
                self._found.move_to_end(scene)
                return self._found[scene]
            busy = self._running_stages() > MOST_STAGES * available_cpus()
            if not starts or busy or None in self._found.values():  # it is asked again, if still on a stage by then
                return None
            self._found[scene] = None
            while len(self._found) > MOST_KEPT:
                self._found.popitem(last=False)
            self._pool = pool = self._pool or WorkerPool(self._work)
            others = self._visitors > 1  # whose stages must not wait for what nobody has asked for
        pool.submit({"task": task_of(scene).to_dict(), **self._more},
                    patience=PATIENCE).add_done_callback(lambda job: self._store(scene, job))
        pool.lower_priority(idle=others)
        return None

    def usable(self, answer: dict[str, Any]) -> Any:
        """Returns what is kept of an ``answer`` of the process, {} if it has failed."""
        return answer

    def _store(self, scene: Scene, job: Future[dict[str, Any]]) -> None:
        answer = self.usable({} if job.exception() else job.result())
        with self._lock:
            if job.exception() and self._pool is None:  # it has been closed
                self._found.pop(scene, None)
            else:
                self._found[scene] = answer
