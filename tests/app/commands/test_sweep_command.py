"""``mpm-lab sweep``: what it leaves, how it goes on, and its flags."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from concurrent.futures import Future
from pathlib import Path

import pytest

from app.cli import main
from app.commands import commands
from app.pictures.study import FIGURES
from solvers.study.grid import Task
from solvers.workers.processes import WorkerProcess
from tests.paths import ROOT
from tests.processes import HANG
from tests.rows import made_up, without_timings

SweepBar = commands()["sweep", "bar"]
#: A command line that is killed as soon as two rows are on the disk.
KILLED = """
import os, signal, sys
from app.cli import main
from solvers.study.store import Store
append = Store.append
def dying(store, row):
    append(store, row)
    if len(store.rows) == 2:
        os.kill(os.getpid(), signal.SIGKILL)
Store.append = dying
main(sys.argv[1:])
"""
SMOOTH = ["--cells", "20", "40", "80", "--method", "ugimp", "bspline", "--amplitude", "2.5e-4", "--periods", "1",
          "--repeats", "1"]


def sweep(*flags: str) -> list[str]:
    return [sys.executable, "-m", "app", "sweep", "bar", *flags]


@pytest.fixture(scope="module")
def whole(tmp_path_factory) -> Path:
    """The directory of a finished sweep."""
    out = tmp_path_factory.mktemp("sweep") / "whole"
    done = subprocess.run(sweep(*SMOOTH, "--out", str(out)), cwd=ROOT, capture_output=True, text=True, timeout=HANG)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("# Sweep of the bar") and "6/6" in done.stderr and "Taichi" not in done.stderr
    return out


def rows_of(directory: Path) -> list[dict]:
    return json.loads((directory / "table.json").read_text())["rows"]


def test_a_sweep_leaves_rows_tables_and_pictures(whole):
    assert {path.name for path in whole.iterdir()} == {"rows.jsonl", "table.csv", "table.json", "summary.md",
                                                       *(f"{name}.png" for name in FIGURES)}
    assert [(r["scene"]["method"], r["scene"]["cells"], r["status"]) for r in rows_of(whole)] == [
        (method, cells, "ok") for method in ("ugimp", "bspline") for cells in (20, 40, 80)]
    orders = [entry["orders"]["x"]["order"] for entry in json.loads((whole / "table.json").read_text())["fits"]]
    assert orders == pytest.approx([2, 2], abs=0.2)


@pytest.mark.skipif(os.name == "nt", reason="POSIX signals")
def test_killed_and_resumed_it_is_the_same_table(whole, tmp_path):
    rows = tmp_path / "out" / "rows.jsonl"
    killed = subprocess.run([sys.executable, "-c", KILLED, "sweep", "bar", *SMOOTH, "--out", str(rows.parent)],
                            cwd=ROOT, capture_output=True, timeout=HANG)
    assert killed.returncode == -signal.SIGKILL, killed.stderr
    before = rows.read_bytes()
    assert before.count(b"\n") == 2
    with open(rows, "ab") as file:
        file.write(b'{"schema": "mpm')
    assert main(["sweep", "bar", *SMOOTH, "--out", str(rows.parent), "--resume", "--quiet"]) == 0
    assert rows.read_bytes().startswith(before)
    assert [without_timings(r) for r in rows_of(rows.parent)] == [without_timings(r) for r in rows_of(whole)]


def test_resuming_a_finished_sweep_runs_nothing(whole, monkeypatch, capsys):
    monkeypatch.setattr(WorkerProcess, "ask", lambda *_: pytest.fail("it ran a row again"))
    before = (whole / "rows.jsonl").read_bytes()
    assert main(["sweep", "bar", *SMOOTH, "--out", str(whole), "--resume"]) == 0
    assert (whole / "rows.jsonl").read_bytes() == before and "6 of them there already" in capsys.readouterr().err


@pytest.mark.skipif(os.name == "nt", reason="POSIX signals")
def test_interrupt_is_one_line_and_keeps_the_rows(tmp_path):
    run = subprocess.Popen(sweep("--cells", "8", "--periods", "0.2", "1e5", "--out", str(tmp_path)), cwd=ROOT,
                           stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    said = [run.stderr.readline(), run.stderr.readline()]
    assert "1/2" in said[1]
    run.send_signal(signal.SIGINT)
    out, rest = run.communicate(timeout=HANG)
    assert (run.returncode, out, rest) == (130, "", "mpm-lab: interrupted\n")
    assert (tmp_path / "rows.jsonl").read_bytes().count(b"\n") == 1


class Instant:
    """A place that needs no time."""

    def __init__(self, workers: int, work: str): ...

    def submit(self, task: Task) -> Future:
        future = Future()
        future.set_result({**made_up(task.inputs["method"], task.inputs["cells"]), "key": task.key,
                           "asked": task.inputs})
        return future

    def check(self) -> None: ...

    def close(self) -> None: ...


def test_refused_combinations_are_rows(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr("solvers.study.places.Here", Instant)
    assert main(["sweep", "bar", "--method", "ugimp", "cpgimp", "--velocity", "corners", "--out", str(tmp_path)]) == 0
    rows = rows_of(tmp_path)
    assert [r["status"] for r in rows] == ["refused", "ok"] and "cpgimp" in rows[0]["reason"]
    assert capsys.readouterr().err.count("refused: velocity corners") == 1


def test_flags_become_axes(monkeypatch):
    seen = []
    monkeypatch.setattr(SweepBar, "execute", lambda self: seen.append(self.axes()) or 0)
    assert main(["sweep", "bar", "--cells", "20", "1e2", "--method", "mpm,ugimp", "--dt", "1e-3", "2e-3",
                 "--linearity-preserving", "--no-linearity-preserving", "--estimator", "none", "--amplitude", "0.1",
                 "--effects", "truth", "energy"]) == 0
    axes = seen[0]
    assert axes["cells"] == [20, 100] and axes["method"] == ["mpm", "ugimp"] and axes["dt"] == [1e-3, 2e-3]
    assert axes["linearity_preserving"] == [True, False] and axes["estimator"] == [()] and axes["amplitude"] == [0.1]
    assert axes["effects"] == [("truth", "energy")] and axes["cfl"] == [None] and axes["ppc"] == [4]
    assert main(["sweep", "ring", "--out", ""]) == 2


@pytest.mark.parametrize(("flags", "says"), [
    (["--cells", "20"], "--out (no value): give a directory"),
    (["--out", "x", "--cells", "2", "3"], "--cells 2: give a whole number from 4"),
    (["--out", "x", "--amplitude", "0.2", "0.3"], "--amplitude 0.2: the exact bar inverts"),
    (["--out", "x", "--cells"], "--cells (no value): give a whole number"),
    (["--out", "x", "--dt", "1e-3", "--cfl", "0.1", "0.2"], "--cfl 0.1: dt is given too"),
    (["--out", "x", "--workers", "0"], "--workers 0: give a whole number from 1 to 1,024"),
    (["--out", "x", "--repeats", "many"], "--repeats many: give a whole number"),
    (["--out", "x", "--scheduler", "there"], "--scheduler there: give the address of a Dask scheduler"),
    (["--out", "x", "--scheduler", "tcp://a:1", "--workers", "2"], "--workers 2: is for this machine"),
    (["--out", "x", "--modulus", *map(str, range(1, 200)), "--cells", *map(str, range(4, 100))], "too many"),
    (["--out", "file"], "--out file: is a file"),
    (["--out", "."], "--out .: is not empty"),
    (["--out", "x", "--cellz", "3"], "did you mean --cells?"),
])
def test_bad_input_is_one_line_that_names_the_flag(flags, says, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").touch()
    assert main(["sweep", "bar", *flags]) == 2
    seen = capsys.readouterr()
    assert seen.out == "" and seen.err.count("\n") == 1 and says in seen.err
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


def test_help_and_bad_input_import_nothing_heavy():
    code = ("import sys; from app.cli import main; main(['sweep', 'bar', '--help']); main(['sweep', 'bar']); "
            "sys.exit(any(name in sys.modules for name in ('taichi', 'viser', 'matplotlib', 'distributed')))")
    assert subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, timeout=HANG).returncode == 0
