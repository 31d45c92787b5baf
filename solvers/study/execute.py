"""Every task ends as a row: a lost worker is replaced, a row that keeps losing its workers is marked as failed."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable
from concurrent.futures import FIRST_COMPLETED, CancelledError, Future, wait

from solvers.study.grid import Task
from solvers.study.places import Place, PlaceLost
from solvers.study.row import failed

ATTEMPTS = 3
LOOK_SECONDS = 1.0


def execute(tasks: Iterable[Task], place: Place, on_row: Callable[[dict], None]) -> None:
    """Measure every task at a place, and hand each row over as it comes, in the caller's thread."""
    lost: Counter[str] = Counter()
    waiting = {place.submit(task): task for task in tasks}
    while waiting:
        done, _ = wait(waiting, LOOK_SECONDS, FIRST_COMPLETED)
        for future in done:
            task = waiting.pop(future)
            try:
                on_row(_outcome(task, future, lost))
            except _Again:
                waiting[place.submit(task)] = task
        if not done:
            place.check()


class _Again(Exception):
    """The row is to be measured once more."""


def _outcome(task: Task, future: Future[dict], lost: Counter[str]) -> dict:
    try:
        error = future.exception()
    except CancelledError:
        raise PlaceLost("the connection to the workers was lost") from None
    if error is None:
        return future.result()
    lost[task.key] += 1
    given_up = type(error).__name__ == "KilledWorker"  # Dask has tried it on several workers
    if lost[task.key] < ATTEMPTS and not given_up:
        raise _Again
    times = "several times" if given_up else f"{ATTEMPTS} times"
    return failed(task, f"lost its worker {times}; the last one: {type(error).__name__}: {error}")
