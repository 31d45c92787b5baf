"""Remedies: what they cure, what they must leave alone, and what does not go together."""

from dataclasses import replace

import numpy as np
import pytest

from solvers.problems.bar.scene import BarScene
from solvers.problems.ring import RingScene
from solvers.problems.vortex import VortexScene
from solvers.running.run import run
from solvers.scene.validation import SceneError
from solvers.study.stability_map import offered_treatments

BOTH = ("null-space-filter", "coupled-deformation")
FROZEN = ("frozen-weights",)
HARD = BarScene(cfl=0.3, amplitude=0.1, periods=50, estimators=(), effects=("truth", "soundness"), sample_every=13)
METHODS = ("mpm", "ugimp", "cpgimp", "bspline")
RING = RingScene(method="ugimp", cfl=0.3, periods=20, estimators=(), effects=("truth", "soundness"), sample_every=7)


def worst(result):
    """Largest error of x in amplitudes."""
    return np.nanmax(result.series["error_x"]) / result.scene.motion_amplitude


CURES = {"both": {"remedies": BOTH, "linearity_preserving": True}, "frozen": {"remedies": FROZEN}}
#: Each cure; the slow set has all of all.
OFTEN = {("mpm", "both"), ("ugimp", "both"), ("cpgimp", "frozen")}


@pytest.mark.parametrize(("method", "cure"), [
    pytest.param(method, cure, marks=() if (method, cure) in OFTEN else pytest.mark.slow)
    for cure in CURES for method in METHODS])
def test_every_method_lives_with_a_cure(method, cure, simulate):
    """50 periods at A = 0.1 with an error of x below A/10; without, all four are lost (0.3 to 40 periods)."""
    cured = simulate(replace(HARD, method=method, **CURES[cure]))
    assert cured.status == "ok" and worst(cured) < 0.1
    assert worst(simulate(replace(HARD, method=method))) > 0.1


def test_zero_drift_keeps_the_whole_bar_in_place(simulate):
    """Linearity preservation makes forces that do not cancel; without the mean velocity the bar stays."""
    plain = simulate(replace(HARD, linearity_preserving=True))
    held = simulate(replace(HARD, linearity_preserving=True, remedies=("zero-drift",)))
    assert plain.series["mean_drift"].max() > 1e-3 > 1e-12 > held.series["mean_drift"].max()
    assert worst(held) < worst(plain)


def test_the_filter_leaves_momentum_and_what_nodes_see(simulate):
    """What it takes out has no momentum: the mean velocity stays at rounding."""
    result = run(replace(HARD, remedies=("null-space-filter",), periods=2), prices=False)
    assert abs(result.final.velocity.mean()) < 1e-13 * result.scene.size_of("v")


def test_in_short_runs_remedies_do_no_harm(simulate):
    """Error of x over the first period, the default bar: at most that of the plain run."""
    scene = replace(HARD, cfl=None, amplitude=BarScene().amplitude, periods=1, sample_every=None)
    plain = worst(simulate(scene))
    for remedies in (BOTH, FROZEN):
        assert worst(simulate(replace(scene, remedies=remedies))) <= 1.05 * plain


@pytest.mark.parametrize("method", ["ugimp", pytest.param("cpgimp", marks=pytest.mark.slow)])
def test_the_rings_boxes_live_with_filter_and_coupling(method, simulate):
    """20 periods at A = 0.1; plain uGIMP fails at 14.6."""
    result = simulate(replace(RING, method=method, remedies=BOTH))
    assert result.status == "ok" and worst(result) < 0.1
    if method == "ugimp":
        assert worst(simulate(RING)) > 0.1


@pytest.mark.parametrize("method", ["mpm", *(pytest.param(method, marks=pytest.mark.slow)
                                            for method in ("ugimp", "cpgimp", "cpdi"))])
def test_frozen_weights_hold_the_ring(method, simulate):
    """Hat functions too, which nothing else helps; and no particle crosses a cell."""
    scene = replace(RING, method=method, remedies=FROZEN, periods=10, effects=("truth", "soundness", "crossings"))
    result = simulate(scene)
    assert result.status == "ok" and worst(result) < 0.1
    assert result.to_dict()["grid_crossings"] == 0


def test_a_map_of_stability_has_the_treatments_that_a_problem_offers():
    assert offered_treatments(VortexScene) == ("plain", "filter", "frozen")


@pytest.mark.parametrize(("kind", "inputs", "word"), [
    (BarScene, {"remedies": ("frozen-weights", "zero-drift")}, "cannot be combined"),
    (BarScene, {"remedies": FROZEN, "linearity_preserving": True}, "frozen-weights"),
    (BarScene, {"remedies": FROZEN, "body_force": "node"}, "frozen-weights"),
    (BarScene, {"remedies": FROZEN, "method": "cpgimp", "velocity": "corners"}, "frozen-weights"),
    (RingScene, {"remedies": ("coupled-deformation",)}, "CPDI"),
    (RingScene, {"remedies": ("zero-drift",)}, "is not known"),
    (RingScene, {"remedies": ("frozen-weights", "null-space-filter")}, "cannot be combined"),
    (VortexScene, {"remedies": ("frozen-weights", "null-space-filter")}, "cannot be combined"),
    (BarScene, {"remedies": ("frozen-weights", "pieces")}, "cannot be combined: pieces corrects"),
    (RingScene, {"remedies": ("pieces",)}, "is not known")])
def test_what_does_not_go_together_is_refused(kind, inputs, word):
    with pytest.raises(SceneError) as caught:
        kind(**inputs)
    assert word in str(caught.value)
