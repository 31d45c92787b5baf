"""What a problem and an estimator are where their authors say no more than they must."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

from solvers.problems import PROBLEMS
from solvers.problems.bar.scene import BarScene
from solvers.running.run import run
from solvers.scene import estimator_registry
from solvers.scene.estimator_registry import ESTIMATORS, Estimator
from solvers.solver.soundness import findings


def test_only_an_estimator_that_says_so_judges():
    naive = Estimator("naive", "a first attempt", colour="#606060")
    assert not naive.judges and "a first attempt" in naive.explanation
    assert {name for name, one in ESTIMATORS.items() if one.judges} == {"recovered", "companion", "two-grid"}


@pytest.mark.parametrize("judges", [False, True])
def test_a_naive_estimator_calls_no_good_run_lost(monkeypatch, judges):
    """One that puts the error of x at ten amplitudes: only where it may judge is that found."""
    scene = BarScene(periods=0.05, estimators=("recovered",))
    monkeypatch.setitem(estimator_registry.ESTIMATORS, "recovered", replace(ESTIMATORS["recovered"], judges=judges))
    series = dict(run(scene).series)
    series["recovered/estimate_x"] = np.full_like(series["time"], 10 * scene.amplitude)
    assert set(findings(scene, series)) == ({"recovered"} if judges else set())


@pytest.mark.parametrize("own", [("companion", "recovered"), ()])
def test_a_scene_that_says_no_more_asks_the_first_of_its_estimators(own):
    """Whichever it has: a problem without transport must not ask for it."""
    @dataclass(frozen=True)
    class OwnScene(BarScene):
        ESTIMATORS = own

    scene = OwnScene()
    assert scene.estimators == scene.active_estimators == own[:1]
    assert list(OwnScene.__dataclass_fields__) == list(BarScene.__dataclass_fields__)
    assert all(problem.scene().estimators == problem.estimators[:1] for problem in PROBLEMS.values())
