"""What a user imports: ``from solvers import ...``."""

import copy
import pickle

import numpy as np
import pytest

import solvers
from solvers import BarScene, FileError, Result, SceneError, judge, run, sweep
from solvers.judging import problem_handout
from tests.support.processes import run_python

LIGHT = """
import sys
{what}
print(*sorted(name for name in ("numpy", "taichi", "matplotlib", "meshio", "viser") if name in sys.modules))
"""


@pytest.mark.parametrize("what, heavy", [
    ("import solvers; dir(solvers)", ""), ("from solvers import BarScene, RingScene, VortexScene, SceneError", "numpy"),
    ("import app.cli\ntry: app.cli.main(['--help'])\nexcept SystemExit: pass\nprint()", "numpy")])
def test_who_only_asks_waits_for_nothing_heavy(what, heavy):
    done = run_python("-c", LIGHT.format(what=what))
    assert done.stdout.splitlines()[-1] == heavy, done.stderr


def test_everything_promised_is_there():
    assert set(solvers.__all__) <= set(dir(solvers))
    for name in solvers.__all__:
        assert getattr(solvers, name).__name__ == name
    with pytest.raises(AttributeError, match="has no attribute 'march'"):
        _ = solvers.march
    with pytest.raises(ImportError, match="cannot import name 'march'"):
        exec("from solvers import march")


def test_a_problem_by_name_or_class_runs_with_its_defaults():
    assert run("bar").error == run(BarScene).error == run(BarScene()).error
    for wrong in ("bat", 3):
        with pytest.raises(SceneError, match="bar, square, ring, vortex"):
            run(wrong)
    with pytest.raises(SceneError, match="one of x, v, sigma, a, sigma_log"):
        _ = run(BarScene(cells=8, periods=0.1)).error["q"]


def test_a_sweep_goes_on_from_a_scene():
    rows = sweep(BarScene(periods=0.1, cfl=0.1), cells=[8, 10], dt=1e-3, repeats=0)
    assert list(rows["scene.cells"]) == [8, 10] and set(rows["scene.dt"]) == {1e-3}


def test_prices_cost_time_and_are_asked_for():
    scene = BarScene(cells=20, periods=0.1, estimators=("companion",))
    assert run(scene).seconds.estimate is None and run(scene, prices=True).seconds.estimate >= 0  # what is measured


def test_a_result_is_called_as_its_json():
    """And holds the same, but for the moment, the scene, and what is made of seconds."""
    result = run(BarScene(cells=20, periods=0.1, estimators=("companion",)))
    assert isinstance(result, Result) and result.status == "ok"
    values = result.to_dict()
    alike = values.keys() - {"schema", "scene", "t", "checked", "not_checked", "as_large_as_itself", "seconds",
                             "advice"}
    assert {name: getattr(result, name) for name in alike} == {name: values[name] for name in alike}
    assert result.verdict.items() <= values.items() and result.time == values["t"]
    assert result.index["x"] == pytest.approx(1, abs=0.01) and result.index["companion"] == result.index
    assert run(BarScene(cells=20, periods=0.1, estimators=())).index == dict.fromkeys(values["index"])


def test_what_a_result_has_not_is_an_attribute_error():
    result = run(BarScene(cells=8, periods=0.1, estimators=("companion",)))
    with pytest.raises(AttributeError, match="a result has no eror"):
        _ = result.eror
    assert pickle.loads(pickle.dumps(result)).error == copy.copy(result).error == result.error


def test_an_estimator_that_the_run_has_not_had_is_named():
    two = run(BarScene(cells=14, periods=0.1, estimators=("companion", "two-grid")))  # of too few cells for one
    with pytest.raises(SceneError, match="estimator transport: is none of this run's; give one of companion, two-grid"):
        _ = two.index["transport"]
    with pytest.raises(SceneError, match="estimator x: is none of this run's"):
        _ = two.estimate["x"]
    assert two.not_valid["two-grid"].startswith("not valid here: ")
    assert two.index["two-grid"] == dict.fromkeys(two.index["companion"])
    assert two.index["companion"]["x"] == pytest.approx(1, abs=0.01)
    one = run(BarScene(cells=20, periods=0.1, estimators=("companion",)))
    with pytest.raises(SceneError, match="is not this run's, which has companion; give that or one of x, v, sigma, a"):
        _ = one.distance["recovered"]


def test_a_sweep_has_a_row_for_each_combination_as_its_table_has():
    """Errors over the amplitude are those of single runs, to the bit; a scene that cannot be is a row that says so."""
    told = []
    rows = sweep("bar", cells=[20, 40], ppc=np.array([2, 4]), amplitude=2.5e-4, periods=0.25, estimators=["companion"],
                 repeats=0, on_progress=lambda part, row: told.append((part, row["scene.cells"])))
    assert [(row["scene.cells"], row["scene.ppc"]) for row in rows] == [(20, 2), (20, 4), (40, 2), (40, 4)]
    assert {row["scene.estimator"] for row in rows} == {"companion"} and {row["status"] for row in rows} == {"ok"}
    assert [part for part, _ in told] == [0.25, 0.5, 0.75, 1] and {cells for _, cells in told} == {20, 40}
    scene = BarScene(cells=40, ppc=2, amplitude=2.5e-4, periods=0.25, estimators=("companion",))
    result = run(scene)
    assert rows[2]["error.x.max"] == result.error["x"]["max"]
    assert rows[2]["index.companion.v"] == result.index["companion"]["v"]
    assert rows[2]["h"] == scene.spacing


def test_what_cannot_be_in_a_sweep_is_a_row_of_it():
    rows = sweep("bar", amplitude=[0.2, 2.5e-4], cells=20, periods=0.1, repeats=0, estimators=[(), ("transport",)])
    assert [row["status"] for row in rows] == ["refused", "refused", "ok", "ok"]
    assert "amplitude 0.2" in rows[0]["reason"] and rows[0]["error.x.max"] is None
    assert list(rows[0]) == list(rows[2])


@pytest.mark.parametrize("problem, inputs, sentence", [
    ("rod", {}, "problem rod: is not known; give one of bar, square, ring, vortex"),
    ("bar", {"cels": 20}, "cels 20: is no input of the bar; give some of method, cells"),
    ("bar", {"cells": []}, "cells []: holds no value; give one at least"),
    ("bar", {"cells": 20.5}, "cells 20.5: give a whole number from 4 to 100,000"),
    ("bar", {"cells": range(4, 200), "ppc": range(1, 65)}, "combinations 12,544: are too many"),
    ("bar", {"workers": 0}, "workers 0: give a whole number from 1")])
def test_what_no_sweep_can_be_is_said_in_one_sentence(problem, inputs, sentence):
    with pytest.raises(SceneError) as error:
        sweep(problem, **inputs)
    assert str(error.value).startswith(sentence) and "\n" not in str(error.value)


def test_arrays_are_judged_as_files_are(tmp_path):
    scene = BarScene(cells=20)
    X = (np.arange(80) + 0.5) / 80
    times = np.array([0.1, 0.2])
    u = np.stack([problem_handout.exact_frame(scene, t).position[:, 0] - X for t in times])
    arrays = {"t": times, "X": X, "x": X + 1.01 * u, "cells": 20}
    np.savez(tmp_path / "run.npz", **arrays)
    told = []
    said = judge(scene, arrays, on_progress=lambda part, what: told.append(what)).to_dict()
    read = judge(scene, [tmp_path / "run.npz"]).to_dict()
    [grid], [other] = said["grids"], read["grids"]
    size = 0.01 * np.sqrt(np.mean(u**2, axis=1))  # the motion is 1 % too large
    assert grid["norms"]["x"] == pytest.approx(size.tolist(), rel=1e-12) and grid["norms"] == other["norms"]
    assert grid["files"] == ["arrays 1"] and told == ["20 cells: companion"] and grid["ours"] == []


@pytest.mark.parametrize("given, options, sentence", [
    ({"x": [0.1, 0.2]}, {}, "arrays 1: does not identify its particles"),
    ({"x": [[1.0], [1.0, 2.0]]}, {}, "arrays 1: are no arrays"),
    ("nothing.csv", {}, "nothing.csv: cannot be read"),
    ([], {}, "files none: give one or several"),
    ([{"x": [0.5], "X": [0.5]}], {"times": (0.1, 0.2)}, "time 0.1 0.2: is 2 numbers for 1 files; give one for each")])
def test_what_cannot_be_judged_is_said_in_one_sentence(given, options, sentence):
    with pytest.raises((FileError, SceneError)) as error:
        judge(BarScene(cells=20), given, **options)
    assert str(error.value).startswith(sentence) and "\n" not in str(error.value)
    assert error.value.__cause__ is None
