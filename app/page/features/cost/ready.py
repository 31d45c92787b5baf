"""A process that is ready when a visitor presses: it has started, and compiled what runs need."""

import threading
from collections.abc import Mapping

from solvers.workers.pool import Slots, WorkerPool

MOST_READY = 1  # on this server: each holds some 150 MB
PLACES = Slots(MOST_READY)
RESTS = 300.0  # seconds after which one that nobody has needed ends


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
