"""Estimators and an effect from outside, each an object and a registration (``tests/extension_example.py``).

Everything that knows estimators and effects must take them as its own: command line, JSON, text, readout, rows, tables
and claims; the page makes its boxes from the registry, as ``tests/app/page/test_controls.py`` sees, and a picture its
curves, as ``tests/app/pictures/test_plots.py`` does. In a process of its own, because this one has compiled its solvers
without them; ``tests/app/lessons/test_scripts.py`` has the one of a lesson, which takes less.
"""

import csv
import json
from pathlib import Path

import pytest

from solvers.problems.bar.scene import BarScene
from solvers.problems.ring import RingScene
from solvers.scene.extension_modules import EXTENSIONS
from tests.support.processes import run_python

ENVIRONMENT = {EXTENSIONS: "tests.extension_example"}
FIVE = [*BarScene.ESTIMATORS, "zero"]
#: What a person types who has the extension; all in one process and of few kinds, for they need the same compiled.
SHORT = ["--cells", "16", "--ppc", "2", "--periods", "0.05", "--effects", "truth,acceleration,estimate,strain"]
BAR = ["run", "bar", *SHORT, "--estimator", "transport", "zero"]
COMMANDS = {"run": [*BAR, "--json", "-"], "print": BAR, "help": ["run", "bar", "--help"],
            "ring help": ["run", "ring", "--help"], "refused": ["run", "ring", "--estimator", "transport", "zero"],
            "sweep": ["sweep", "bar", *SHORT, "--estimator", "zero", "--repeats", "1", "--quiet", "--out", "out"]}
#: Table 1 is cut down to one grid, one bar, two estimators and a hundredth of the time. Pictures: of all kinds out of
#: rows.
CODE = f"""
import json
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import replace
from io import BytesIO, TextIOWrapper
from app.cli import main
from app.lessons import claims
from app.page.panels.readout_tables import _effect_html
from app.pictures import paper_tables
from app.pictures.run_errors import png_bytes
from app.pictures.cost_and_convergence import FIGURES
from solvers import BarScene, run
from solvers.problems import PROBLEMS
from solvers.scene.effects import output_lines_by_effect
from solvers.study import row
from solvers.study.parameter_grid import plan_tasks
from solvers.study.tables import paper_table_definitions

if __name__ == "__main__":
    found = {{"offered": {{name: [problem.estimators, problem.scene.choices("effects")]
                          for name, problem in PROBLEMS.items()}}}}
    for name, arguments in {COMMANDS}.items():
        with redirect_stdout(TextIOWrapper(BytesIO())) as out, redirect_stderr(TextIOWrapper(BytesIO())) as err:
            said = [main(arguments)]
        for stream in (out, err):
            stream.flush()
            said.append(stream.buffer.getvalue().decode())
        found[name] = said
    table = paper_table_definitions.table_1({{"bar": ("transport", "zero")}}, cells=(20,), end=0.01, long=0.02)
    paper_table_definitions.make_table = lambda number, estimators: replace(table, rows=table.rows[:2])
    assert main(["tables", "1", "--out", "."]) == 0
    with open("table1.json") as file:
        parts = paper_tables.table_figure(json.load(file)).subfigs
    found["table"] = [[line.get_label(), str(line.get_marker())] for part in parts for axes in part.axes
                      for line in axes.get_lines()]
    inputs = {{"ppc": 2, "periods": 0.05, "effects": ("truth", "acceleration", "estimate", "strain")}}
    result = run(BarScene(cells=16, estimators=("transport", "zero"), **inputs), prices=False)
    found["asked"], found["seen"] = result.strain, max(abs(result.final.deformation_gradient - 1))
    found["readout"] = _effect_html("strain", output_lines_by_effect(lambda effect: effect.readout)["strain"],
                                    result.series)
    scope = claims.ClaimNamespace({{"it": claims.RunOutcome([json.loads(json.dumps(result.to_dict()))])}}, "it")
    found["claims"] = [claims.decide_claim(text, scope).holds for text in ("strain.largest > 0", "strain.samples < 0")]
    axes = {{"cells": [12, 16], "estimator": [("transport", "zero")],
            **{{name: [value] for name, value in inputs.items()}}}}
    rows = [row.measure(task) for task in plan_tasks("bar", axes, repeats=1)]
    assert all(png_bytes(make(rows)).startswith(b"\\x89PNG") for make in FIGURES.values())
    with open("found.json", "w") as file:
        json.dump(found, file)
"""


@pytest.fixture(scope="module")
def found(tmp_path_factory) -> tuple[Path, dict]:
    """The folder in which it all was done, and of each command its status and what it said."""
    folder = tmp_path_factory.mktemp("extension")
    (folder / "code.py").write_text(CODE, encoding="utf-8")
    done = run_python("code.py", cwd=folder, **ENVIRONMENT)
    assert done.returncode == 0, done.stderr
    return folder, json.loads((folder / "found.json").read_text())


def test_only_the_problem_that_it_is_for_has_it(found):
    """A problem that has it not says so in one sentence with the names of those that it has."""
    _, said = found
    offered = {name: (both[0], both[1]) for name, both in said["offered"].items()}
    assert offered["bar"][0] == FIVE and "strain" in offered["bar"][1]
    assert offered["ring"][0] == [*RingScene.ESTIMATORS, "loud"] and "strain" not in offered["ring"][1]
    assert not {"zero", "loud", "strain"} & {*offered["vortex"][0], *offered["vortex"][1]}
    bar, ring = ("".join(said[name][1].split("│")).replace(" ", "").replace("\n", "") for name in ("help", "ring help"))
    assert "{" + ",".join((*FIVE, "none")) + "}" in bar and "zero" not in ring
    status, out, err = said["refused"]
    assert (status, out, err.count("\n")) == (2, "", 1) and err.startswith("mpm-lab: --estimator zero: ")
    assert all(name in err for name in RingScene.ESTIMATORS) and err.count("zero") == 1


def test_a_run_has_it_beside_others(found):
    """Index 0 and distance 1: no error is said where there is one."""
    status, out, err = found[1]["run"]
    assert (status, err) == (0, "")
    result = json.loads(out)
    assert list(result["index"]) == list(result["estimate"]) == result["scene"]["estimator"] == ["transport", "zero"]
    assert result["not_valid"] == {} and set(result["seconds"]["estimators"]) == {"transport", "zero"}
    assert result["index"]["zero"] == dict.fromkeys(("x", "v", "sigma", "a"), 0)
    assert result["distance"]["zero"] == pytest.approx(dict.fromkeys(("x", "v", "sigma", "a"), 1))
    assert 0 < result["index"]["transport"]["x"] and result["estimate"]["zero"]["x"]["max"] == 0
    status, out, err = found[1]["print"]
    assert (status, err) == (0, "") and "estimate: transport" in out and "estimate: zero" in out


def test_a_sweep_measures_it_in_processes_of_its_own(found):
    folder, said = found
    assert said["sweep"][0] == 0, said["sweep"]
    with open(folder / "out" / "table.csv", newline="") as file:
        [row] = csv.DictReader(file)
    assert (row["status"], float(row["index.zero.x"]), float(row["distance.zero.x"])) == ("ok", 0, pytest.approx(1))
    assert float(row["strain.largest"]) == pytest.approx(said["seen"])
    assert "zero: index x" in (folder / "out" / "summary.md").read_text()


def test_a_number_declared_once_is_told_everywhere(found):
    """JSON, a result, text, the page's readout and claims of lessons."""
    strain = json.loads(found[1]["run"][1])["strain"]
    largest, samples = strain["largest"], strain["samples"]
    assert 0 < largest == pytest.approx(found[1]["seen"]) and samples >= 2 and found[1]["asked"] == strain
    assert f"largest strain  largest {largest:.4g}, samples {samples}\n" in found[1]["print"][1]
    assert found[1]["readout"] == f"largest {largest:.3g}, samples {samples}" and found[1]["claims"] == [True, False]


def test_tables_and_pictures_show_it(found):
    folder, said = found
    assert {label for label, _ in said["table"]} >= {"transport", "zero"}
    assert {symbol for label, symbol in said["table"] if label == "zero"} == {"X"}
    table = json.loads((folder / "table1.json").read_text())
    assert table["estimators"] == ["transport", "zero"]
    assert all(row["estimators"]["zero"]["index"]["x"] == 0 for row in table["rows"])
    assert "zero" in (folder / "table1.md").read_text()
    assert (folder / "table1.png").read_bytes().startswith(b"\x89PNG")
