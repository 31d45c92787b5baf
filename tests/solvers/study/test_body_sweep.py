"""Sweeps of a body: their rows, and what the command makes of them."""

import csv
import dataclasses
import json

import pytest

from app.commands.dispatch import dispatch
from solvers import sweep
from solvers.bodies.body_file import body_from_dict, library_names, library_text, parse_body
from solvers.bodies.run import run_body
from solvers.scene.validation import SceneError
from solvers.study.body_sweep import IDENTITY, MEASURED, measure, plan_body_tasks
from solvers.study.row import find_fault
from tests.support.fake_rows import InstantExecutor

SECTOR = dataclasses.replace(parse_body(library_text("swinging_sector")), t_end=0.1)
AXES = {"cells_per_metre": [4, 8], "method": ["cpdi", "ugimp"]}


@pytest.mark.parametrize("name", library_names())
def test_a_body_comes_back_from_json(name):
    body = parse_body(library_text(name))
    assert body_from_dict(json.loads(json.dumps(dataclasses.asdict(body)))) == body


def test_each_combination_is_one_task():
    tasks = plan_body_tasks(SECTOR, AXES)
    assert [task.inputs for task in tasks] == [{"cells_per_metre": cells, "method": method}
                                               for cells in (4, 8) for method in ("cpdi", "ugimp")]
    assert len({task.key for task in tasks}) == 4 and [task.kind for task in tasks[:2]] == ["cpdi", "ugimp"]
    assert len(plan_body_tasks(SECTOR, {"cells_per_metre": [8, 8.0]})) == 1
    with pytest.raises(SceneError, match="is nothing that varies in a body; give some of youngs_modulus"):
        plan_body_tasks(SECTOR, {"corners": [1]})
    with pytest.raises(SceneError, match="ppc 9: give a whole number from 1 to 6"):
        plan_body_tasks(SECTOR, {"ppc": [9]})


def test_a_row_has_what_a_run_has():
    [task] = plan_body_tasks(SECTOR, {"cells_per_metre": [8]})
    row = json.loads(json.dumps(measure(task), allow_nan=False))
    assert find_fault(row, MEASURED, IDENTITY) is None
    result = run_body(dataclasses.replace(SECTOR, cells_per_metre=8)).to_dict()
    assert row["goals"] == result["goals"] and row["estimate"] == result["estimate"] and row["h"] == 0.125
    assert (row["asked"], row["scene"]["cells_per_metre"], row["scene"]["method"]) == (
        {"cells_per_metre": 8}, 8, "cpdi")


def test_what_goes_wrong_is_a_row(monkeypatch):
    def fail(body):
        raise RuntimeError("no\nroom")

    monkeypatch.setattr("solvers.bodies.run.run_body", fail)
    good, bad = map(measure, plan_body_tasks(SECTOR, {"ppc": [2, 9]}))
    assert (good["status"], good["reason"]) == ("failed", "RuntimeError: no room")
    assert bad["status"] == "refused" and "give a whole number" in bad["reason"] and bad["scene"] is None
    assert {find_fault(row, MEASURED, IDENTITY) for row in (good, bad)} == {None}


def made_row(task):
    """A row whose goal of 2 m has a bar of h/10."""
    if refusal := task.refusal():
        return task.failed_row(str(refusal), "refused")
    row = task.failed_row("", "ok")
    h = 1 / row["scene"]["cells_per_metre"]
    one = {"final": h, "max": h, "mean": h, "delta": 0.4, "trust": "30 %", "unit": "m"}
    return {**row, "reason": None, "h": h, "steps": 10, "particles": 64, "estimated_until": 0.1, "remarks": [],
            "estimate": {name: one for name in ("x", "v", "sigma")}, "seconds": {"run": 0.5},
            "goals": {"end": {"value": 2.0, "bar": h / 10, "unit": "m"}}}


def test_the_command(tmp_path, monkeypatch, capsys):
    """Rows that are there are not run again; values may be given with commas."""
    path, out = tmp_path / "sector.toml", tmp_path / "sweep"
    path.write_text(library_text("swinging_sector"))
    place = InstantExecutor(made_row)
    monkeypatch.setattr("solvers.study.executors.LocalExecutor", place)
    words = ["sweep", str(path), "--out", str(out), "--cells"]
    assert dispatch([*words, "8"]) == 0 and "1/1 cells per metre 8: ok" in capsys.readouterr().err
    assert dispatch([*words, "8,16", "--method", "cpdi", "ugimp", "--ppc", "2", "9", "--resume"]) == 0
    assert "| cpdi | 16 | 2 | ok | 6.250e-02 ± 30 % |" in (said := capsys.readouterr()).out
    assert "8 rows, 1 of them there already" in said.err and "refused: ppc 9" in said.err
    assert "2.0000 +- 0.0063 m" in said.out
    assert {one.name for one in out.iterdir()} == {"rows.jsonl", "table.csv", "table.json", "summary.md", "goals.png"}
    table = list(csv.DictReader((out / "table.csv").read_text().splitlines()))
    assert [row["status"] for row in table if row["scene.method"] == "ugimp"] == ["ok", "refused"] * 2
    assert {row["goals.end.bar"] for row in table} == {"0.0125", "0.00625", ""}
    assert len(json.loads((out / "table.json").read_text())["rows"]) == len(table)
    assert dispatch([*words, "many"]) == 2 and "--cells many: give a number" in capsys.readouterr().err


def test_a_sweep_in_python(monkeypatch):
    monkeypatch.setattr("solvers.study.sweep.LocalExecutor", InstantExecutor(made_row))
    rows = sweep(SECTOR, **AXES)
    assert rows["goals.end.bar"].tolist() == [0.025, 0.025, 0.0125, 0.0125]
    assert rows["scene.method"].tolist() == ["cpdi", "ugimp"] * 2 and rows["estimate.x.delta"].tolist() == [0.4] * 4
    with pytest.raises(SceneError, match="holds no value"):
        sweep(SECTOR, ppc=[])
