"""Sweeps and searches of one visitor in the background, one at a time; the visitor's stage pauses meanwhile for
accurate times. All visitors share a cache of measured points and a worker process that has compiled its kernels.

Errors and outcomes are reproducible, so they are cached as long as the server runs. Times are cached for an hour, those
measured under load separately, because a search must compare like with like."""

import json
import threading
import time
from collections import OrderedDict
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import asdict, dataclass, field, replace

from app import __version__
from app.language.translation import lazy
from app.page.features.background_job import SLOTS, BackgroundJobs, JobStatus
from app.page.features.cost import visitor_run_list
from app.page.features.cost.visitor_run_list import SEARCH, SWEEP, VisitorRunList, advice_key
from app.page.visit.run_session import RunSession
from solvers.scene.scene import Scene
from solvers.scene.validation import SceneError
from solvers.study.parameter_grid import Task, task_of
from solvers.study.sweep_and_search_worker import COURANT_NUMBERS, PARTICLES_PER_CELL, READY, SearchJob
from solvers.workers.worker_pool import Slots, WorkerPool

MOST_QUESTIONS, MOST_POINTS = 64, 500  # beyond, the least recently used, or the oldest, is dropped: 10 MB in all
HOLDS = 3600.0  # seconds for which a time is valid
MOST_READY = 1  # on this server: each holds some 150 MB
PLACES = Slots(MOST_READY)
RESTS = 300.0  # seconds after which an unused one ends


@dataclass
class _CachedRun:
    """Cached result of a run: ``values``; and by whether undisturbed, its rate and the time of measurement in s."""

    values: dict
    rates: dict[bool, tuple[float | None, float]] = field(default_factory=dict)


class SearchCache:
    """Cache of measured points by question (a search's subject as JSON) and by key of their rows. Thread-safe."""

    def __init__(self, now: Callable[[], float] = time.monotonic):
        self._lock, self._now = threading.Lock(), now
        self._questions: OrderedDict[str, dict[str, _CachedRun]] = OrderedDict()

    def add_point(self, question: str, key: str, result: dict, undisturbed: bool) -> None:
        """Stores a run's error, status, reason and rate, measured ``undisturbed`` or not; drops the oldest."""
        with self._lock:
            points = self._questions.setdefault(question, {})
            self._questions.move_to_end(question)
            point = points.setdefault(key, _CachedRun({name: result[name] for name in ("error", "status", "reason")}))
            point.rates[undisturbed] = result["rate"], self._now()
            if len(points) > MOST_POINTS:
                del points[next(iter(points))]
            if len(self._questions) > MOST_QUESTIONS:
                self._questions.popitem(last=False)

    def recent_points(self, question: str, undisturbed: bool) -> dict[str, dict]:
        """Returns a question's cached points by key, with ``rate`` if recent and measured at the same load."""
        with self._lock:
            since = self._now() - HOLDS
            found = self._questions.get(question, {})
            rates = {key: point.rates.get(undisturbed, (None, since)) for key, point in found.items()}
            return {key: point.values | ({"rate": rates[key][0]} if rates[key][1] > since else {})
                    for key, point in found.items()}


KEPT = SearchCache()


class WarmWorker:
    """At most one idle process for the function ``work``, if a place is free, for ``idle_timeout`` s. Thread-safe."""

    def __init__(self, work: str, places: Slots = PLACES, idle_timeout: float = RESTS):
        self._work, self._places, self._rests = work, places, idle_timeout
        self._lock = threading.Lock()
        self._pool: WorkerPool | None = None
        self._timer: threading.Timer | None = None

    def prepare(self, question: Mapping, low_priority: bool) -> None:
        """Starts a process that compiles for a question, if a place is free, perhaps at low priority."""
        pool = WorkerPool(self._work)
        if self.keep_worker(pool):
            pool.submit(question)
            if low_priority:
                pool.lower_priority()

    def keep_worker(self, pool: WorkerPool) -> bool:
        """Keeps an idle process for the next question; False if there is one already or no free place."""
        with self._lock:
            if self._pool is not None or not self._places.acquire():
                return False
            self._pool = pool
            self._timer = threading.Timer(self._rests, self.end)
            self._timer.daemon = True
            self._timer.start()
            return True

    def take(self) -> WorkerPool | None:
        """Removes the idle process and returns it, or None if there is none; frees its place."""
        with self._lock:
            pool, self._pool = self._pool, None
            if pool is not None:
                self._places.release()
            if self._timer is not None:
                self._timer.cancel()
            return pool

    def end(self) -> None:
        """Ends the idle process, which is no longer needed."""
        if pool := self.take():
            threading.Thread(target=pool.close, name="no-longer-ready", daemon=True).start()


#: Grids of a sweep, by dimension, as multiples of the problem's own.
GRIDS = {1: (0.5, 0.7, 1, 1.4, 2, 4), 2: (0.5, 0.75, 1, 1.5)}
REPEATS = 2


def sweep_tasks(scene: Scene) -> list[Task]:
    """Returns the task of the scene and of the same on several grids with each of its methods; invalid combinations are
    left out."""
    effects = tuple(dict.fromkeys((*scene.effects, "truth", "estimate")))
    scenes = [replace(scene, effects=effects)]
    if scene.velocity == "corners":  # valid with one method only
        scene = replace(scene, velocity="grid")
    for method in scene.choices("method"):
        for share in GRIDS[scene.DIMENSIONS]:
            with suppress(SceneError):
                scenes.append(replace(scene, method=method, cells=round(share * type(scene)().cells), effects=effects))
    return [task_of(one, repeats=REPEATS, version=__version__) for one in dict.fromkeys(scenes)]


def search_job(scene: Scene, quantity: str, tolerance: float, budget: float) -> SearchJob:
    """Returns the search for the cheapest run with an error of the quantity ("x") up to ``tolerance`` times the scene's
    size of it, in up to ``budget`` s."""
    return SearchJob(task_of(visitor_run_list.without_search_options(scene)).to_dict(), scene.candidates(),
                     PARTICLES_PER_CELL, COURANT_NUMBERS, quantity, tolerance * scene.size_of(quantity), budget)


@dataclass(frozen=True)
class CostJobStatus(JobStatus):
    """State of a sweep or search: ``done`` of ``total`` certain runs, ``known`` of them cached; ``task`` runs now; a
    search is by the error of ``quantity``."""

    done: int = 0
    total: int = 0
    task: Task | None = None
    known: int = 0
    advice: dict | None = None
    quantity: str = "x"


class CostJobs(BackgroundJobs[CostJobStatus]):
    """Jobs of one visitor, which add rows to ``runs``; results of searches are cached in ``kept`` for all visitors."""

    WORK = "solvers.study.sweep_and_search_worker"
    BUSY = lazy("Other visitors' sweeps and searches keep this server busy: it does {n} at a time. Try again in a "
                "while.")

    def __init__(self, runs: VisitorRunList, slots: Slots = SLOTS, kept: SearchCache = KEPT):
        super().__init__(CostJobStatus(), slots)
        self.runs, self._kept = runs, kept
        self._ready = WarmWorker(f"{self.WORK}:search")
        self._quiet, self._about = True, ""  # whether the job runs undisturbed; subject of the search

    def prepare(self, job: SearchJob, undisturbed: bool) -> None:
        """Prepares a process for a search that the visitor may start, at low priority unless ``undisturbed``."""
        if not self.status.running and not self._closed:
            self._ready.prepare(asdict(job) | {READY: True}, low_priority=not undisturbed)
        if self._closed:  # meanwhile
            self._ready.end()

    def close(self) -> None:
        super().close()
        self._ready.end()

    def _worker_for_kind(self, kind: str) -> WorkerPool:
        if kind == "search" and (pool := self._ready.take()):
            return pool
        self._ready.end()
        return super()._worker_for_kind(kind)

    def _keeps_worker(self, pool: WorkerPool) -> bool:
        """Keeps a search's process, which has compiled kernels, unless its priority was lowered, which is permanent."""
        kept = self.status.kind == "search" and self._quiet and not self._closed and self._ready.keep_worker(pool)
        if self._closed:  # meanwhile
            self._ready.end()
        return kept

    def start_sweep(self, tasks: list[Task]) -> None:
        self._start(CostJobStatus("sweep", total=len(tasks)), [task.to_dict() for task in tasks])

    def start_search(self, job: SearchJob, undisturbed: bool = True) -> None:
        """Starts a search; it is ``undisturbed`` if no job or stage of another visitor runs on this server."""
        if not self.status.running:
            about = advice_key(Task(**job.base).scene()) | {"quantity": job.quantity}
            self._quiet, self._about = undisturbed, json.dumps(about, sort_keys=True)
        known = self._kept.recent_points(self._about, undisturbed)
        self._start(CostJobStatus("search", quantity=job.quantity), asdict(replace(job, known=known)))

    def share_cpu(self) -> None:
        """Lowers the running job's priority because something else runs; a search's only after its first run."""
        self._quiet = False
        if self.status.kind != "search" or self.status.done:
            self.lower_priority()

    def update_status(self, before: CostJobStatus, message: dict) -> CostJobStatus:
        if "point" in message:
            self._kept.add_point(self._about, message["row"]["key"], message["point"], self._quiet)
        if "row" in message:
            self.runs.add(message["row"], SWEEP if before.kind == "sweep" else SEARCH)
            return replace(before, done=before.done + 1, known=before.known + bool(message.get("known")))
        if "look" in message:
            return replace(before, done=message["look"] - 1, total=message["certain"], task=Task(**message["task"]))
        return replace(before, **message)  # advice or trouble


class StagePauser:
    """Pauses a session's stage while its visitor's job runs, unless the visitor lets it play."""

    def __init__(self, session: RunSession):
        self._session, self._running, self._lock = session, False, threading.Lock()
        self.paused = False  # by this class, not by the visitor

    def set_job_running(self, running: bool) -> None:
        """Pauses or resumes the stage when a job of the visitor starts or ends; idempotent and thread-safe."""
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
