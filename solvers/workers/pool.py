"""Work in processes of its own, queued: a few processes, one queue before them, and a future for each question."""

import contextlib
import os
import threading
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future

from solvers.workers.processes import ProcessDied, WorkerProcess

NICENESS = 10  # of a process that gives way, more than that of the one that asks

Listener = Callable[[dict], object]


class WorkerPool:
    """So many processes for one kind of work (``"module:function"``, as of a
    :class:`~solvers.workers.processes.WorkerProcess`). One starts when a question comes and no other rests; when it has
    died, with the next question. Safe from any thread."""

    def __init__(self, work: str, processes: int = 1, environment: Mapping[str, str] | None = None):
        self._processes = tuple(WorkerProcess(work, environment) for _ in range(processes))
        self._lock = threading.Lock()
        self._resting = list(self._processes)  # the last has most of what it needs
        self._waiting: deque[tuple[Future[dict], tuple]] = deque()

    @property
    def process_ids(self) -> list[int]:
        """Of the processes that run now."""
        return [process.process_id for process in self._processes if process.process_id]

    def submit(self, question: Mapping | Sequence, on_answer: Listener = lambda _: None,
               patience: float | None = None) -> Future[dict]:
        """Queue a question. ``on_answer`` hears every answer, from a thread of the pool; the future holds the last one,
        or :class:`~solvers.workers.processes.ProcessDied` (after ``patience`` seconds of work at the latest), or the
        OSError for which no process could be started."""
        future: Future[dict] = Future()
        with self._lock:
            self._waiting.append((future, (question, on_answer, patience)))
            process = self._resting.pop() if self._resting else None
        if process:
            with contextlib.suppress(OSError, ProcessDied):  # as the future will say
                process.start()
            threading.Thread(target=self._work, args=(process,), name="worker-pool", daemon=True).start()
        return future

    def give_way(self) -> None:
        """Have the processes wait for whatever else wants a processor, from now on: there is no way back."""
        for process_id in self.process_ids:
            with contextlib.suppress(AttributeError, OSError):  # not everywhere is there such a thing
                os.setpriority(os.PRIO_PROCESS, process_id, os.getpriority(os.PRIO_PROCESS, 0) + NICENESS)

    def kill(self) -> None:
        """End all work at once, and for good; every future that is left learns it."""
        for process in self._processes:
            process.kill()

    def close(self) -> None:
        """The same, and wait until nothing is left behind; a process that rests may put away what it has compiled."""
        for process in self._processes:
            process.close()

    def _work(self, process: WorkerProcess) -> None:
        """Have a process answer questions for as long as there are any."""
        while waiting := self._next(process):
            future, (question, on_answer, patience) = waiting
            if not future.set_running_or_notify_cancel():
                continue
            answer: dict = {}
            try:
                with contextlib.closing(process.ask(question, patience)) as answers:
                    for answer in answers:
                        on_answer(answer)
            except BaseException as error:
                future.set_exception(error)
            else:
                future.set_result(answer)

    def _next(self, process: WorkerProcess) -> tuple[Future[dict], tuple] | None:
        with self._lock:
            if self._waiting:
                return self._waiting.popleft()
            self._resting.append(process)
            return None


class Slots:
    """Places for work on one machine: a piece of work takes one and gives it back. Safe from any thread."""

    def __init__(self, places: int):
        self._places, self._lock, self.taken = places, threading.Lock(), 0

    def take(self) -> bool:
        """Whether there was one left."""
        with self._lock:
            free = self.taken < self._places
            self.taken += free
            return free

    def give_back(self) -> None:
        with self._lock:
            self.taken -= 1
