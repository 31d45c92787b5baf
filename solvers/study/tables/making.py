"""The runs of all rows of tables: those that are only computed side by side, then those that are timed, each alone."""

import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, wait
from contextlib import closing

from solvers.study.grid import Task, task_of
from solvers.study.tables.document import TIMED, Results
from solvers.study.tables.plan import Row
from solvers.workers.pool import WorkerPool

WORK = f"{__name__}:work"
LOOK_SECONDS, TELL_SECONDS = 0.2, 0.1  # between two looks at what has come, and two messages of how far a run is


class Making:
    """Makes the runs of rows in so many processes. ``show`` is told the part done and the row that it is about."""

    def __init__(self, rows: Sequence[Row], begun: Mapping[str, Results], processes: int,
                 show: Callable[[float, str], None], keep: Callable[[Row, Results], None]):
        self._rows, self._processes, self._show, self._keep = rows, processes, show, keep
        self._results = {row.name: dict(begun.get(row.name, {})) for row in rows}
        self._parts: dict[tuple[str, str], float] = {}  # of each run that is to be made, the part done
        self._works = {(row.name, name): _work(row, name) for row in rows for name in row.scenes
                       if name not in self._results[row.name]}

    def make(self) -> None:
        """Make all runs; ``keep`` is given a row, and what there is of it, whenever one more of its runs is there."""
        missing = [(row, name) for row in self._rows for name in row.scenes if (row.name, name) in self._works]
        # The longest first, so that no processor waits for another at the end.
        computed = sorted((one for one in missing if one[1] not in TIMED),
                          key=lambda one: -self._works[one[0].name, one[1]])
        with closing(WorkerPool(WORK, self._processes)) as pool:
            self._await({self._begin(pool, row, name): (row, name) for row, name in computed})
            for row, name in missing:
                if name in TIMED:
                    self._await({self._begin(pool, row, name): (row, name)})

    def _begin(self, pool: WorkerPool, row: Row, name: str) -> Future[dict]:
        def hear(answer: dict) -> None:
            self._parts[row.name, name] = answer.get("part", 1.0)

        task = task_of(row.scenes[name])
        return pool.submit({"task": task.to_dict(), "timed": name in TIMED}, hear, kind=task.kind)

    def _await(self, waiting: dict[Future[dict], tuple[Row, str]]) -> None:
        while waiting:
            done, _ = wait(waiting, LOOK_SECONDS, FIRST_COMPLETED)
            for future in done:
                row, name = waiting.pop(future)
                self._results[row.name][name] = future.result()["result"]
                self._keep(row, self._results[row.name])
            if waiting:
                self._tell(next(iter(waiting.values()))[0])

    def _tell(self, row: Row) -> None:
        done = sum(part * self._works[run] for run, part in list(self._parts.items()))
        self._show(done / sum(self._works.values()), row.name)


def _work(row: Row, name: str) -> float:
    """Particle-steps of a run, with something for its compilation: what the progress bar counts."""
    scene = row.scenes[name]
    return scene.particles * scene.steps + 1e6


def work(question: Mapping, answer: Callable[[dict], None]) -> None:
    """In a process of its own: make one run. The prices of estimators are measured where the run is timed."""
    from solvers.running.run import run

    told = 0.0

    def tell(part: float) -> None:
        nonlocal told
        if (now := time.monotonic()) > told + TELL_SECONDS:
            told = now
            answer({"part": part})

    scene = Task(**question["task"]).scene()
    answer({"result": run(scene, on_progress=tell, prices=question["timed"], mid_run=False).to_dict()})
