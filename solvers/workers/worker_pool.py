"""Pool of worker processes, with one queue and a future for each question.

A process is faster at what it has done before, above all because it need not compile again. So a question may have a
``kind``. A single process takes the questions in order. One of several prefers the next one of a kind that it has had,
then one of a kind that no busy process has had, then one of a kind that a busy process has had: of short questions only
if ``several`` of these wait, because the other would finish one before this one has started.
"""

import contextlib
import os
import threading
from collections import deque
from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from concurrent.futures import Future
from dataclasses import dataclass
from typing import TypeVar

from solvers.workers.worker_process import ProcessDied, WorkerProcess

T = TypeVar("T")
NICENESS = 10  # of a low-priority process, relative to its parent

Listener = Callable[[dict], object]


@dataclass(frozen=True, eq=False)
class _QueuedQuestion:
    """Question in the queue of a pool: arguments and future of :meth:`WorkerPool.submit`."""

    future: Future[dict]
    question: Mapping | Sequence
    on_answer: Listener
    patience: float | None
    kind: Hashable


class WorkerPool:
    """Pool of ``processes`` processes for one function ``work`` ("module:function", as in a
    :class:`~solvers.workers.worker_process.WorkerProcess`), with additions to the ``environment``. One starts when a
    question comes and no other is idle; after a crash, with the next question. A process takes a question of a kind
    that only busy processes have had if at least ``several`` questions wait. Thread-safe."""

    def __init__(self, work: str, processes: int = 1, environment: Mapping[str, str] | None = None, several: int = 1):
        self._several = several
        self._processes = tuple(WorkerProcess(work, environment) for _ in range(processes))
        self._lock = threading.Lock()
        self._resting = list(self._processes)  # the last has most of what it needs
        self._had: dict[WorkerProcess, set[Hashable]] = {process: set() for process in self._processes}  # kinds
        self._waiting: deque[_QueuedQuestion] = deque()

    @property
    def process_ids(self) -> list[int]:
        """Ids of the running processes."""
        return [process.process_id for process in self._processes if process.process_id]

    def submit(self, question: Mapping | Sequence, on_answer: Listener = lambda _: None,
               patience: float | None = None, kind: Hashable = None) -> Future[dict]:
        """Queues a question, as for json, whose ``kind`` is what makes a process faster at the next one of it. Every
        answer is passed to ``on_answer``, in a thread of the pool. Returns the future of the last answer, or of a
        :class:`~solvers.workers.worker_process.ProcessDied` (after ``patience`` s of work, if not None), or of the
        OSError for which no process could be started."""
        future: Future[dict] = Future()
        with self._lock:
            self._waiting.append(_QueuedQuestion(future, question, on_answer, patience, kind))
            process = max(self._resting, key=lambda one: (kind in self._had[one], self._resting.index(one)),
                          default=None)
            if process:
                self._resting.remove(process)
        if process:
            with contextlib.suppress(OSError, ProcessDied):  # the future has the error
                process.start()
            threading.Thread(target=self._answer_questions, args=(process,), name="worker-pool", daemon=True).start()
        return future

    def lower_priority(self, idle: bool = False) -> None:
        """Lowers the priority of the running processes, irreversibly, where the system supports that; as ``idle`` ones
        they get only what all other work leaves of the processors."""
        for process_id in self.process_ids:
            with contextlib.suppress(AttributeError, OSError):  # not everywhere is there such a thing
                if idle:
                    os.sched_setscheduler(process_id, os.SCHED_IDLE, os.sched_param(0))
                else:
                    os.setpriority(os.PRIO_PROCESS, process_id, os.getpriority(os.PRIO_PROCESS, 0) + NICENESS)

    def kill(self) -> None:
        """Kills all processes at once, and for good; every pending future gets an error."""
        for process in self._processes:
            process.kill()

    def close(self) -> None:
        """Stops all processes for good, and waits until they are gone; an idle one may first store compiled kernels."""
        for process in self._processes:
            process.close()

    def _answer_questions(self, process: WorkerProcess) -> None:
        """Lets a process answer questions from the queue as long as there are any for it."""
        while waiting := self._next_question(process):
            if not waiting.future.set_running_or_notify_cancel():
                continue
            answer: dict = {}
            try:
                with contextlib.closing(process.ask(waiting.question, waiting.patience)) as answers:
                    for answer in answers:
                        waiting.on_answer(answer)
            except BaseException as error:
                self._had[process].clear()  # it begins anew
                waiting.future.set_exception(error)
            else:
                waiting.future.set_result(answer)

    def _next_question(self, process: WorkerProcess) -> _QueuedQuestion | None:
        """Takes the next question for a process out of the queue and returns it; None if the process becomes idle,
        because there is none, or other processes will be faster."""
        with self._lock:
            own = self._had[process]
            busy = set[Hashable]().union(*(kinds for other, kinds in self._had.items()
                                           if other is not process and other not in self._resting))
            taken = next((one for one in self._waiting if not busy or one.kind in own), None) \
                or next((one for one in self._waiting if one.kind not in busy), None) \
                or (self._waiting[0] if len(self._waiting) >= self._several else None)
            if taken is None:
                self._resting.append(process)
                return None
            self._waiting.remove(taken)
            own.add(taken.kind)
            return taken


def one_of_each_first(things: Iterable[T], kind: Callable[[T], Hashable]) -> list[T]:
    """Returns the things in an order with the first one of every kind, as ``kind(thing)`` returns it, in front: in this
    order, a pool's processes start with different kinds."""
    ahead: dict[Hashable, T] = {}
    rest = [thing for thing in things if ahead.setdefault(kind(thing), thing) is not thing]
    return [*ahead.values(), *rest]


class Slots:
    """Slots, ``count`` in all, for work on one machine: each piece of work takes one and releases it. Thread-safe."""

    def __init__(self, count: int):
        self._count, self._lock, self.taken = count, threading.Lock(), 0

    def acquire(self) -> bool:
        """Takes a slot; returns whether one was free."""
        with self._lock:
            free = self.taken < self._count
            self.taken += free
            return free

    def release(self) -> None:
        with self._lock:
            self.taken -= 1
