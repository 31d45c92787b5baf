"""A bar that moves as somebody has typed: the built-in motions again, and others, whose errors fall as they should."""

from dataclasses import replace

import numpy as np
import pytest

from solvers import run
from solvers.problems.bar.scene import BarScene
from solvers.scene.validation import SceneError
from solvers.solver.soundness import evidence

SINE, FREE = "A*sin(2*pi*X)*sin(w*t)", "0.5*A*sin(2*pi*X)*sin(2*w*t)"  # of the free one the force is but rounding
TWO_TONES = "0.02*sin(2*pi*X)*sin(2*pi*t) + 0.005*sin(6*pi*X)*sin(6*pi*t)"
UNEVEN = "0.01*sin(pi*X)**2*(1-cos(w*t)) + 0.003*sin(4*pi*X)*sin(2*w*t)"  # its mean moves, and a(0) is not 0


@pytest.mark.parametrize(("method", "force", "text"), [
    *((method, "material", SINE) for method in BarScene.choices("method")), ("ugimp", "none", FREE)])
def test_the_built_in_motions_can_be_typed(method, force, text):
    """And are the same to rounding, sizes, errors and all; the bound of a step is of a whole period."""
    own = BarScene(cells=20, periods=1, method=method, body_force=force, estimators=())
    typed = replace(own, displacement=text, body_force="material")
    assert [typed.period, typed.neighbour_mismatch] == pytest.approx([own.period, own.neighbour_mismatch], rel=1e-8)
    assert typed.step_bound == pytest.approx(own.step_bound, rel=0.02)
    one, other = (run(scene, prices=False) for scene in (own, typed))
    for name in ("position", "velocity", "deformation_gradient"):
        np.testing.assert_allclose(getattr(other.final, name), getattr(one.final, name), rtol=0, atol=1e-12)
    for quantity in ("x", "v", "sigma", "a"):
        for found in (lambda result, q=quantity: [result.scene.size_of(q), result.scene.rms_of(q)],
                      lambda result, q=quantity: result.error[q]["max"]):
            assert found(other) == pytest.approx(found(one), rel=1e-8)


def test_second_order():
    """Where domains tile: by four from 80 to 160 cells, of 27 for each of three waves; in amplitudes on 80 cells twice
    the error of one wave of that strain, .0010."""
    scenes = [BarScene(cells=cells, cfl=0.1, periods=1, method="cpgimp", displacement=TWO_TONES, estimators=())
              for cells in (40, 80, 160)]
    coarse, middle, fine = (run(scene, prices=False).error["x"]["max"] for scene in scenes)
    assert 3.2 < coarse / middle < 4.8 and 3.6 < middle / fine < 4.4
    assert middle / scenes[1].size_of("x") < 0.0025


@pytest.mark.parametrize("text", [TWO_TONES, UNEVEN])
def test_estimators_and_budget(text):
    """They are as good as on the built-in motion, causes add up to the error, and nothing contradicts itself."""
    scene = BarScene(cells=64, cfl=0.1, periods=1, method="cpgimp", displacement=text,
                     estimators=("companion", "recovered"),
                     effects=("truth", "estimate", "soundness", "acceleration", "budget"))
    result = run(scene, prices=False)
    assert (result.status, result.reason, result.not_valid) == ("ok", None, {})
    for name, near in (("companion", 0.01), ("recovered", 0.1)):
        assert [result.index[name][quantity] for quantity in "xv"] == pytest.approx([1, 1], abs=near)
    assert [sum(result.budget[field].values()) for field in "xvF"] == pytest.approx([1, 1, 1], abs=1e-6)
    assert result.series["error_a"][0] == 0  # none has been computed
    assert max(share or 0 for share in evidence(scene, result.series).values()) < 0.01


def test_two_grid_counts_the_waves():
    """Three waves need three times the cells of one."""
    scene = BarScene(cells=40, periods=0.5, method="cpgimp", displacement=TWO_TONES, estimators=("two-grid",))
    assert "half of 40 is too few; give 48" in scene.not_valid["two-grid"]
    result = run(replace(scene, cells=128, cfl=0.1), prices=False)
    assert result.not_valid == {} and result.index["two-grid"]["x"] == pytest.approx(1, abs=0.2)


@pytest.mark.parametrize("inputs", [{"body_force": "node"}, {"body_force": "two-tone"}, {"motion": "patch"}])
def test_what_does_not_go_with_it(inputs):
    with pytest.raises(SceneError, match=r"does not go with a typed|means nothing in a patch test"):
        BarScene(displacement=SINE, **inputs)
