"""Where rows are measured. A place takes tasks and gives futures; ``execute`` does not care which place it is.

Every place runs its rows over a standard ``concurrent.futures.Executor``: :class:`Here` over threads of which each
waits for a process (``apart``), :class:`~solvers.study.cluster.Cluster` over the executor of a Dask client.
"""

from __future__ import annotations

from concurrent.futures import Future, ThreadPoolExecutor
from queue import SimpleQueue
from typing import Protocol

from solvers.study.apart import RowProcess
from solvers.study.grid import Task


class PlaceLost(Exception):
    """The place can measure no more rows; one sentence says why and what to do."""


class Place(Protocol):
    """Somewhere to measure rows."""

    def submit(self, task: Task) -> Future[dict]:
        """Queue a task. The future holds its row, or the way in which its worker was lost."""
        ...

    def check(self) -> None:
        """Raise :class:`PlaceLost` if waiting is in vain."""
        ...

    def close(self) -> None:
        """Stop everything at once."""
        ...


class Here:
    """Processes on this machine. One, unless told otherwise: rows that run side by side disturb each other's timing."""

    def __init__(self, workers: int = 1):
        self._processes = [RowProcess() for _ in range(workers)]
        self._idle: SimpleQueue[RowProcess] = SimpleQueue()
        for process in self._processes:
            self._idle.put(process)
        self._executor = ThreadPoolExecutor(workers, thread_name_prefix="row")

    @property
    def process_ids(self) -> list[int]:
        """Of the processes that run now."""
        return [process.process_id for process in self._processes if process.process_id]

    def submit(self, task: Task) -> Future[dict]:
        return self._executor.submit(self._measure, task)

    def check(self) -> None:
        """This machine is always there."""

    def close(self) -> None:
        self._executor.shutdown(wait=False, cancel_futures=True)
        for process in self._processes:
            process.close()
        self._executor.shutdown()

    def _measure(self, task: Task) -> dict:
        process = self._idle.get()
        try:
            return process.measure(task)
        finally:
            self._idle.put(process)
