"""Recordings made side by side, each by a process of its own that does nothing else."""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict
from typing import Any

from app.export.record import Wanted
from solvers.workers.processes import WorkerPool

WORK = "app.export.record:work"


def recordings(wanted: Sequence[Wanted], processes: int, on_progress: Callable[[int], None]) -> list[dict[str, Any]]:
    """A recording for each of the wanted ones, in their order; ``on_progress`` is told how many there are so far.

    Raises :class:`~solvers.workers.processes.ProcessDied` where one cannot be made.
    """
    pool = WorkerPool(WORK, processes)

    def record(one: Wanted) -> dict[str, Any]:
        with pool.lent() as process:
            [answer] = process.ask(asdict(one))
            return answer

    found = []
    threads = ThreadPoolExecutor(processes)
    try:
        for recording in threads.map(record, wanted):
            found.append(recording)
            on_progress(len(found))
        return found
    finally:
        threads.shutdown(wait=False, cancel_futures=True)
        pool.close()
