"""Recordings made side by side, each by a process of its own that does nothing else."""

from collections.abc import Callable, Sequence
from contextlib import closing
from dataclasses import asdict
from typing import Any

from app.export.record import Wanted
from solvers.workers.pool import WorkerPool

WORK = "app.export.record:work"


def recordings(wanted: Sequence[Wanted], processes: int, on_progress: Callable[[int], None]) -> list[dict[str, Any]]:
    """A recording for each of the wanted ones, in their order; ``on_progress`` is told how many there are so far.

    Raises :class:`~solvers.workers.processes.ProcessDied` where one cannot be made.
    """
    with closing(WorkerPool(WORK, processes)) as pool:
        found = []
        for recording in [pool.submit(asdict(one)) for one in wanted]:
            found.append(recording.result())
            on_progress(len(found))
        return found
