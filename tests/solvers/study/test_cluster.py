"""Rows on a real Dask cluster: a scheduler and two workers on this machine, one of them killed half way."""

import os
import signal
import subprocess
import sys
from collections.abc import Iterator

import pytest

from app.cli import main
from solvers.study import executors
from solvers.study.parameter_grid import plan_tasks
from solvers.workers.worker_process import free_port
from tests.groups import require_group
from tests.support.fake_rows import without_timings
from tests.support.paths import ROOT
from tests.support.processes import wait_until

AXES = {"method": ["mpm", "ugimp"], "cells": [8, 16], "periods": [1.0]}


def start(module: str, *arguments: str) -> subprocess.Popen:
    return subprocess.Popen([sys.executable, "-m", f"distributed.cli.{module}", *arguments, "--no-dashboard"],
                            cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


@pytest.fixture(scope="module")
def dask() -> None:
    """Dask's distributed, or no test."""
    require_group("cluster")


@pytest.fixture
def workers(dask, tmp_path) -> Iterator[tuple[str, list[subprocess.Popen]]]:
    """The scheduler's address, and two workers that nobody restarts."""
    port = free_port()
    address = f"tcp://127.0.0.1:{port}"
    scheduler = start("dask_scheduler", "--host", "127.0.0.1", "--port", str(port))
    flags = (address, "--nthreads", "1", "--no-nanny", "--local-directory", str(tmp_path))
    processes = [start("dask_worker", *flags) for _ in range(2)]
    try:
        yield address, processes
    finally:
        for process in (*processes, scheduler):
            process.kill()
            process.wait()


def wait_for_workers(place: executors.DaskExecutor, count: int) -> None:
    wait_until(lambda: place.worker_count == count, f"{count} workers")


def test_rows_are_measured_on_a_cluster(dask):
    """A scheduler and a worker in this process; the row has one of its own."""
    from distributed import LocalCluster

    rows = []
    with LocalCluster(n_workers=1, threads_per_worker=1, processes=False, protocol="tcp",
                      dashboard_address=None) as one:
        place = executors.DaskExecutor(one.scheduler_address)
        try:
            executors.execute(plan_tasks("bar", {"cells": [8], "periods": [1.0]}, repeats=1), place, rows.append)
        finally:
            place.close()
    assert [(row["status"], row["scene"]["cells"]) for row in rows] == [("ok", 8)]


@pytest.mark.slow
def test_a_killed_worker_costs_no_row(workers, monkeypatch):
    monkeypatch.setattr(executors, "ANSWER_SECONDS", 60.0)  # the scheduler may only just be starting
    address, processes = workers
    place, rows = executors.DaskExecutor(address), []
    wait_for_workers(place, 2)

    def keep(found: dict) -> None:
        rows.append(found)
        if len(rows) == 1:
            os.kill(processes[0].pid, signal.SIGKILL)

    tasks = plan_tasks("bar", AXES, repeats=1)
    try:
        executors.execute(tasks, place, keep)
        wait_for_workers(place, 1)
    finally:
        place.close()
    here, same = executors.LocalExecutor(), []
    executors.execute(tasks, here, same.append)
    here.close()
    both = [{found["key"]: without_timings(found) for found in measured} for measured in (rows, same)]
    assert len(rows) == len(tasks) and both[0] == both[1]


@pytest.mark.parametrize(("absent", "says"), [
    (False, "--scheduler tcp://127.0.0.1:1: no Dask scheduler answers"), (True, "mpm-lab[cluster]")])
def test_no_scheduler_or_no_distributed_is_one_line(absent, says, dask, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(executors, "ANSWER_SECONDS", 0.5)
    if absent:
        monkeypatch.setitem(sys.modules, "distributed", None)
    assert main(["sweep", "bar", "--scheduler", "tcp://127.0.0.1:1", "--out", str(tmp_path / "x")]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1 and says in said
    assert list(tmp_path.iterdir()) == []
