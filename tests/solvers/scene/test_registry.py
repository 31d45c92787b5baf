"""What a problem and an estimator are where their authors say no more than they must."""

from dataclasses import dataclass, replace
from itertools import product

import numpy as np
import pytest

from solvers.problems import PROBLEMS
from solvers.problems.bar.scene import BarScene
from solvers.running.run import run
from solvers.scene import estimator_registry
from solvers.scene.estimator_registry import ESTIMATORS, Estimator
from solvers.scene.extension_modules import EXTENSIONS, ExtensionError, load_extensions
from solvers.solver.soundness import findings


def test_only_an_estimator_that_says_so_judges():
    naive = Estimator("naive", "a first attempt", colour="#606060")
    assert not naive.judges and "a first attempt" in naive.explanation
    assert replace(naive, summary="a < b").explanation == "<p>a &lt; b</p>"
    assert {name for name, one in ESTIMATORS.items() if one.judges} == {"recovered", "companion", "two-grid"}


@pytest.mark.parametrize("judges", [False, True])
def test_a_naive_estimator_calls_no_good_run_lost(monkeypatch, judges):
    """One that puts the error of x at ten amplitudes: only where it may judge is that found."""
    scene = BarScene(periods=0.05, estimators=("recovered",))
    monkeypatch.setitem(estimator_registry.ESTIMATORS, "recovered", replace(ESTIMATORS["recovered"], judges=judges))
    series = dict(run(scene).series)
    series["recovered/estimate_x"] = np.full_like(series["time"], 10 * scene.amplitude)
    assert set(findings(scene, series)) == ({"recovered"} if judges else set())


@pytest.mark.parametrize(("own", "first"), [(("transport", "recovered", "companion"), ("companion",)),
                                            (("transport", "recovered"), ("recovered",)),
                                            (("transport",), ("transport",)), ((), ())])
def test_a_scene_that_says_no_more_asks_the_first_judge_of_its_estimators(own, first):
    """Whichever it has: transport, which often fails, only where there is no judge."""
    @dataclass(frozen=True)
    class OwnScene(BarScene):
        ESTIMATORS = own

    scene = OwnScene()
    assert scene.estimators == scene.active_estimators == first
    assert list(OwnScene.__dataclass_fields__) == list(BarScene.__dataclass_fields__)


@pytest.mark.parametrize("problem", PROBLEMS)
def test_the_default_judge_is_valid_in_the_usual_scenes(problem):
    kind = PROBLEMS[problem].scene
    for method, cells in product(kind.choices("method"), (20, 40, 80, 160)):
        scene = kind(method=method, cells=cells)
        assert scene.active_estimators == scene.estimators == ("companion",) and not scene.not_valid


def test_first_shown_is_the_first_that_is_valid():
    asked = ("transport", "recovered", "companion")
    assert BarScene(estimators=asked).first_estimator == "transport"
    assert BarScene(method="bspline", estimators=asked).first_estimator == "recovered"
    assert BarScene(method="bspline", estimators=asked[:1]).first_estimator == "transport"
    assert BarScene(estimators=()).first_estimator is None


def test_an_extension_keeps_standard_output_free_and_does_not_end_the_program(tmp_path, monkeypatch, capsys):
    """Standard output may be JSON; and a file that some editor has put a mark into is one too."""
    (tmp_path / "speaking_extension.py").write_text("print('here')", encoding="utf-8-sig")
    (tmp_path / "ending_extension.py").write_text("import sys\nsys.exit('over')", encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setenv(EXTENSIONS, "speaking_extension ending_extension")
    with pytest.raises(ExtensionError, match=r"names ending_extension, which cannot be imported \(SystemExit: over\)"):
        load_extensions.__wrapped__()
    assert tuple(capsys.readouterr()) == ("", "here\n")
