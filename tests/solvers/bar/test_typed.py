"""A bar that moves as somebody has typed: the built-in motion again, and others, whose errors fall as they should."""

from dataclasses import replace

import numpy as np
import pytest

from solvers import run
from solvers.problems.bar.scene import BarScene
from solvers.scene.causes import FIELDS
from solvers.scene.rules import SceneError
from solvers.solver.soundness import evidence

SINE = "A*sin(2*pi*X)*sin(w*t)"
TWO_TONES = "0.02*sin(2*pi*X)*sin(2*pi*t) + 0.005*sin(6*pi*X)*sin(6*pi*t)"
UNEVEN = "0.01*sin(pi*X)**2*(1-cos(w*t)) + 0.003*sin(4*pi*X)*sin(2*w*t)"  # its mean moves, and a(0) is not 0


@pytest.mark.parametrize("method", BarScene.choices("method"))
def test_the_built_in_motion_can_be_typed(method):
    """And is the same to rounding, error and all."""
    own = BarScene(cells=20, periods=1, method=method, estimators=())
    typed = replace(own, displacement=SINE)
    assert [typed.period, typed.lattice_gap] == pytest.approx([own.period, own.lattice_gap], rel=1e-8)
    assert typed.step_bound == pytest.approx(own.step_bound, rel=0.02)  # of a whole period, not half of one
    for quantity in ("x", "v", "sigma", "a"):
        assert typed.size_of(quantity) == pytest.approx(own.size_of(quantity), rel=1e-12)
        assert typed.rms_of(quantity) == pytest.approx(own.rms_of(quantity), rel=1e-12)
    one, other = (run(scene, prices=False) for scene in (own, typed))
    for name in ("position", "velocity", "deformation_gradient"):
        np.testing.assert_allclose(getattr(other.final, name), getattr(one.final, name), rtol=0, atol=1e-12)
    for quantity in ("x", "v", "sigma", "a"):
        assert other.error[quantity]["max"] == pytest.approx(one.error[quantity]["max"], rel=1e-9)


def test_a_free_vibration_can_be_typed():
    """Its body force is nothing but rounding."""
    own = BarScene(cells=20, periods=1, body_force="none", estimators=("companion",))
    typed = replace(own, displacement="0.5*A*sin(2*pi*X)*sin(2*w*t)", body_force="material")
    one, other = (run(scene, prices=False) for scene in (own, typed))
    np.testing.assert_allclose(other.final.position, one.final.position, rtol=0, atol=1e-12)
    assert other.index["companion"]["x"] == pytest.approx(one.index["companion"]["x"], abs=1e-6)


def test_second_order():
    """Where domains tile: by four from 40 to 80 to 160 cells, from which on three waves are well resolved; in
    amplitudes twice the error of one wave at that strain on 80 cells, .0010."""
    scenes = [BarScene(cells=cells, cfl=0.1, periods=1, method="cpgimp", displacement=TWO_TONES, estimators=(),
                       effects=("truth", "soundness")) for cells in (40, 80, 160)]
    coarse, middle, fine = (run(scene, prices=False).error["x"]["max"] for scene in scenes)
    assert 3.2 < coarse / middle < 4.8 and 3.6 < middle / fine < 4.4
    assert middle / scenes[1].size_of("x") < 0.0025


@pytest.mark.parametrize("text", [TWO_TONES, UNEVEN])
def test_estimators_and_budget(text):
    """Companion and recovered are as good as on the built-in motion, and the causes add up to the error."""
    scene = BarScene(cells=64, cfl=0.1, periods=1, method="cpgimp", displacement=text,
                     estimators=("companion", "recovered"), effects=("truth", "estimate", "soundness", "budget"))
    result = run(scene, prices=False)
    assert (result.status, result.reason, result.not_valid) == ("ok", None, {})
    assert [result.index["companion"][quantity] for quantity in "xv"] == pytest.approx([1, 1], abs=0.01)
    assert [result.index["recovered"][quantity] for quantity in "xv"] == pytest.approx([1, 1], abs=0.1)
    for field in FIELDS:
        assert sum(result.budget[field].values()) == pytest.approx(1, abs=1e-6)
    assert max(share or 0 for share in evidence(scene, result.series).values()) < 0.01


def test_two_grid_counts_the_waves():
    """Three waves need three times the cells of one."""
    scene = BarScene(cells=40, periods=0.5, method="cpgimp", displacement=TWO_TONES, estimators=("two-grid",))
    assert "half of 40 is too few; give 48" in scene.not_valid["two-grid"]
    result = run(replace(scene, cells=128, cfl=0.1), prices=False)
    assert result.not_valid == {} and result.index["two-grid"]["x"] == pytest.approx(1, abs=0.2)


@pytest.mark.parametrize(("field", "inputs"), [
    ("body_force", {"body_force": "node"}), ("body_force", {"body_force": "two-tone"}),
    ("displacement", {"motion": "patch"})])
def test_what_does_not_go_with_it(field, inputs):
    with pytest.raises(SceneError) as refused:
        BarScene(displacement=SINE, **inputs)
    assert refused.value.field == field
