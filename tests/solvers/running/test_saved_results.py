"""A result is a file, and back: the same to the last bit; whatever else is in a file is refused in one sentence."""

import json

import numpy as np
import pytest

from app.cli import main
from solvers import BarScene, FileError, Result, RingScene, judge, run

SCENES = [BarScene(cells=20, periods=1, estimators=("companion",), effects=BarScene.choices("effects"), dt="auto"),
          BarScene(method="mpm", cells=20, cfl=1.5, estimators=(), effects=("truth", "soundness")),
          RingScene(cells=12, amplitude=0.05, periods=0.5, cfl=0.2, estimators=("companion",), layout="cartesian")]


def bits(result: Result) -> dict[str, tuple]:
    return {name: (array.dtype, array.shape, array.tobytes()) for name, array in result.arrays().items()}


@pytest.mark.parametrize("scene", SCENES, ids=["bar, kept on the way", "bar gone bad", "ring"])
def test_what_is_loaded_is_what_was_saved(scene, tmp_path):
    result = run(scene, prices=scene.problem == "bar")
    result.save(tmp_path / "run.npz")
    again = Result.load(tmp_path / "run.npz")
    assert again.scene == scene and bits(again) == bits(result)
    assert json.dumps(again.to_dict()) == json.dumps(result.to_dict())
    assert (again.mid_run is None) == (result.mid_run is None) and again.seconds == result.seconds


def test_the_judge_reads_a_saved_result_and_a_file_of_particles_is_one(tmp_path):
    scene = BarScene(cells=20, periods=0.2, estimators=("companion",))
    result, every = run(scene), str(tmp_path / "every.npz")
    result.save(tmp_path / "run.npz")
    assert main(["run", "bar", "--cells", "20", "--periods", "0.2", "--estimator", "companion", "--particles", every,
                 "--quiet", "--json", str(tmp_path / "run.json")]) == 0
    [ours], [all_of_it] = (judge(BarScene(), [file]).grids for file in (tmp_path / "run.npz", every))
    assert ours.norms["x"][-1] == pytest.approx(result.error["x"]["final"], rel=1e-9)
    assert len(all_of_it.norms["x"]) == len(result.series["time"])
    told, loaded = json.loads((tmp_path / "run.json").read_text()), Result.load(every).to_dict()
    assert all(loaded[name] == told[name] for name in told.keys() - {"seconds", "rate"})


SMALL = BarScene(cells=10, periods=0.1, estimators=("companion",))


def file_with(tmp_path, result: Result, changes: dict) -> str:
    """A saved result with other arrays: None takes one away; a dict is for what the text says."""
    result.save(tmp_path / "run.npz")
    arrays = dict(np.load(tmp_path / "run.npz"))
    for name, value in changes.items():
        name = name.replace("__", "/")
        if isinstance(value, dict):
            value = np.array(json.dumps(json.loads(arrays[name].item()) | value))
        arrays |= {name: value}
    np.savez(tmp_path / "other.npz", **{name: array for name, array in arrays.items() if array is not None})
    return str(tmp_path / "other.npz")


@pytest.mark.parametrize("changes, sentence", [
    ({"result": None}, "holds no result of a run; write it with Result.save"),
    ({"scene": None}, "holds no result of a run"),
    ({"result": np.array("{")}, "holds no result of a run (its text called result is none)"),
    ({"result": np.array("[" * 15_000)}, "(its text called result is none)"),
    ({"result": np.array("[]")}, "(its text called result is none)"),
    ({"result": {"schema": "mpm-lab/result/9"}}, "is of another version (mpm-lab/result/9), and mpm-lab/result/1"),
    ({"result": {"status": "fine"}}, "does not say what one says"),
    ({"result": {"steps": 1.5}}, "does not say what one says"),
    ({"result": {"reason": "\x1b[2J"}}, "does not say what one says"),
    ({"result": {"moments": {}}}, "does not say what one says"),
    ({"result": {"advice": [{"change": {"cells": -1}, "text": "", "tried": True, "held": True}]}}, "does not say what"),
    ({"result": {"seconds": 3}}, "does not say what one says"),
    ({"scene": {"problem": "rod"}}, "names an unknown problem"),
    ({"scene": {"inputs": {"cells": 0}}}, "has an invalid scene: cells 0: "),
    ({"scene": {"inputs": {"cells": [[10]]}}}, "has a scene with inputs that the bar does not accept"),
    ({"scene": {"inputs": {"estimator": ["two-grid"]}}}, "(its samples are not those of its scene)"),
    ({"series__error_x": None}, "(its samples are not those of its scene)"),
    ({"series__more": np.zeros(3)}, "(its samples are not those of its scene)"),
    ({"series__time": np.zeros(0)}, "(it has no samples)"),
    ({"series__error_x": np.zeros(2)}, "(series/error_x is float64 of the shape (2,), not ("),
    ({"series__error_x": np.zeros(3, np.float32)}, "(series/error_x is float32"),
    ({"series__error_x": np.array([None])}, "series/error_x"),
    ({"final__position": np.zeros((40, 2))}, "(final/position is float64 of the shape (40, 2), not (40,))"),
    ({"final__velocity": None}, "(it has no final/velocity)"),
    ({"final__position": None}, "(it has no particles (final))"),
    ({"final__last_crossing": np.zeros(40)}, "(final/last_crossing is float64"),
], ids=str)
def test_what_is_no_result_is_refused_in_a_sentence(changes, sentence, tmp_path, simulate):
    file = file_with(tmp_path, simulate(SMALL), changes)
    with pytest.raises(FileError) as error:
        Result.load(file)
    assert sentence in str(error.value) and "\n" not in str(error.value) and error.value.__cause__ is None


def test_a_file_that_is_none_and_a_name_that_will_not_do(tmp_path, simulate):
    (tmp_path / "text.npz").write_text("no zip")
    for file, sentence in ((tmp_path / "none.npz", "cannot be read"), (tmp_path / "text.npz", "is no .npz of plain"),
                           (tmp_path, "cannot be read")):
        with pytest.raises(FileError, match=sentence):
            Result.load(file)
    with pytest.raises(FileError, match="is no name for a saved result"):
        simulate(SMALL).save(tmp_path / "run.json")
