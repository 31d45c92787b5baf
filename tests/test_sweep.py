"""Sweeps: tasks, rows, their safety on disk, lost workers, tables, pictures and the command."""

from __future__ import annotations

import csv
import io
import json
import os
import signal
import subprocess
import sys
import threading
from concurrent.futures import Future
from pathlib import Path

import matplotlib.image
import numpy as np
import pytest

from app.cli import main
from app.commands import commands
from app.pictures.run import png_bytes
from app.pictures.study import FIGURES, error_spacing_figure, error_time_figure
from app.pictures.study_parts import UNSTABLE_LOOK
from app.pictures.study_step import error_step_figure
from solvers.bar.scene import BarScene
from solvers.processes import ProcessDied, WorkerProcess
from solvers.study import fit, row, series
from solvers.study import summary as table
from solvers.study.grid import Task, combinations, plan
from solvers.study.places import ATTEMPTS, Here, PlaceLost, execute, row_process
from solvers.study.store import Store, StoreError
from tests.processes import HANG, processor_seconds, until
from tests.rows import made_up, without_timings

SweepBar = commands()["sweep", "bar"]

ROOT = Path(__file__).resolve().parent.parent
QUICK = {"cells": 8, "ppc": 2, "periods": 0.2}
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


# ---- tasks ------------------------------------------------------------------------------------------------


def test_every_combination_once_in_order():
    assert combinations({"a": [1, 2], "b": "xy"}) == [{"a": 1, "b": "x"}, {"a": 1, "b": "y"}, {"a": 2, "b": "x"},
                                                      {"a": 2, "b": "y"}]
    tasks = plan("bar", {"method": ["mpm", "ugimp"], "cells": [20, 40, 20]})
    assert [tuple(task.inputs.values()) for task in tasks] == [("mpm", 20), ("mpm", 40), ("ugimp", 20), ("ugimp", 40)]


def test_a_key_belongs_to_the_scene_not_to_its_wording():
    key = Task("bar", {"cells": 40}).key
    assert key == Task("bar", {"cells": 40, "cfl": 0.05, "modulus": 4, "ppc": None or 4}, repeats=9).key
    assert key != Task("bar", {"cells": 41}).key != Task("ring", {"cells": 41}).key
    refused = [Task("bar", {"amplitude": a}).key for a in (0.2, 0.3)]
    assert len({key, *refused}) == 3


def test_a_task_survives_json():
    task = plan("bar", {"estimator": [("transport",)], "effects": [()], "amplitude": [float("nan")]}, repeats=2)[0]
    assert Task(**json.loads(json.dumps(task.to_dict(), allow_nan=False))).key == task.key
    assert task.refusal().field == "amplitude"


# ---- one row ----------------------------------------------------------------------------------------------


def test_a_row_holds_the_run_and_what_it_cost():
    found = row.measure(Task("bar", QUICK, repeats=2, price_effects=True, version="7"))
    assert (found["status"], found["reason"], found["version"], found["h"]) == ("ok", None, "7", 1 / 8)
    assert found["scene"] == BarScene(cells=8, ppc=2, periods=0.2).to_dict()
    assert found["particle_steps"] == found["steps"] * found["particles"] > 0
    for part in ("estimate", "index", "distance"):
        assert set(found[part]) == {"transport"} and found[part]["transport"]["x"] is not None
    seconds = found["seconds"]
    assert len(seconds["repeats"]) >= 2 and seconds["min"] == min(seconds["repeats"]) > 0
    assert set(seconds["effects"]) == {"truth", "crossings", "energy", "acceleration", "soundness", "margin"}
    assert found["rate"] == pytest.approx(1e-6 * found["particle_steps"] / seconds["min"])
    json.dumps(found, allow_nan=False)


def test_the_timed_run_computes_nothing_but_the_method(monkeypatch):
    import solvers.run
    seen, real = [], solvers.run.run
    monkeypatch.setattr(solvers.run, "run", lambda scene, **options: seen.append(scene) or real(scene, **options))
    row.time_bare(BarScene(cells=8), 2)
    assert len(seen) > 2 and seen[0].steps < seen[1].steps  # warmed up first
    assert {(scene.effects, scene.estimators) for scene in seen} == {((), ())}


def test_bad_runs_are_rows(monkeypatch):
    unstable = row.measure(Task("bar", {**QUICK, "periods": 5, "cfl": 1.5}, repeats=1))
    assert unstable["status"] == "unstable" and "unstable" in unstable["reason"] and unstable["seconds"]["min"] > 0
    refused = row.measure(Task("bar", {"amplitude": 0.2}))
    assert refused["status"] == "refused" and "inverts" in refused["reason"] and refused["scene"] is None
    monkeypatch.setattr("solvers.run.build", lambda scene: (_ for _ in ()).throw(MemoryError("no\nroom")))
    failed = row.measure(Task("bar", QUICK))
    assert (failed["status"], failed["reason"]) == ("failed", "MemoryError: no room")


def test_a_process_that_dies_says_so_and_starts_again():
    process = row_process()

    def measured(task: Task) -> dict:
        [found] = process.ask(task.to_dict())
        return found

    try:
        assert row.measure(Task("bar", QUICK, repeats=1)).keys() == measured(Task("bar", QUICK, 1)).keys()
        first = process.process_id
        idle = processor_seconds(first)
        killer = threading.Thread(target=lambda: (
            until(lambda: processor_seconds(first) > idle + 0.1, "a row under way"), os.kill(first, signal.SIGKILL)))
        killer.start()
        with pytest.raises(ProcessDied, match="SIGKILL"):
            measured(Task("bar", {"cells": 100, "periods": 10_000}, 1))
        assert process.process_id is None
        assert measured(Task("bar", QUICK, 1))["status"] == "ok" and process.process_id != first
    finally:
        process.close()
    assert process.process_id is None


# ---- many rows --------------------------------------------------------------------------------------------


class Fragile:
    """A place that loses the workers of some tasks so many times."""

    def __init__(self, losses: dict[int, int]):
        self.losses, self.calls = losses, 0

    def submit(self, task: Task) -> Future:
        self.calls += 1
        future, cells = Future(), task.inputs["cells"]
        self.losses[cells] = self.losses.get(cells, 0) - 1
        if self.losses[cells] >= 0:
            future.set_exception(ProcessDied("was ended by SIGKILL"))
        else:
            future.set_result({"key": task.key, "status": "ok", "cells": cells})
        return future

    def check(self) -> None: ...


def test_lost_workers_are_replaced_and_a_deadly_row_is_given_up():
    rows, place = [], Fragile({8: ATTEMPTS - 1, 9: 100})
    tasks = plan("bar", {"cells": [7, 8, 9, 10]})
    execute(tasks, place, rows.append)
    found = {row["key"]: row for row in rows}
    assert [found[task.key]["status"] for task in tasks] == ["ok", "ok", "failed", "ok"]
    assert place.calls == 2 + 2 * ATTEMPTS and len(rows) == 4
    assert f"{ATTEMPTS} times" in found[tasks[2].key]["reason"] and "SIGKILL" in found[tasks[2].key]["reason"]


def test_a_place_that_is_gone_ends_the_sweep():
    class Gone(Fragile):
        def submit(self, task):
            future = Future()
            future.cancel()
            future.set_running_or_notify_cancel()
            return future

    with pytest.raises(PlaceLost, match="lost"):
        execute(plan("bar", {"cells": [8]}), Gone({}), pytest.fail)


def test_rows_run_in_processes_of_their_own_and_these_end():
    place, rows = Here(workers=2), []
    execute(plan("bar", {**{name: [value] for name, value in QUICK.items()}, "cells": [8, 9, 10]}, repeats=1), place,
            rows.append)
    processes = place.process_ids
    place.close()
    assert sorted(row["scene"]["cells"] for row in rows) == [8, 9, 10] and 1 <= len(processes) <= 2
    assert os.getpid() not in processes
    for process in processes:
        with pytest.raises(ProcessLookupError):
            os.kill(process, 0)


# ---- rows on disk -----------------------------------------------------------------------------------------


def test_a_row_cut_short_is_measured_again(tmp_path):
    store = Store(tmp_path / "new", "bar")
    kept, lost = made_up(cells=20), made_up(cells=40)
    store.append(kept)
    store.append(lost)
    store.close()
    path = tmp_path / "new" / "rows.jsonl"
    path.write_bytes(path.read_bytes()[:-40])
    store = Store(tmp_path / "new", "bar", resume=True)
    assert store.finished(kept["key"]) and not store.finished(lost["key"])
    store.append(lost)
    store.close()
    assert [json.loads(line) for line in path.read_text().splitlines()] == [kept, lost]


def test_what_failed_is_tried_again(tmp_path):
    store = Store(tmp_path, "bar")
    store.append(made_up(status="failed"))
    assert not store.finished(made_up()["key"])
    store.append(made_up(status="unstable"))
    assert store.finished(made_up()["key"]) and len(store.rows) == 1
    store.close()


@pytest.mark.parametrize(("content", "problem", "resume", "says"), [
    ({"rows.jsonl": "{}\n"}, "bar", False, "--resume"),
    ({"letter.txt": "dear"}, "bar", False, "is not empty"),
    ({"letter.txt": "dear"}, "bar", True, "no rows.jsonl"),
    ({"rows.jsonl": "what\n"}, "bar", True, "line 1"),
    ({"rows.jsonl": json.dumps(made_up()) + "\n"}, "ring", True, "rows of the bar"),
])
def test_a_directory_that_is_not_ours_is_refused(tmp_path, content, problem, resume, says):
    for name, text in content.items():
        (tmp_path / name).write_text(text)
    with pytest.raises(StoreError, match=says):
        Store(tmp_path, problem, resume)
    assert {path.name: path.read_text() for path in tmp_path.iterdir()} == content


@pytest.mark.skipif(os.name == "nt", reason="POSIX locks")
def test_two_sweeps_do_not_write_to_one_file(tmp_path):
    store = Store(tmp_path, "bar")
    with pytest.raises(StoreError, match="another sweep"):
        Store(tmp_path, "bar", resume=True)
    store.close()


# ---- what rows say ----------------------------------------------------------------------------------------


def test_slopes_front_and_balance_of_known_data():
    h = np.array([0.1, 0.05, 0.025])
    found = fit.slope(h, 3 * h**1.7)
    assert (found.order, found.factor, found.points) == (pytest.approx(1.7), pytest.approx(3), 3)
    assert found.pairwise == pytest.approx((1.7, 1.7))
    assert fit.slope([0.1, 0.1], [1, 2]) is None and fit.slope([0.1, 0.2], [0, 1]) is None
    assert fit.pareto([1, 2, 3, 4], [4, 2, 3, 1]) == [0, 1, 3]
    dt = np.geomspace(1e-4, 1e-2, 7)
    for power in (1, 2):
        found = fit.balance(dt, 1e-3 * (1 + (dt / 2e-3) ** power))
        assert (found.power, found.dt) == (power, pytest.approx(2e-3)) and found.misfit < 1e-9
    assert fit.balance(dt, np.full(7, 2.0)).dt is None and fit.balance(dt, np.full(7, 2.0)).space_rules
    assert not fit.balance(dt, dt).space_rules and fit.balance(dt[:2], dt[:2]) is None


def test_the_brink_of_stability_is_no_time_error():
    dt = np.geomspace(1e-4, 6.4e-3, 7)
    error = 1e-3 * (1 + dt / 1e-3)
    error[-1] *= 1000
    assert fit.balance(dt, error).dt == pytest.approx(1e-3)


def test_series_are_alike_but_for_one_input():
    rows = [made_up(method, cells, cfl) for method in ("ugimp", "bspline") for cells in (40, 20) for cfl in (0.1, 0.2)]
    lines = series.series(rows)
    assert [(line.method, line.inputs["cfl"]) for line in lines] == [
        (method, cfl) for method in ("ugimp", "bspline") for cfl in (0.1, 0.2)]
    assert [row["scene"]["cells"] for row in lines[0].rows] == [20, 40]
    assert next(line.inputs for line in series.series(rows, "dt")) == {"method": "ugimp", "cells": 40}
    assert all(entry["orders"]["x"]["order"] == pytest.approx(2) for entry in series.fits(rows))


def test_unstable_rows_are_not_fitted():
    rows = [made_up(cells=20), made_up(cells=40), made_up(cells=80, order=-3, status="unstable")]
    assert series.fits(rows)[0]["orders"]["x"]["points"] == 2


def test_the_table_has_a_column_for_everything():
    refusal = row.refused(task := Task("bar", {"amplitude": 0.2}), task.refusal())
    lines = list(csv.DictReader(io.StringIO(table.csv_text([refusal, made_up(), made_up(cells=40)]))))
    assert [line["status"] for line in lines] == ["refused", "ok", "ok"]
    assert lines[0]["scene.amplitude"] == "0.2" and lines[0]["error.x.max"] == ""
    assert float(lines[2]["error.x.max"]) == 40**-2 and float(lines[1]["index.transport.x"]) == 1.1


def test_the_summary_says_what_went_wrong_once_for_each_reason():
    rows = [made_up(cells=20), *(made_up(cells=cells, status="unstable") for cells in (40, 80))]
    text = table.summary("bar", rows)
    assert "1 ok, 2 unstable" in text and text.count("too long") == 1 and "and 1 more" in text
    assert "Nothing to fit" in text and "Nothing to fit" not in table.summary("bar", [made_up(), made_up(cells=40)])


# ---- pictures ---------------------------------------------------------------------------------------------

MANY = [made_up(method, cells, cfl) for method in ("mpm", "ugimp", "cpgimp", "bspline") for cells in (20, 40, 80)
        for cfl in (0.05, 0.1, 0.2)]
STATES = {"many": MANY, "one": [made_up()], "none": [], "no truth": [made_up(error={q: {} for q in "xva"})],
          "no estimate": [made_up(estimate=None), made_up(cells=40, estimate=None)],
          "all unstable": [made_up(cells=cells, status="unstable") for cells in (20, 40)],
          "beyond numbers": [made_up(), made_up(cells=40, status="unstable", error={"x": {"max": None}, "v": {"max":
                                                                                           1e300}, "sigma": {}})],
          "refused": [row.refused(task := Task("bar", {"amplitude": 0.2}), task.refusal())]}


@pytest.mark.parametrize("state", STATES)
@pytest.mark.parametrize("name", FIGURES)
def test_there_is_a_picture_of_every_state(name, state):
    content = png_bytes(FIGURES[name](STATES[state]))
    assert matplotlib.image.imread(io.BytesIO(content)).shape[0] > 100


@pytest.mark.parametrize("name", FIGURES)
def test_nothing_to_show_is_said(name):
    assert any("nothing to show" in text.get_text() for text in FIGURES[name]([]).axes[0].texts)


def test_unstable_runs_are_crosses_and_not_dropped():
    rows = [made_up(cells=20), made_up(cells=40), made_up(cells=80, status="unstable", error={"x": {"max": None}})]
    for figure in (error_time_figure(rows), error_spacing_figure(rows)):
        crosses = [line for line in figure.axes[0].get_lines() if line.get_marker() == UNSTABLE_LOOK["marker"]]
        assert len(crosses) == 1


def test_orders_and_balance_are_shown():
    shown = error_spacing_figure(MANY[:1] + MANY[3:4]).axes[0].get_legend().get_texts()
    assert [text.get_text() for text in shown] == ["order 2.00"]
    rows = [made_up(cells=20, cfl=cfl, error={"x": {"max": 1 + cfl / 0.1}}) for cfl in (0.025, 0.05, 0.1, 0.2)]
    stars = [line for line in error_step_figure(rows).axes[0].get_lines() if line.get_marker() == "*"]
    assert stars[0].get_xdata()[0] == pytest.approx(rows[2]["scene"]["dt"])


# ---- the command ------------------------------------------------------------------------------------------


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

    def __init__(self, workers: int): ...

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
