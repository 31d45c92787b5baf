"""One visitor's sweep or search in the background: at most one at a time, and few on the whole server; the visitor's
own stage stands still meanwhile, so as not to disturb its times."""

import json
import threading
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace

from app import __version__
from app.language.spoken import later
from app.page.features.background import SLOTS, Background, JobStatus
from app.page.features.cost.runs import LIVE, SEARCH, SWEEP, NumberedRun, Runs, bare, question
from app.page.features.cost.searches import KEPT, KeptPoints, Ready
from app.page.visit.session import Session
from solvers.scene.rules import SceneError
from solvers.scene.scene import Scene
from solvers.study.grid import Task, task_of
from solvers.study.jobs import COURANT_NUMBERS, PARTICLES_PER_CELL, READY, SearchJob
from solvers.workers.pool import Slots, WorkerPool

#: Cells of a small sweep, by dimension.
SMALL = {1: (10, 20, 40, 80), 2: (12, 24, 36, 48)}
REPEATS = 2


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
class CostStatus(JobStatus):
    """Of a "sweep" or a "search". ``total`` counts a sweep's runs, or those of a search that are certain; ``task`` is
    what a search looks at, and ``known`` counts those of its runs that earlier searches have made."""

    done: int = 0
    total: int = 0
    task: Task | None = None
    known: int = 0
    advice: dict | None = None


class Jobs(Background[CostStatus]):
    """What a visitor's jobs measure goes to ``runs``. Rows stay, whatever becomes of the job; what a search learns is
    ``kept`` for those of others, too."""

    WORK = "solvers.study.jobs"
    BUSY = later("Other visitors' sweeps and searches keep this server busy: it does {n} at a time. Try again in a "
                 "while.")

    def __init__(self, runs: Runs, slots: Slots = SLOTS, kept: KeptPoints = KEPT):
        super().__init__(CostStatus(), slots)
        self.runs, self._kept = runs, kept
        self._ready = Ready(f"{self.WORK}:search")
        self._quiet, self._about = True, ""  # whether nothing disturbs the job that runs; what the search is about

    def prepare(self, job: SearchJob, quiet: bool) -> None:
        """A visitor looks at what a search is asked for: have a process ready for it."""
        if not self.status.running and not self._closed:
            self._ready.prepare(asdict(job) | {READY: True}, gives_way=not quiet)
        if self._closed:  # meanwhile
            self._ready.end()

    def close(self) -> None:
        super().close()
        self._ready.end()

    def _process(self, kind: str) -> WorkerPool:
        if kind == "search" and (pool := self._ready.take()):
            return pool
        self._ready.end()
        return super()._process(kind)

    def _keeps(self, pool: WorkerPool) -> bool:
        """A search's, which has compiled what the next one needs, unless it has given way: it would for ever."""
        kept = self.status.kind == "search" and self._quiet and not self._closed and self._ready.keep(pool)
        if self._closed:  # meanwhile
            self._ready.end()
        return kept

    def sweep(self, tasks: list[Task]) -> None:
        self._start(CostStatus("sweep", total=len(tasks)), [task.to_dict() for task in tasks])

    def search(self, job: SearchJob, quiet: bool = True) -> None:
        """Begin a search; it is ``quiet`` where nothing else moves on this server."""
        if not self.status.running:
            self._quiet, self._about = quiet, json.dumps(question(Task(**job.base).scene()), sort_keys=True)
        self._start(CostStatus("search"), asdict(replace(job, known=self._kept.known(self._about, quiet))))

    def beside(self) -> None:
        """Something moves beside the job that runs: it gives way from now on, a search as soon as it has shown a first
        run, for until then it has hardly begun and somebody waits for it."""
        self._quiet = False
        if self.status.kind != "search" or self.status.done:
            self.give_way()

    def heard(self, before: CostStatus, message: dict) -> CostStatus:
        if "point" in message:
            self._kept.keep(self._about, message["row"]["key"], message["point"], self._quiet)
        if "row" in message:
            self.runs.add(message["row"], SWEEP if before.kind == "sweep" else SEARCH)
            return replace(before, done=before.done + 1, known=before.known + bool(message.get("known")))
        if "look" in message:
            return replace(before, done=message["look"] - 1, total=message["certain"], task=Task(**message["task"]))
        return replace(before, **message)  # advice or trouble


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
