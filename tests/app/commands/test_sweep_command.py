"""``mpm-lab sweep``: what it leaves, how it goes on, and its flags."""

from __future__ import annotations

import json
from pathlib import Path
from types import SimpleNamespace

import pytest

from app.cli import main
from app.commands import commands
from app.commands.lenient_flag_types import BadInput
from app.commands.study.study_command import StudyFlags
from app.pictures.cost_and_convergence import FIGURES
from solvers.study.parameter_grid import MOST_ROWS
from solvers.study.row import solver_source_hash
from tests.support.fake_rows import InstantExecutor

SweepBar = commands()["sweep", "bar"]
SMOOTH = ["--cells", "20", "40", "--method", "ugimp", "bspline", "--amplitude", "2.5e-4", "--periods", "1",
          "--repeats", "1"]


@pytest.fixture(scope="module")
def whole(tmp_path_factory) -> Path:
    """The directory of a finished sweep."""
    out = tmp_path_factory.mktemp("sweep") / "whole"
    assert main(["sweep", "bar", *SMOOTH, "--out", str(out)]) == 0
    return out


def rows_of(directory: Path) -> list[dict]:
    return json.loads((directory / "table.json").read_text())["rows"]


def test_a_sweep_leaves_rows_tables_and_pictures(whole):
    assert {path.name for path in whole.iterdir()} == {"rows.jsonl", "table.csv", "table.json", "summary.md",
                                                       *(f"{name}.png" for name in FIGURES)}
    assert [(r["scene"]["method"], r["scene"]["cells"], r["status"], r["side_by_side"]) for r in rows_of(whole)] == [
        (method, cells, "ok", 1) for method in ("ugimp", "bspline") for cells in (20, 40)]
    orders = [entry["orders"]["x"]["order"] for entry in json.loads((whole / "table.json").read_text())["fits"]]
    assert orders == pytest.approx([2, 2], abs=0.2)


@pytest.mark.parametrize("left", [pytest.param(4, marks=pytest.mark.slow), 2])
def test_resumed_it_is_the_same_table_and_runs_what_is_missing(left, whole, tmp_path, monkeypatch, capsys):
    """Whether it had finished, or was killed while it wrote its third row."""
    lines = (whole / "rows.jsonl").read_bytes().splitlines(keepends=True)
    measured = {row["key"]: row for row in map(json.loads, lines)}
    (tmp_path / "rows.jsonl").write_bytes(b"".join(lines[:left]) + b'{"schema": "mpm' * (left < 4))
    place = InstantExecutor(lambda task: measured[task.key])
    monkeypatch.setattr("solvers.study.executors.LocalExecutor", place)
    assert main(["sweep", "bar", *SMOOTH, "--out", str(tmp_path), "--resume"]) == 0
    said = capsys.readouterr()
    assert len(place.asked) == 4 - left and f"4 rows, {left} of them there already" in said.err
    assert said.out.startswith("# Sweep of the bar") and said.err.count("/4 method ") == 4 - left
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == {
        path.name: path.read_bytes() for path in whole.iterdir()}


def test_rows_of_other_source_are_measured_again_and_said(tmp_path, monkeypatch, capsys):
    place = InstantExecutor()
    monkeypatch.setattr("solvers.study.executors.LocalExecutor", place)
    monkeypatch.setattr("app.pictures.cost_and_convergence.FIGURES", {})
    flags = ["sweep", "bar", "--cells", "20", "40", "--out", str(tmp_path)]
    path = tmp_path / "rows.jsonl"
    assert main(flags) == 0
    path.write_text(path.read_text().replace(solver_source_hash(), "0" * 64, 1))
    for again in (True, False):
        capsys.readouterr()
        assert main([*flags, "--resume"]) == 0
        assert len(place.asked) == 3 == path.read_text().count("\n")
        said = "1 row was measured by another version of the solvers and is measured again"
        assert (said in capsys.readouterr().err) is again


def test_refused_combinations_are_rows(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr("solvers.study.executors.LocalExecutor", InstantExecutor())
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


def test_a_study_has_as_many_rows_as_are_allowed_and_no_more():
    flags = SimpleNamespace(out="out", workers=None, scheduler=None)
    StudyFlags.check_study_flags(flags, MOST_ROWS)
    with pytest.raises(BadInput, match=f"{MOST_ROWS:,}"):
        StudyFlags.check_study_flags(flags, MOST_ROWS + 1)
