"""Background work for one visitor in a process of its own: one job at a time, and few on the whole server."""

import threading
from abc import ABC, abstractmethod
from concurrent.futures import Future
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Generic, TypeVar

from app.language.translation import tr, translate_message, with_language
from solvers.workers.cpu_count import available_cpus
from solvers.workers.worker_pool import Slots, WorkerPool

MOST_JOBS = max(1, available_cpus() // 2)  # on this server; each keeps a processor busy
SLOTS = Slots(MOST_JOBS)


@dataclass(frozen=True)
class JobStatus:
    """State of a visitor's current or last job: ``kind`` is "" before the first, ``trouble`` an error message."""

    kind: str = ""
    running: bool = False
    cancelled: bool = False
    trouble: str | None = None


S = TypeVar("S", bound=JobStatus)


class BackgroundJobs(ABC, Generic[S]):
    """One visitor's jobs, one at a time: each runs a function of the module ``WORK`` in a worker process, in one of
    ``slots`` that all visitors share. Thread-safe."""

    WORK: ClassVar[str]
    BUSY: ClassVar[str]  # message if no slot is free; {n} is their number

    def __init__(self, idle: S, slots: Slots = SLOTS):
        self.slots, self._idle, self._lock = slots, idle, threading.Lock()
        self._pool: WorkerPool | None = None  # of one process, while a job runs
        self._closed = False
        self.status = idle

    @property
    def others_busy(self) -> bool:
        """Whether jobs of other visitors run on this server."""
        return self.slots.taken > self.status.running

    def discard_status(self) -> None:
        """Discards the status of the last job, which no longer applies."""
        with self._lock:
            if not self.status.running:
                self.status = self._idle

    def cancel(self) -> None:
        """Cancels the running job; its results so far stay."""
        with self._lock:
            if self._pool is not None:
                self.status = replace(self.status, cancelled=True)
                self._pool.kill()

    def lower_priority(self) -> None:
        """Lowers the priority of the running job in favour of running stages."""
        with self._lock:
            if self._pool is not None:
                self._pool.lower_priority()

    def close(self) -> None:
        """Cancels the running job and accepts no more when the visitor leaves."""
        with self._lock:
            self._closed = True
        self.cancel()

    @abstractmethod
    def update_status(self, before: S, message: dict[str, Any]) -> S:
        """Returns the status after ``before``, from a ``message`` of the running job's worker process."""

    def _worker_for_kind(self, kind: str) -> WorkerPool:
        """Returns the worker process for the function ``kind`` of ``WORK``; called with the lock held."""
        return WorkerPool(f"{self.WORK}:{kind}")

    def _keeps_worker(self, pool: WorkerPool) -> bool:
        """Whether the process of a finished job is kept for the next one."""
        return False

    def _start(self, status: S, question: list | dict, patience: float | None = None) -> None:
        """Starts the function ``status.kind`` of ``WORK`` with a ``question``; ``patience`` is its timeout in s."""
        with self._lock:
            if self.status.running or self._closed:
                return
            if not self.slots.acquire():
                self.status = replace(status, trouble=tr(self.BUSY, n=MOST_JOBS))
                return
            self.status = replace(status, running=True)
            self._pool = self._worker_for_kind(status.kind)
            job = self._pool.submit(question, with_language(self._on_message), patience)
        job.add_done_callback(with_language(self._end))

    def _on_message(self, message: dict[str, Any]) -> None:
        """Updates the status by a ``message`` of the running job; the next job waits until it has ended."""
        if trouble := message.get("trouble"):
            message = message | {"trouble": translate_message(trouble)}
        with self._lock:
            self.status = self.update_status(self.status, message)

    def _end(self, job: Future[dict]) -> None:
        """Releases the slot and records in the status how a ``job`` has ended, or why it could not start."""
        if self._pool is not None and not (job.exception() is None and self._keeps_worker(self._pool)):
            self._pool.close()
        with self._lock:
            trouble = None if self.status.cancelled else self.status.trouble
            error = None if self.status.cancelled else job.exception()
            if isinstance(error, OSError):
                trouble = tr("No process could be started: {reason}.", reason=error.strerror or error)
            elif error is not None:
                trouble = tr("the background process {has_ended}", has_ended=translate_message(str(error)))
            self.status, self._pool = replace(self.status, running=False, trouble=trouble), None
            self.slots.release()
