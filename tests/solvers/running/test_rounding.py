"""An error that is nothing but rounding has no index, anywhere."""

import json
from dataclasses import replace

import numpy as np
import pytest

from app.commands.run.text_summary import run_table
from app.page.visit.history import NormHistory
from app.pictures.run_errors import run_figure
from solvers.problems.bar.scene import BarScene
from solvers.problems.vortex import VortexScene
from solvers.running.run import build
from solvers.solver.error_series import RunningEffectivityIndex
from solvers.solver.rounding import ROUNDINGS, largest_rounding_error

INDEX = ("truth", "acceleration", "estimate")  # what an index needs
PATCH = BarScene(motion="patch", cells=20, ppc=3, periods=2, estimators=("companion",), effects=INDEX)
QUANTITIES = ("x", "v", "sigma", "a")


def test_a_patch_test_that_is_passed_has_no_index(simulate):
    result = simulate(PATCH)
    values = json.loads(json.dumps(result.to_dict(), allow_nan=False))
    assert values["status"] == "ok" and values["index"] == values["distance"] == dict.fromkeys(QUANTITIES)
    assert values["rounding"].keys() == set(QUANTITIES)
    assert all(why.startswith("nothing but rounding: the true error") for why in values["rounding"].values())
    assert "no index of x: nothing but rounding" in run_table(values)


def test_one_that_fails_has(simulate):
    """2.5 particles a cell pull at their nodes unequally: errors far above the last digits."""
    values = simulate(replace(PATCH, method="mpm", ppc=2.5, periods=0.5)).to_dict()
    assert values["rounding"] == {} and values["index"]["x"] == pytest.approx(1, abs=0.01)


@pytest.mark.parametrize("scene", [BarScene(amplitude=1e-7, cells=80, linearity_preserving=True, periods=0.5),
                                   pytest.param(BarScene(cells=12, periods=0.5), marks=pytest.mark.slow),
                                   VortexScene(amplitude=1e-6, cells=18, ppc=2, cfl=0.2)])
def test_a_motion_has_however_small(scene, simulate):
    values = simulate(replace(scene, estimators=("companion",), effects=INDEX)).to_dict()
    assert values["rounding"] == {} and None not in values["index"].values()


def test_a_run_that_goes_on_has_none_either():
    solver = build(PATCH)
    history = NormHistory(PATCH, PATCH.particles)
    history.add(np.concatenate([solver.measure(), solver.advance(1000)]))
    series = history.series
    assert len(series["time"]) > 20 and np.isnan(series["companion/index_x"]).all()


def test_the_index_begins_when_an_error_rises_above_rounding():
    index = RunningEffectivityIndex()
    first = index.extend(np.array([3.0, 3.0]), np.array([1.0, 1.0]), 2.0)
    then = index.extend(np.array([3.0, 5.0, 1.0]), np.array([1.0, 5.0, 1.0]), 2.0)
    assert np.isnan(first).all() and np.isnan(then[0])
    assert then[1:] == pytest.approx([14 / 8, 15 / 9])  # of all that was, as eq 35 has it
    assert index.extend(np.array([2.0]), np.array([1.0]), 2.0) == pytest.approx([17 / 10])  # once begun it goes on


def test_rounding_grows_like_a_random_walk():
    """5,000 numbers added up one by one, a hundred times over: within the bound, and no ten-thousandth of it."""
    chance = np.random.default_rng(1)
    steps = 5000
    numbers = chance.uniform(-1, 1, (100, steps))
    sums = np.cumsum(numbers, axis=1)[:, -1]
    exact = np.array([float(np.sum(np.sort(row).astype(np.longdouble))) for row in numbers])
    limit = largest_rounding_error(PATCH, "x", steps) / (1 + PATCH.drift_speed * PATCH.end_time)
    assert limit / ROUNDINGS / 100 < np.sqrt(np.mean((sums - exact) ** 2)) < limit


def test_a_bar_that_drifts_is_rounded_as_far_out_as_it_comes():
    """Its coordinates reach 1 m and what it moves at its speed, which rounding is a share of."""
    slow, fast = (replace(PATCH, initial_velocity=speed, t_end=3.0, periods=None) for speed in (1.0, 5.0))
    assert largest_rounding_error(fast, "x", 100) / largest_rounding_error(slow, "x", 100) == pytest.approx(16 / 4)


def test_the_picture_says_so(simulate):
    figure = run_figure(simulate(PATCH))
    said = [text.get_text() for axes in figure.axes for text in axes.texts]
    assert "no index: the true errors are nothing but rounding" in said
