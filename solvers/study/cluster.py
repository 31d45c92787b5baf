"""Rows on an existing Dask cluster, through the executor of a Dask client.

On each worker one row is measured at a time, by a process that the worker keeps for that (``apart``), however many
threads the worker has: Taichi must not be called from several threads, and rows side by side would disturb each other's
timing. If the worker is killed its process ends too, and Dask runs the row on another worker.

mpm-lab must be installed on the workers. ``distributed`` is an optional dependency, imported only here.
"""

from __future__ import annotations

import functools
import logging
import time
from concurrent.futures import Future

from solvers.study.apart import RowProcess
from solvers.study.grid import Task
from solvers.study.places import PlaceLost

ANSWER_SECONDS = 10.0  # for the scheduler to answer
PATIENCE = 60.0  # seconds without a single worker


class NoCluster(Exception):
    """The cluster cannot be used; one sentence says why."""


@functools.cache
def _workers_process() -> RowProcess:
    return RowProcess()


def measure_on_worker(task: dict) -> dict:
    """What a worker runs: one row, in the worker's own row process."""
    return _workers_process().measure(Task(**task))


class Cluster:
    """The workers of a Dask scheduler at ``address``, such as ``tcp://host:8786``."""

    def __init__(self, address: str):
        try:
            from distributed import Client
        except ImportError:
            raise NoCluster("needs the package distributed; install mpm-lab[cluster]") from None
        for name in ("distributed.client", "distributed.core", "distributed.comm", "tornado.application"):
            logging.getLogger(name).setLevel(logging.CRITICAL)  # what goes wrong is said in one sentence
        try:
            self._client = Client(address, timeout=ANSWER_SECONDS, set_as_default=False, name="mpm-lab")
        except (OSError, ValueError, ImportError) as error:
            raise NoCluster(f"no Dask scheduler answers there ({type(error).__name__}); start one with "
                            "\"dask scheduler\" and give the address that it prints") from None
        self._address = address
        self._executor = self._client.get_executor(pure=False)
        self._seen = time.monotonic()

    @property
    def workers(self) -> int:
        """Workers there are now."""
        return len(self._client.scheduler_info(n_workers=-1)["workers"])

    def submit(self, task: Task) -> Future[dict]:
        return self._executor.submit(measure_on_worker, task.to_dict())

    def check(self) -> None:
        if self._client.status not in ("running", "connecting"):
            raise PlaceLost(f"the scheduler at {self._address} is gone")
        if self._client.status == "running" and self.workers:
            self._seen = time.monotonic()
        elif time.monotonic() - self._seen > PATIENCE:
            raise PlaceLost(f"the cluster at {self._address} has had no worker for {PATIENCE:g} seconds")

    def close(self) -> None:
        """Take back what waits. A row that is being measured is finished by its worker, and forgotten."""
        self._executor.shutdown(wait=False)
        self._client.close(timeout=2)
