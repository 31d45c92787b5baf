"""One visitor's sweep or search in the background: at most one at a time, and few on the whole server; the visitor's
own stage stands still meanwhile, so as not to disturb its times."""

import os
import threading
from collections.abc import Sequence
from concurrent.futures import Future
from dataclasses import asdict, dataclass, replace

from app import __version__
from app.page.features.cost.front import bare
from app.page.features.cost.runs import LIVE, SEARCH, SWEEP, NumberedRun, Runs
from app.page.visit.session import Session
from solvers.scene.rules import SceneError
from solvers.scene.scene import Scene
from solvers.study.grid import Task, task_of
from solvers.study.jobs import SearchJob
from solvers.workers.pool import Slots, WorkerPool

MOST_JOBS = max(1, (os.cpu_count() or 2) // 2)  # on this server; each keeps a processor busy
#: Cells of a small sweep, by dimension.
SMALL = {1: (10, 20, 40, 80), 2: (12, 24, 36, 48)}
REPEATS = 2
PARTICLES_PER_CELL, COURANT_NUMBERS = (2, 3, 4), (0.1, 0.3, 0.5)  # that a search chooses from
BUSY = "Other visitors' sweeps and searches keep this server busy: it does {} at a time. Try again in a while."


SLOTS = Slots(MOST_JOBS)


def small_sweep(scene: Scene) -> list[Task]:
    """A scene on four grids with each of its methods; what does not go together is left out."""
    if scene.velocity == "corners":  # goes with one method only
        scene = replace(scene, velocity="grid")
    effects = tuple(dict.fromkeys((*scene.effects, "truth", "estimate")))
    tasks = []
    for method in scene.choices("method"):
        for cells in SMALL[scene.DIMENSIONS]:
            try:
                other = replace(scene, method=method, cells=cells, effects=effects)
            except SceneError:
                continue
            tasks.append(task_of(other, repeats=REPEATS, version=__version__))
    return tasks


def timings(runs: Sequence[NumberedRun]) -> list[Task]:
    """The scenes of those runs that were timed on the stage only: there they go in small pieces, with every effect."""
    return [Task(run.row["problem"], run.row["asked"], repeats=REPEATS, version=__version__)
            for run in runs if run.source == LIVE]


def search(scene: Scene, tolerance: float, budget: float) -> SearchJob:
    """The job of finding the cheapest run of this problem with an error of x of ``tolerance`` times A at most."""
    return SearchJob(task_of(bare(scene)).to_dict(), scene.candidates(), PARTICLES_PER_CELL, COURANT_NUMBERS, "x",
                     tolerance * scene.size_of("x"), budget)


@dataclass(frozen=True)
class JobStatus:
    """How a visitor's job goes. ``kind`` is "", "sweep" or "search"; the last one's outcome stays until the next.

    ``total`` counts a sweep's runs, or those of a search that are certain; ``task`` is what a search looks at;
    ``trouble`` is a sentence about what went wrong.
    """

    kind: str = ""
    running: bool = False
    cancelled: bool = False
    done: int = 0
    total: int = 0
    task: Task | None = None
    advice: dict | None = None
    trouble: str | None = None


class Jobs:
    """A visitor's jobs, in ``slots`` that all share; what they measure goes to ``runs``. Any thread may call."""

    def __init__(self, runs: Runs, slots: Slots = SLOTS):
        self.runs, self.slots, self._lock = runs, slots, threading.Lock()
        self._pool: WorkerPool | None = None  # of one process, while a job runs
        self._closed = False
        self.status = JobStatus()

    @property
    def process_id(self) -> int | None:
        """Of the process that runs, if one does."""
        pool = self._pool
        return next(iter(pool.process_ids), None) if pool else None

    @property
    def others(self) -> bool:
        """Whether jobs of other visitors run on this server."""
        return self.slots.taken > self.status.running

    def forget(self) -> None:
        """What the last job has said no longer holds. Its rows stay."""
        with self._lock:
            if not self.status.running:
                self.status = JobStatus()

    def sweep(self, tasks: list[Task]) -> None:
        self._start("sweep", [task.to_dict() for task in tasks], len(tasks))

    def search(self, job: SearchJob) -> None:
        self._start("search", asdict(job), 0)

    def cancel(self) -> None:
        """End the job that runs; what it has found so far stays."""
        with self._lock:
            if self._pool is not None:
                self.status = replace(self.status, cancelled=True)
                self._pool.kill()

    def give_way(self) -> None:
        """To the stages that move, from now on."""
        with self._lock:
            if self._pool is not None:
                self._pool.give_way()

    def close(self) -> None:
        """The visitor has gone."""
        with self._lock:
            self._closed = True
        self.cancel()

    def _start(self, kind: str, question: list | dict, total: int) -> None:
        with self._lock:
            if self.status.running or self._closed:
                return
            if not self.slots.take():
                self.status = JobStatus(kind, trouble=BUSY.format(MOST_JOBS))
                return
            self.status = JobStatus(kind, running=True, total=total)
            self._pool = WorkerPool(f"solvers.study.jobs:{kind}")
            job = self._pool.submit(question, self._hear)
        job.add_done_callback(self._end)

    def _hear(self, message: dict) -> None:
        """A message of the job that runs; there is no other, because the next waits for this one's end."""
        with self._lock:
            before = self.status
            if "row" in message:
                self.runs.add(message["row"], SWEEP if before.kind == "sweep" else SEARCH)
                self.status = replace(before, done=before.done + 1)
            elif "look" in message:
                self.status = replace(before, done=message["look"] - 1, total=message["coarse"],
                                      task=Task(**message["task"]))
            else:
                self.status = replace(before, **message)  # advice or trouble

    def _end(self, job: Future[dict]) -> None:
        """The job has ended, or could not begin."""
        if self._pool is not None:
            self._pool.close()
        with self._lock:
            trouble = None if self.status.cancelled else _trouble(job.exception()) or self.status.trouble
            self.status, self._pool = replace(self.status, running=False, trouble=trouble), None
            self.slots.give_back()


def _trouble(error: BaseException | None) -> str | None:
    """What has become of the process, in a sentence."""
    if isinstance(error, OSError):
        return f"No process could be started: {error.strerror or error}."
    return None if error is None else f"the background process {error}"


class QuietStage:
    """Pauses a session's stage while its visitor's job runs, and lets it go on afterwards. Play stays the visitor's: a
    stage that moves meanwhile is left alone from then on."""

    def __init__(self, session: Session):
        self._session, self._running, self._lock = session, False, threading.Lock()
        self.paused = False  # by this, and not by the visitor

    def follow(self, running: bool) -> None:
        """A job of the visitor is to run or runs, or none does. Any thread may call, again and again."""
        with self._lock:
            begins, ends, self._running = running and not self._running, self._running and not running, running
            playing = self._session.playing  # read once: the visitor may press Pause meanwhile, and must not be undone
            if begins and playing:
                self.paused = True
                self._session.play(False)
            elif self.paused and (playing or ends):
                self.paused = False
                if not playing:
                    self._session.play(True)
