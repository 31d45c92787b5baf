"""Where recovered and two-grid keep silent, and where they do not: settings of which each was once refused though its
estimate was good, or said though it was bad, and in long form random ones."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from solvers.problems.bar.scene import BarScene
from solvers.problems.ring.scene import RingScene
from solvers.problems.vortex.scene import VortexScene
from solvers.scene.scene import Scene
from tests import estimator_audit
from tests.estimator_audit import counts, measure, scenes, verdict_on

RECOVERED, TWO_GRID = {"estimators": ("recovered",)}, {"estimators": ("two-grid",)}
BAR, RING, VORTEX = BarScene(), RingScene(), VortexScene()
FREE = {"body_force": "none", "linearity_preserving": True, "method": "cpgimp"}

#: Refused until now as too rough, of too few cells, for its amplitude, or for a remedy.
RIGHT = [
    replace(RING, method="cpgimp", cells=23, amplitude=0.01939, cfl=0.04322, periods=0.4178, **RECOVERED),
    replace(RING, method="cpgimp", cells=17, ppc=1, amplitude=0.02, cfl=0.2, periods=1.0, **RECOVERED),
    replace(RING, method="ugimp", cells=33, amplitude=0.23, cfl=0.35, periods=0.55, **RECOVERED),
    replace(VORTEX, cells=20, amplitude=0.1, frequency=0.25, cfl=0.2, periods=0.3, **RECOVERED),
    replace(BAR, method="mpm", cells=11, ppc=5, amplitude=1e-4, cfl=0.2, periods=0.66, **RECOVERED),
    replace(RING, cells=33, remedies=("null-space-filter",), amplitude=4e-3, cfl=0.3, periods=0.5, **TWO_GRID),
    replace(RING, method="cpgimp", cells=20, ppc=3, amplitude=0.01, cfl=0.2, periods=1.0, **TWO_GRID),
    replace(BAR, method="mpm", cells=54, ppc=5, amplitude=6.5e-5, cfl=0.25, periods=1.67, **TWO_GRID)]
#: Of each problem and estimator one; most of their time is that of compiling, and the slow set has them all.
OFTEN = [scene for k, scene in enumerate(RIGHT) if k in (1, 3, 4, 6, 7)]
#: With a step near the longest that the run stands, for which recovered's own elements were too narrow: refused as
#: having grown, or said, with an a of 5 and 2.4 times its error.
LONG_STEPS = [
    replace(RING, method="cpdi", cells=23, ppc=2, amplitude=0.0351, cfl=0.69, periods=1.27,
            remedies=("null-space-filter",), **RECOVERED),
    replace(RING, method="cpdi", cells=23, ppc=2, amplitude=0.0351, cfl=0.75, periods=4.0, **RECOVERED),
    replace(RING, method="cpdi", cells=13, ppc=2, amplitude=0.0576, cfl=0.8, periods=0.56, **RECOVERED)]
#: Said until now, and wrong, each with what is said instead.
WRONG = [
    (replace(VORTEX, method="ugimp", cells=46, amplitude=1.29, cfl=0.0865, periods=0.8316, poisson_ratio=0.3622,
             frequency=1.334, remedies=("null-space-filter",), **RECOVERED), "against each other"),
    (replace(VORTEX, cells=28, ppc=2, amplitude=0.86, cfl=0.09, periods=0.32, **RECOVERED), "against each other"),
    (replace(VORTEX, method="cpgimp", cells=25, amplitude=0.13, frequency=2.6, cfl=0.1, periods=0.17, **RECOVERED),
     "waves of a few cells")]


@pytest.mark.parametrize("scene", [pytest.param(scene, marks=() if scene in OFTEN else pytest.mark.slow) for scene in
                                   RIGHT], ids=lambda scene: f"{scene.problem} {scene.estimators[0]} {scene.method}")
def test_what_is_right_is_said(scene, simulate):
    """Within .9 to 1.1 in x, v and sigma."""
    result = simulate(scene)
    assert not result.not_valid and verdict_on(result.index[scene.estimators[0]]) == "good"


@pytest.mark.parametrize("scene", [
    pytest.param(scene, marks=pytest.mark.slow if scene.remedies else ()) for scene in LONG_STEPS],
    ids=lambda scene: f"{scene.cells} cells, cfl {scene.cfl}")
def test_recovered_bears_steps_as_long_as_the_run_does(scene, simulate):
    """x, v and sigma within .9 to 1.1. Of a, for which a coarse ring has few particles across: measured 1.1 and .73."""
    result = simulate(scene)
    assert not result.not_valid and verdict_on(result.index["recovered"]) == "good"
    assert 0.7 < result.index["recovered"]["a"] < 1.2


@pytest.mark.parametrize(("scene", "word"), [
    pytest.param(*each, marks=() if each is WRONG[1] else pytest.mark.slow) for each in WRONG],
    ids=lambda each: each.method if isinstance(each, Scene) else each)
def test_what_is_wrong_is_not_said(scene, word):
    row = measure(scene)
    index = row["index"]["recovered"]
    assert word in row["refused"]["recovered"] and (verdict_on(index) != "good" or index["sigma"] is None)


@pytest.mark.parametrize("scene", [
    replace(BAR, method="cpgimp", body_force="none", cells=51, ppc=3, amplitude=1.5e-4, cfl=0.0427, periods=0.51,
            **RECOVERED),
    replace(BAR, **FREE, cells=46, ppc=7, amplitude=1.129e-4, modulus=353300.0, density=0.2592, dt="auto",
            periods=1.241, **TWO_GRID)], ids=["recovered", "two-grid"])
def test_accelerations_between_two_of_an_estimators_own_steps(scene, simulate):
    """On a free bar, whose acceleration begins at zero: carried on along a line they were off by 2.7 and 1.7 times the
    error, above all at the first reports. Measured since: 1.14 and .88."""
    result, name = simulate(scene), scene.estimators[0]
    assert 0.8 < result.index[name]["a"] < 1.2 and result.distance[name]["a"] < 0.4


def test_what_each_rule_refuses():
    """In words, at the number where it begins."""
    for scene, word in (
            (replace(RING, cells=14, ppc=1, **RECOVERED), "needs 3 particles"),
            (replace(RING, ppc=1, velocity="particle", **RECOVERED), "velocity grid"),
            (replace(RING, amplitude=0.23, periods=0.7, **RECOVERED), "0.6 periods"),
            (replace(VORTEX, cells=23, amplitude=0.1, ppc=1, **RECOVERED), "24 cells"),
            (replace(VORTEX, cells=23, amplitude=0.1, velocity="particle", **RECOVERED), "24 cells"),
            (replace(VORTEX, cells=23, amplitude=0.1, **RECOVERED), "frequency of 0.77/s"),
            (replace(VORTEX, amplitude=1.05, **RECOVERED), "give 50 cells"),
            (replace(BAR, remedies=("null-space-filter", "coupled-deformation"), amplitude=1e-3, **TWO_GRID),
             "leave coupled-deformation out"),
            (replace(RING, method="cpgimp", ppc=3, cells=25, **TWO_GRID), "tile"),
            (replace(RING, amplitude=0.21, periods=0.7, **TWO_GRID), "the two runs part"),
            (replace(RING, cells=14, remedies=("null-space-filter",), **TWO_GRID), "give 15")):
        assert word in scene.not_valid[scene.estimators[0]], scene
    slow = replace(VORTEX, cells=23, amplitude=0.1, frequency=0.7, **RECOVERED)
    assert not slow.not_valid and "nothing of a here" in slow.warnings()[0]
    assert not replace(VORTEX, cells=24, amplitude=0.1, **RECOVERED).warnings()
    for scene in (replace(RING, cells=15, ppc=2, **RECOVERED), replace(RING, amplitude=0.23, periods=0.6, **RECOVERED),
                  replace(VORTEX, cells=50, amplitude=1.05, cfl=0.05, **RECOVERED),
                  replace(BAR, remedies=("null-space-filter",), amplitude=1e-3, **TWO_GRID),
                  replace(RING, method="cpgimp", ppc=3, cells=24, **TWO_GRID)):
        assert not scene.not_valid, scene


def test_a_swing_from_node_to_node_is_told():
    """The fourth difference of +1, -1, +1, ... is 16 everywhere, and of a wave of a few cells it is less."""
    from solvers.estimators.recovery import ROUGH, SIZE, doubt

    memory = {"recovered_nodes": np.zeros(4), "recovered_numbers": np.zeros(8)}
    memory["recovered_numbers"][[ROUGH, SIZE]] = 15.9**2, 1.0
    assert doubt(memory, 1.0) is None
    memory["recovered_numbers"][ROUGH] = 16.1**2
    assert "from node to node by 1 times the error" in doubt(memory, 1.0)


def test_a_run_is_counted_once_and_by_its_worst():
    """Of three runs: one refused and right, one said and wrong in sigma, one said, right, and wrong in a."""
    index = {"x": 1.0, "v": 1.05, "sigma": 0.95, "a": None}
    cases = ({"recovered": "not valid here: give 24 cells"}, {}), ({}, {"sigma": 1.6}), ({}, {"a": 0.5})
    rows = [{"status": "ok", "inputs": {"problem": "bar"}, "refused": refused,
             "index": {"recovered": {**index, **also}}} for refused, also in cases]
    refused, said = counts(rows)
    assert refused == {("recovered", "bar", "give # cells"): {"good": 1}}
    assert said[("recovered", "bar")] == {"bad": 1, "good": 1, "a bad": 1}
    assert estimator_audit.verdict_on({"x": 1.2, "v": 1.0, "sigma": None}) == "fair"


@pytest.mark.slow
def test_refusals_and_silences_of_random_runs():
    """Of runs that ended well nothing is said that is beyond 1.5; of what is refused some four fifths are not right."""
    refused, said = counts(map(measure, scenes(20261124, 240)))
    assert not sum(found["bad"] for found in said.values())
    for name in ("recovered", "two-grid"):
        found = [verdicts for key, verdicts in refused.items() if key[0] == name]
        assert sum(v["good"] for v in found) < 0.2 * sum(sum(v.values()) for v in found)
