"""A fifth estimator, added from outside by one object and one registration (``tests/zero_estimator.py``).

Everything that knows estimators must take it as one of its own: command line, rows, tables, pictures; the page is in
``tests/browser/problems/test_extension_page.py``. Processes of their own, because this one has compiled its solvers
without it.
"""

from __future__ import annotations

import csv
import json
import os
import subprocess
import sys

import pytest

from solvers.scene.registry import ESTIMATORS, EXTENSIONS
from tests.paths import ROOT
from tests.processes import HANG

ENVIRONMENT = {EXTENSIONS: "tests.zero_estimator"}
FIVE = [*ESTIMATORS, "zero"]
#: Here all of them hold, and say something of every quantity.
QUICK = ["--cells", "20", "--ppc", "2", "--amplitude", "0.004", "--periods", "0.2", "--linearity-preserving"]


def python(*arguments: str, environment: dict[str, str] = ENVIRONMENT) -> subprocess.CompletedProcess:
    return subprocess.run([sys.executable, *arguments], cwd=ROOT, capture_output=True, text=True, timeout=HANG,
                          env={**os.environ, **environment})


def command(*arguments: str, **options) -> subprocess.CompletedProcess:
    """Run ``mpm-lab`` as a person would who has the extension."""
    return python("-m", "app", *arguments, **options)


def test_a_run_has_all_five(tmp_path):
    """Index 0 and distance 1: no error is said where there is one. A picture of it is drawn."""
    done = command("run", "bar", *QUICK, "--estimator", *FIVE, "--json", "-", "--plot", str(tmp_path / "x.png"))
    assert (done.returncode, done.stderr) == (0, "")
    result = json.loads(done.stdout)
    assert list(result["index"]) == list(result["estimate"]) == result["scene"]["estimator"] == FIVE
    assert result["not_valid"] == {} and set(result["seconds"]["estimators"]) == set(FIVE)
    assert result["index"]["zero"] == dict.fromkeys(("x", "v", "sigma", "a"), 0)
    assert result["distance"]["zero"] == pytest.approx(dict.fromkeys(("x", "v", "sigma", "a"), 1))
    assert 0 < result["index"]["transport"]["x"] and result["estimate"]["zero"]["x"]["max"] == 0
    assert (tmp_path / "x.png").read_bytes().startswith(b"\x89PNG")


def test_a_run_prints_it_beside_others():
    done = command("run", "bar", *QUICK, "--estimator", "transport", "zero")
    assert (done.returncode, done.stderr) == (0, "")
    assert "estimate: transport" in done.stdout and "estimate: zero" in done.stdout


def test_help_lists_it_where_it_is():
    assert "{" + ",".join((*FIVE, "none")) + "}" in "".join(command("run", "bar", "--help").stdout.split("│")) \
        .replace(" ", "").replace("\n", "")
    assert "zero" not in command("run", "ring", "--help").stdout


def test_a_problem_that_has_it_not_says_so():
    """In one sentence with the names of those that the ring has."""
    done = command("run", "ring", "--estimator", "transport", "zero")
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    assert done.stderr.startswith("mpm-lab: --estimator zero: ")
    assert all(name in done.stderr for name in ESTIMATORS) and done.stderr.count("zero") == 1


@pytest.mark.parametrize("module", ["no_such_module", "tests.rows,no_such_module"])
def test_an_extension_that_is_not_there_is_said(module):
    done = command("run", "bar", *QUICK, environment={EXTENSIONS: module})
    assert done.returncode not in (0, 3) and done.stdout == ""
    assert done.stderr.count("\n") == 1 and f"{EXTENSIONS} names no_such_module" in done.stderr


def test_a_sweep_measures_it_in_processes_of_its_own(tmp_path):
    done = command("sweep", "bar", "--cells", "8", "16", "--periods", "0.2", "--estimator", "transport", "zero",
                   "--repeats", "1", "--out", str(tmp_path / "out"), "--quiet")
    assert done.returncode == 0, done.stderr
    with open(tmp_path / "out" / "table.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [(row["status"], float(row["index.zero.x"]), float(row["distance.zero.x"])) for row in rows] \
        == [("ok", 0.0, pytest.approx(1.0))] * 2
    assert "zero: index x" in (tmp_path / "out" / "summary.md").read_text()


def test_tables_and_their_pictures_show_five(tmp_path):
    """Table 1, cut down to one grid, one bar and a hundredth of the time."""
    code = """
import json, sys
from dataclasses import replace
from app.cli import main
from app.pictures.tables import figure
from solvers.study.tables import plan
table = lambda estimators: plan.table_1(estimators, cells=(20,), end=0.01, long=0.02)
plan.make = lambda number, estimators: replace(table(estimators), rows=table(estimators).rows[:2])
assert main(["tables", "1", "--out", sys.argv[1]]) == 0
with open(sys.argv[1] + "/table1.json") as file:
    drawn = [line for part in figure(json.load(file)).subfigs for axes in part.axes for line in axes.get_lines()]
print(json.dumps([[line.get_label(), str(line.get_marker())] for line in drawn]))
"""
    done = python("-c", code, str(tmp_path))
    assert done.returncode == 0, done.stderr
    drawn = json.loads(done.stdout)
    assert {label for label, _ in drawn} >= set(FIVE)
    assert {symbol for label, symbol in drawn if label == "zero"} == {"X"}
    table = json.loads((tmp_path / "table1.json").read_text())
    assert table["estimators"] == FIVE
    assert all(row["estimators"]["zero"]["index"]["x"] == 0 for row in table["rows"])
    assert "zero" in (tmp_path / "table1.md").read_text()
    assert (tmp_path / "table1.png").read_bytes().startswith(b"\x89PNG")


def test_pictures_of_runs_and_studies_show_five(tmp_path):
    """A curve each in the picture of a run, and a picture of every kind out of rows that have five."""
    code = """
import json, sys
from app.pictures.run import png_bytes, run_figure
from app.pictures.study import FIGURES
from solvers.problems.bar.scene import BarScene
from solvers.running.run import run
from solvers.study import row
from solvers.study.grid import plan
names = BarScene.choices("estimators")
inputs = {"ppc": 2, "amplitude": 0.004, "periods": 0.2, "linearity_preserving": True}
scene = BarScene(cells=20, estimators=names, **inputs)
figure = run_figure(run(scene, prices=False))
assert png_bytes(figure).startswith(b"\\x89PNG")
axes = {"cells": [16, 20], "estimator": [names], **{name: [value] for name, value in inputs.items()}}
rows = [row.measure(task) for task in plan("bar", axes, repeats=1)]
assert all(png_bytes(make(rows)).startswith(b"\\x89PNG") for make in FIGURES.values())
print(json.dumps([[line.get_label(), str(line.get_color())] for axes in figure.axes for line in axes.get_lines()]))
"""
    done = python("-c", code, str(tmp_path))
    assert done.returncode == 0, done.stderr
    drawn = json.loads(done.stdout)
    assert {name for name in FIVE if any(name in label for label, _ in drawn)} == set(FIVE)
    assert {colour for label, colour in drawn if "zero" in label} == {"#606060"}
