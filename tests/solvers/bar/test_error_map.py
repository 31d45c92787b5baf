"""The map of where and when an error was made: it adds up, agrees with the budget that was carried forward by compiled
kernels, and refuses where it would show nothing."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest

from solvers.problems import PROBLEMS
from solvers.problems.bar.scene import BarScene
from solvers.problems.bar.solver import BarSolver
from solvers.problems.ring.scene import RingScene
from solvers.scene.causes import CAUSES, FIELDS
from solvers.scene.rules import SceneError

BAR = BarScene(cells=20, periods=0.25, estimators=(), effects=("truth",))
PATCH = {"motion": "patch", "method": "mpm", "ppc": 2.5}
SCENES: dict[str, dict] = {
    **{method: {"method": method} for method in BarScene.choices("method")},
    "particle": {"velocity": "particle"}, "corners": {"method": "cpgimp", "velocity": "corners"},
    "node": {"body_force": "node"}, "free": {"body_force": "none", "method": "mpm"}, "patch": PATCH,
    "lp": {"linearity_preserving": True, "body_force": "node"}, "frozen": {"remedies": ("frozen-weights",)},
    "pieces": {"remedies": ("pieces",)}, "lp pieces": {"remedies": ("pieces",), "linearity_preserving": True}}

#: Of each kind of step the field that the quick set asks for, all of them in turn; the slow set has every field of all.
OFTEN = dict(zip(SCENES, itertools.cycle(FIELDS), strict=False))


def traced(scene, field="x", particle=None):
    return PROBLEMS["bar"].error_map(scene, field, particle)


@pytest.mark.parametrize(("name", "field"), [
    pytest.param(name, field, marks=() if field == OFTEN.get(name) else pytest.mark.slow)
    for name in SCENES for field in FIELDS])
def test_back_is_what_forward_was(name, field):
    """The terms of the map add up to the error, to 1e-9; and those of a cause to its error in the compiled budget, to
    1e-10 of the whole: the transpose of the same steps, which only rounds otherwise."""
    scene = replace(BAR, **SCENES[name])
    for particle in (None, 7):
        found = traced(scene, field, particle)
        assert found.made.sum() / found.size == pytest.approx(1, abs=1e-9)
        assert sum(map(found.share, CAUSES)) == pytest.approx(1, abs=1e-9)
        solver = BarSolver(replace(scene, effects=("truth", "budget")))
        solver.advance(scene.steps)
        errors = solver._arrays.cause_errors[:3 * scene.particles].reshape(3, -1, len(CAUSES))
        carried = errors[FIELDS.index(field)] / (solver._arrays.unstretched if field == "F" else 1.0)
        forward = carried[7] if particle is not None else \
            carried.sum(axis=1) @ carried / (scene.particles * found.size)
        assert np.abs(found.made.sum(axis=(0, 2)) - forward).max() < 1e-10 * abs(found.size)


def test_hats_make_their_error_at_cell_boundaries():
    """88 % of the map of x on the third of the particles whose piece meets a boundary, and crossings 96 % of it."""
    scene = replace(BAR, method="mpm", cells=40)
    found = traced(scene)
    assert found.main_cause == "crossings" and 0.94 < found.share("crossings") < 0.99
    assert found.not_valid() is None and 1.5 < found.cancelled("crossings") < 2.5
    solver, near = BarSolver(scene), []
    for _ in range(scene.steps):
        x = solver._arrays.position * scene.cells
        near.append(np.abs(x - np.round(x)) < 0.5 * 1.3 / scene.ppc)
        solver.advance(1)
    near, made = np.array(near), np.abs(found.made[:, 0])
    assert made[near].sum() > 0.85 * made.sum() and near.mean() < 0.4


def test_bins_and_dots_are_of_the_same_run():
    """Binned, it is the same sum; as many dots as the run counts crossings; what was made until the end is all."""
    scene = replace(BAR, method="mpm", periods=0.5)
    found = traced(scene, "v")
    for cause in CAUSES:
        assert found.binned(cause, 30).shape == (30, scene.cells)
        assert found.binned(cause, 30).sum() == pytest.approx(found.share(cause), abs=1e-9)
        assert found.until(cause)[-1] == pytest.approx(found.share(cause), abs=1e-9)
    solver = BarSolver(replace(scene, effects=("truth", "crossings")))
    solver.advance(scene.steps)
    assert len(found.crossings) == solver._arrays.totals[0] > 0
    assert found.times[-1] == pytest.approx(scene.steps * scene.time_step)


def test_what_cancels_is_not_shown():
    """uGIMP's error of x after a period: made eightfold and unmade; without any error there is nobody to blame."""
    found = traced(replace(BAR, cells=40, periods=1))
    assert 5 < found.cancelled("crossings") < 12 and "cancels" in found.not_valid()
    nothing = traced(replace(BAR, **PATCH, remedies=("pieces",)))
    assert "round-off" in nothing.not_valid() and nothing.share("crossings") == 0


@pytest.mark.parametrize(("changes", "wanted", "said"), [
    ({"body_force": "two-tone"}, {}, "no known solution"), ({}, {"particle": 80}, "from 0 to 79"),
    ({}, {"field": "a"}, "x, v, F"), ({"remedies": ("zero-drift",)}, {}, "not through zero-drift"),
    ({"effects": ("truth", "budget"), "take_away": "crossings"}, {}, "leave it out"),
    ({"periods": 1e4}, {}, "end earlier")])
def test_what_has_no_map_is_refused(changes, wanted, said):
    with pytest.raises(SceneError, match=said):
        traced(replace(BAR, **changes), **wanted)


def test_other_problems_have_none_yet():
    with pytest.raises(SceneError, match="the bar has one"):
        PROBLEMS["ring"].error_map(RingScene())


def test_a_run_that_goes_bad_has_none():
    assert traced(replace(BAR, method="mpm", amplitude=0.14, periods=5, cfl=0.3)) is None
