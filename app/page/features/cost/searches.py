"""What later searches on this server have of earlier ones: points that were measured, whoever asked about the same
motion, and a process that is ready when a visitor presses: it has started, and compiled what runs need.

Same input, same bits: errors and ends of runs hold for as long as the server runs. Times do not: they are kept for an
hour, and those taken beside other work apart from those taken alone, for a search is to compare like with like.
"""

import threading
import time
from collections import OrderedDict
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from solvers.workers.pool import Slots, WorkerPool

MOST_QUESTIONS, MOST_POINTS = 64, 500  # of which the least lately asked, or the oldest, goes: some 10 MB in all
HOLDS = 3600.0  # seconds for which a time is believed
MOST_READY = 1  # on this server: each holds some 150 MB
PLACES = Slots(MOST_READY)
RESTS = 300.0  # seconds after which one that nobody has needed ends


@dataclass
class _Point:
    """What is known of one run: as ``solvers.study.jobs.told`` says it, and its rates with the moments at which they
    were taken, by whether nothing disturbed them."""

    told: dict
    rates: dict[bool, tuple[float | None, float]] = field(default_factory=dict)


class KeptPoints:
    """Points by question (what a search is about, as text) and by key of their rows. Safe from any thread."""

    def __init__(self, now: Callable[[], float] = time.monotonic):
        self._lock, self._now = threading.Lock(), now
        self._questions: OrderedDict[str, dict[str, _Point]] = OrderedDict()

    def keep(self, question: str, key: str, told: dict, quiet: bool) -> None:
        """Take in what a search has said of a run, and whether nothing disturbed its time."""
        with self._lock:
            points = self._questions.setdefault(question, {})
            self._questions.move_to_end(question)
            point = points.setdefault(key, _Point({name: told[name] for name in ("error", "status", "reason")}))
            point.rates[quiet] = told["rate"], self._now()
            if len(points) > MOST_POINTS:
                del points[next(iter(points))]
            if len(self._questions) > MOST_QUESTIONS:
                self._questions.popitem(last=False)

    def known(self, question: str, quiet: bool) -> dict[str, dict]:
        """The points of a question, for a search that nothing disturbs, or that runs beside other work: with rates that
        were taken alike, and not too long ago; else without."""
        with self._lock:
            since = self._now() - HOLDS
            found = self._questions.get(question, {})
            rates = {key: point.rates.get(quiet, (None, since)) for key, point in found.items()}
            return {key: point.told | ({"rate": rates[key][0]} if rates[key][1] > since else {})
                    for key, point in found.items()}


KEPT = KeptPoints()


class Ready:
    """At most one process for one kind of ``work``, where there is a place for it. Safe from any thread."""

    def __init__(self, work: str, places: Slots = PLACES, rests: float = RESTS):
        self._work, self._places, self._rests = work, places, rests
        self._lock = threading.Lock()
        self._pool: WorkerPool | None = None
        self._timer: threading.Timer | None = None

    def prepare(self, question: Mapping, gives_way: bool) -> None:
        """Have a process get ready by answering a question, unless one is, or there is no place; one that ``gives_way``
        waits for whatever else wants a processor, now and when it is taken."""
        pool = WorkerPool(self._work)
        if self.keep(pool):
            pool.submit(question)
            if gives_way:
                pool.give_way()

    def keep(self, pool: WorkerPool) -> bool:
        """Have a process that rests be the one that is ready, unless there is one, or no place."""
        with self._lock:
            if self._pool is not None or not self._places.take():
                return False
            self._pool = pool
            self._timer = threading.Timer(self._rests, self.end)
            self._timer.daemon = True
            self._timer.start()
            return True

    def take(self) -> WorkerPool | None:
        """The process, for good, if there is one."""
        with self._lock:
            pool, self._pool = self._pool, None
            if pool is not None:
                self._places.give_back()
            if self._timer is not None:
                self._timer.cancel()
            return pool

    def end(self) -> None:
        """It is not needed any more."""
        if pool := self.take():
            threading.Thread(target=pool.close, name="no-longer-ready", daemon=True).start()
