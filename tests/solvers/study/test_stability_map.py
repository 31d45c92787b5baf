"""What a map of stability says of a row, which its command's runs do not show: when a run ended."""

import pytest

from solvers.problems.bar.scene import BarScene
from solvers.study.stability_map import TREATMENTS, stayed_accurate, survived_periods, treatment_of


@pytest.mark.parametrize(("accurate", "sound", "status", "periods", "held"), [
    (None, None, "ok", 10.0, True), (3.0, None, "ok", 3.0, False), (None, 5.0, "lost", 5.0, False),
    (3.0, 5.0, "unstable", 3.0, False), (5.0, 3.0, "lost", 3.0, False)])
def test_a_run_lasts_until_the_first_of_its_ends(accurate, sound, status, periods, held):
    row = {"life": {"accurate": accurate, "sound": sound}, "scene": {"periods": 10.0}, "status": status}
    assert survived_periods(row) == periods and stayed_accurate(row) is held


@pytest.mark.parametrize("name", TREATMENTS)
def test_a_row_is_of_the_treatment_that_its_scene_was_given(name):
    """In whatever order its stabilisations are; with a step of its own it is of the same."""
    scene = BarScene(method="cpgimp", dt=1e-3, **TREATMENTS[name]).to_dict()
    for remedies in (scene["remedies"], scene["remedies"][::-1]):
        assert treatment_of({"scene": {**scene, "remedies": remedies}}) == name
