"""Executors of tasks, and how every task ends as a row there.

An executor takes tasks and returns futures: :class:`LocalExecutor` those of a pool of processes, :class:`DaskExecutor`
those of a Dask client, on whose workers mpm-lab must be installed. On each worker one row is measured at a time, by a
process that the worker keeps for that, however many threads it has: rows side by side would disturb each other's
timing. If the worker is killed its process ends too, and Dask runs the row on another. ``distributed`` is an optional
dependency, imported only where a cluster is used.
"""

import functools
import logging
import os
import time
from collections import Counter
from collections.abc import Callable, Hashable, Iterable, Sequence
from concurrent.futures import FIRST_COMPLETED, CancelledError, Future, wait
from typing import Any, Protocol

from solvers.scene.extension_modules import EXTENSIONS
from solvers.study.parameter_grid import Task
from solvers.study.row import failed_row, measure
from solvers.workers.worker_pool import WorkerPool
from solvers.workers.worker_process import WorkerProcess

MEASURE_ROW = f"{__name__}:measure_in_worker"
ATTEMPTS = 3  # lost workers until a row is given up
LOOK_SECONDS = 1.0
ANSWER_SECONDS = 10.0  # for the scheduler of a cluster to answer
PATIENCE = 60.0  # seconds without a single worker


class ExecutorLost(Exception):
    """Error of an executor that can measure no more rows; one sentence says why and what to do."""


class ClusterUnavailable(Exception):
    """Error for a cluster that cannot be used; one sentence says why."""


class MeasurementTask(Protocol):
    """Task that is measured as a row, such as a :class:`~solvers.study.parameter_grid.Task`."""

    @property
    def key(self) -> str:
        """Key of its row."""

    @property
    def kind(self) -> Hashable:
        """Key of the kernels that it needs: tasks of the same kind are given to the same process."""

    def remarks(self) -> Sequence[str]:
        """Returns warnings about the task, or why it is refused, as sentences for the user."""

    def to_dict(self) -> dict:
        """Returns itself for JSON."""


def execute(tasks: Iterable[Any], place: "LocalExecutor | DaskExecutor", on_row: Callable[[dict], None],
            give_up: Callable[[Any, str], dict] = failed_row) -> None:
    """Measures every task. A lost worker is replaced; a row that keeps losing workers is marked as failed.

    The executor ``place`` measures the ``tasks``, which are :class:`MeasurementTask` objects. ``on_row`` is called with
    each row (``solvers.study.row``) as it comes, in the caller's thread; ``give_up`` returns the row of a failed task,
    from the task and the reason. Raises :class:`ExecutorLost` where the executor can measure no more.
    """
    lost: Counter[str] = Counter()
    waiting = {place.submit(task): task for task in tasks}
    while waiting:
        done, _ = wait(waiting, LOOK_SECONDS, FIRST_COMPLETED)
        for future in [future for future in waiting if future in done]:  # in the order of the tasks
            task = waiting.pop(future)
            if row := _row_of_future(task, future, lost, give_up):
                on_row(row)
            else:
                waiting[place.submit(task)] = task
        if not done:
            place.check()


def _row_of_future(task: MeasurementTask, future: Future[dict], lost: Counter[str],
                   give_up: Callable[[Any, str], dict]) -> dict | None:
    """Returns the row of a task, or None where it must be measured again; counts lost workers in ``lost``."""
    try:
        error = future.exception()
    except CancelledError:
        raise ExecutorLost("the connection to the workers was lost") from None
    if error is None:
        return future.result()
    lost[task.key] += 1
    given_up = type(error).__name__ == "KilledWorker"  # Dask has tried it on several workers
    if lost[task.key] < ATTEMPTS and not given_up:
        return None
    times = "several times" if given_up else f"{ATTEMPTS} times"
    return give_up(task, f"lost its worker {times}; the last one: {type(error).__name__}: {error}")


def measure_in_worker(task: dict, answer: Callable[[dict], None]) -> None:
    """Measures a task (as a dict) in a worker process, and passes its row to ``answer``."""
    from solvers.running.run import reuse_solvers  # here: Taichi is for workers

    reuse_solvers()
    answer(measure(Task(**task)))


class LocalExecutor:
    """Processes on this machine that do this ``work`` ("module:function"). One by default, because rows that run side
    by side disturb each other's timing."""

    def __init__(self, workers: int = 1, work: str = MEASURE_ROW):
        self.pool = WorkerPool(work, workers)

    def submit(self, task: MeasurementTask) -> Future[dict]:
        return self.pool.submit(task.to_dict(), kind=task.kind)

    def check(self) -> None:
        """Does nothing: this machine is always available."""

    def close(self) -> None:
        self.pool.close()


@functools.cache
def _cached_process(work: str, extensions: str) -> WorkerProcess:
    return WorkerProcess(work, {EXTENSIONS: extensions})


def measure_on_cluster(work: str, task: dict, extensions: str) -> dict:
    """Returns the row of a task, measured on a cluster's worker by that worker's own process for this ``work``."""
    [row] = _cached_process(work, extensions).ask(task)
    return row


class DaskExecutor:
    """Executor on the workers of a Dask scheduler at ``address``, such as ``tcp://host:8786``."""

    def __init__(self, address: str, work: str = MEASURE_ROW):
        try:
            from distributed import Client
        except ImportError:
            raise ClusterUnavailable("needs the package distributed; install mpm-lab[cluster]") from None
        for name in ("distributed.client", "distributed.core", "distributed.comm", "tornado.application"):
            logging.getLogger(name).setLevel(logging.CRITICAL)  # errors are reported in one sentence
        try:
            self._client = Client(address, timeout=ANSWER_SECONDS, set_as_default=False, name="mpm-lab")
        except (OSError, ValueError, ImportError) as error:
            raise ClusterUnavailable(f"no Dask scheduler answers there ({type(error).__name__}); start one with "
                                     "\"dask scheduler\" and give the address that it prints") from None
        self._address, self._work = address, work
        self._executor = self._client.get_executor(pure=False)
        self._seen = time.monotonic()

    @property
    def worker_count(self) -> int:
        """Number of workers now."""
        return len(self._client.scheduler_info(n_workers=-1)["workers"])

    def submit(self, task: MeasurementTask) -> Future[dict]:
        return self._executor.submit(measure_on_cluster, self._work, task.to_dict(), os.environ.get(EXTENSIONS, ""))

    def check(self) -> None:
        """Raises :class:`ExecutorLost` if the scheduler is gone, or no worker has been there for a minute."""
        if self._client.status not in ("running", "connecting"):
            raise ExecutorLost(f"the scheduler at {self._address} is gone")
        if self._client.status == "running" and self.worker_count:
            self._seen = time.monotonic()
        elif time.monotonic() - self._seen > PATIENCE:
            raise ExecutorLost(f"the cluster at {self._address} has had no worker for {PATIENCE:g} seconds")

    def close(self) -> None:
        """Cancels waiting tasks. A row that is being measured is finished by its worker, and discarded."""
        self._executor.shutdown(wait=False)
        self._client.close(timeout=2)
