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
from pathlib import Path

import pytest

from solvers.problems.bar.scene import BarScene
from solvers.problems.ring.scene import RingScene
from solvers.scene.extensions import EXTENSIONS
from tests.paths import ROOT
from tests.processes import HANG

ENVIRONMENT = {EXTENSIONS: "tests.zero_estimator"}
FIVE = [*BarScene.ESTIMATORS, "zero"]
#: Here all of them hold, and say something of every quantity.
QUICK = ["--cells", "20", "--ppc", "2", "--amplitude", "0.004", "--periods", "0.2", "--linearity-preserving"]


SWEEP = ["sweep", "bar", "--cells", "8", "16", "--periods", "0.2", "--estimator", "transport", "zero",
         "--linearity-preserving", "--repeats", "1", "--quiet", "--out", "out"]
#: What a person types who has the extension, by one word each; all in one process, for they need the same compiled.
COMMANDS = {"run": ["run", "bar", *QUICK, "--estimator", *FIVE, "--json", "-", "--plot", "x.png"],
            "print": ["run", "bar", *QUICK, "--estimator", "transport", "zero"], "help": ["run", "bar", "--help"],
            "ring": ["run", "ring", "--help"], "refused": ["run", "ring", "--estimator", "transport", "zero"],
            "sweep": SWEEP}
#: Table 1 is cut down to one grid, one bar and a hundredth of the time. Pictures: of a run with a curve each, and of
#: every kind out of rows that have five.
CODE = f"""
import json
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import replace
from io import BytesIO, TextIOWrapper
from app.cli import main
from app.pictures import tables
from app.pictures.run import png_bytes, run_figure
from app.pictures.study import FIGURES
from solvers.problems.bar.scene import BarScene
from solvers.running.run import run
from solvers.study import row
from solvers.study.grid import plan as planned
from solvers.study.tables import plan

if __name__ == "__main__":
    found = {{}}
    for name, arguments in {COMMANDS}.items():
        with redirect_stdout(TextIOWrapper(BytesIO())) as out, redirect_stderr(TextIOWrapper(BytesIO())) as err:
            said = [main(arguments)]
        for stream in (out, err):
            stream.flush()
            said.append(stream.buffer.getvalue().decode())
        found[name] = said
    made = plan.table_1
    table = lambda estimators: made(estimators, cells=(20,), end=0.01, long=0.02)
    plan.make = lambda number, estimators: replace(table(estimators), rows=table(estimators).rows[:2])
    assert main(["tables", "1", "--out", "."]) == 0
    drawn = lambda axes: [[line.get_label(), str(line.get_marker()), str(line.get_color())]
                          for line in axes.get_lines()]
    with open("table1.json") as file:
        parts = tables.figure(json.load(file)).subfigs
    found["table"] = [line for part in parts for axes in part.axes for line in drawn(axes)]
    inputs = {{"ppc": 2, "amplitude": 0.004, "periods": 0.2, "linearity_preserving": True}}
    figure = run_figure(run(BarScene(cells=20, estimators=BarScene.choices("estimators"), **inputs), prices=False))
    assert png_bytes(figure).startswith(b"\\x89PNG")
    found["curves"] = [line for axes in figure.axes for line in drawn(axes)]
    axes = {{"cells": [16, 20], "estimator": [BarScene.choices("estimators")],
            **{{name: [value] for name, value in inputs.items()}}}}
    rows = [row.measure(task) for task in planned("bar", axes, repeats=1)]
    assert all(png_bytes(make(rows)).startswith(b"\\x89PNG") for make in FIGURES.values())
    with open("found.json", "w") as file:
        json.dump(found, file)
"""


@pytest.fixture(scope="module")
def found(tmp_path_factory) -> tuple[Path, dict]:
    """The folder in which it all was done, and of each command its status and what it said."""
    folder = tmp_path_factory.mktemp("extension")
    (folder / "code.py").write_text(CODE, encoding="utf-8")
    done = subprocess.run([sys.executable, "code.py"], cwd=folder, capture_output=True, text=True, timeout=HANG,
                          env={**os.environ, **ENVIRONMENT, "PYTHONPATH": str(ROOT)})
    assert done.returncode == 0, done.stderr
    return folder, json.loads((folder / "found.json").read_text())


def test_a_run_has_all_five(found):
    """Index 0 and distance 1: no error is said where there is one. A picture of it is drawn."""
    folder, said = found
    status, out, err = said["run"]
    assert (status, err) == (0, "")
    result = json.loads(out)
    assert list(result["index"]) == list(result["estimate"]) == result["scene"]["estimator"] == FIVE
    assert result["not_valid"] == {} and set(result["seconds"]["estimators"]) == set(FIVE)
    assert result["index"]["zero"] == dict.fromkeys(("x", "v", "sigma", "a"), 0)
    assert result["distance"]["zero"] == pytest.approx(dict.fromkeys(("x", "v", "sigma", "a"), 1))
    assert 0 < result["index"]["transport"]["x"] and result["estimate"]["zero"]["x"]["max"] == 0
    assert (folder / "x.png").read_bytes().startswith(b"\x89PNG")


def test_a_run_prints_it_beside_others(found):
    status, out, err = found[1]["print"]
    assert (status, err) == (0, "") and "estimate: transport" in out and "estimate: zero" in out


def test_help_lists_it_where_it_is(found):
    said = {name: found[1][name][1] for name in ("help", "ring")}
    assert "{" + ",".join((*FIVE, "none")) + "}" in "".join(said["help"].split("│")).replace(" ", "").replace("\n", "")
    assert "zero" not in said["ring"]


def test_a_problem_that_has_it_not_says_so(found):
    """In one sentence with the names of those that the ring has."""
    status, out, err = found[1]["refused"]
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert err.startswith("mpm-lab: --estimator zero: ")
    assert all(name in err for name in RingScene.ESTIMATORS) and err.count("zero") == 1


@pytest.mark.parametrize("module", ["no_such_module", "tests.rows,no_such_module"])
def test_an_extension_that_is_not_there_is_said(module):
    done = subprocess.run([sys.executable, "-m", "app", "run", "bar", *QUICK], cwd=ROOT, capture_output=True, text=True,
                          timeout=HANG, env={**os.environ, EXTENSIONS: module})
    assert done.returncode not in (0, 3) and done.stdout == ""
    assert done.stderr.count("\n") == 1 and f"{EXTENSIONS} names no_such_module" in done.stderr


def test_a_sweep_measures_it_in_processes_of_its_own(found):
    folder, said = found
    assert said["sweep"][0] == 0, said["sweep"]
    with open(folder / "out" / "table.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [(row["status"], float(row["index.zero.x"]), float(row["distance.zero.x"])) for row in rows] \
        == [("ok", 0.0, pytest.approx(1.0))] * 2
    assert "zero: index x" in (folder / "out" / "summary.md").read_text()


def test_tables_and_their_pictures_show_five(found):
    folder, said = found
    assert {label for label, _, _ in said["table"]} >= set(FIVE)
    assert {symbol for label, symbol, _ in said["table"] if label == "zero"} == {"X"}
    table = json.loads((folder / "table1.json").read_text())
    assert table["estimators"] == FIVE
    assert all(row["estimators"]["zero"]["index"]["x"] == 0 for row in table["rows"])
    assert "zero" in (folder / "table1.md").read_text()
    assert (folder / "table1.png").read_bytes().startswith(b"\x89PNG")


def test_pictures_of_runs_show_five(found):
    curves = found[1]["curves"]
    assert {name for name in FIVE if any(name in label for label, _, _ in curves)} == set(FIVE)
    assert {colour for label, _, colour in curves if "zero" in label} == {"#606060"}
