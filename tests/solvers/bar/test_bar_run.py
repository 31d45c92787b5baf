"""How the bar runs: repeatable, in any slices, effects aside, honest about going bad; norms that add up."""

import json
from dataclasses import replace

import numpy as np
import pytest

from solvers.problems.bar.scene import BarScene
from solvers.problems.bar.solver import BarSolver
from solvers.running.run import run
from solvers.scene.effects import EFFECTS
from solvers.solver.serial_stepping import CHECK_EVERY

SCENE = BarScene(amplitude=0.05, cells=20, periods=1)
STATE = ("position", "velocity", "deformation_gradient")


@pytest.mark.parametrize("effect", EFFECTS)
def test_an_effect_switched_off_reports_nulls_and_takes_no_memory(effect, simulate):
    """Null and not zero: a zero would claim a perfect result."""
    scene = replace(SCENE, periods=0.1)
    on, off = map(simulate, (scene, replace(scene, effects=tuple(e for e in EFFECTS if e != effect))))
    seen, gone = ({"truth": r["error"]["x"]["max"], "estimate": r["estimate"]["x"]["max"],
                   "crossings": r["grid_crossings"], "energy": r["energy"],
                   "acceleration": r["error"]["a"]["max"], "soundness": r["soundness"]["neighbour_gap"],
                   "margin": r["step"]["margin"]}[effect] for r in (on.to_dict(), off.to_dict()))
    assert seen is not None and gone is None
    assert effect in on.effects and effect not in off.effects
    assert off.bytes < on.bytes or effect in ("energy", "soundness")  # these are sums in a sample's row


def test_sampled_norms_are_those_of_the_final_state():
    """The kernel's norms against numpy on the particles: RMS over particles of computed minus exact at fixed X."""
    scene = replace(SCENE, sample_every=7, periods=1.03)
    result = run(scene, prices=False)
    final, A, w, t = result.final, scene.amplitude, scene.angular_frequency, result.time
    assert scene.steps % 7 and result.series["time"][-1] == pytest.approx(t, rel=1e-15)
    X, sine = final.material_position, np.sin(2 * np.pi * final.material_position)
    F = 1 + 2 * np.pi * A * np.cos(2 * np.pi * X) * np.sin(w * t)
    expected = {"x": final.position - X - A * sine * np.sin(w * t), "v": final.velocity - A * w * sine * np.cos(w * t),
                "sigma": scene.modulus * (final.deformation_gradient - F),
                "sigma_log": scene.modulus * (np.log(final.deformation_gradient) - F + 1), "a": final.error[:, 3]}
    for name, error in expected.items():
        # sums of cancelling numbers up to 1: their rounding over the norm, 1e-16/1e-4
        assert result.error[name]["final"] == pytest.approx(np.sqrt(np.mean(error**2)), rel=1e-10)
    for k, name in enumerate(("x", "v", "sigma")):
        np.testing.assert_allclose(final.error[:, k], expected[name], rtol=0, atol=1e-13)


def test_grid_crossings_are_counted():
    """Against numpy, one step at a time: a crossing is a particle that changes its cell."""
    solver, cells = BarSolver(SCENE), []
    for _ in range(SCENE.steps):
        cells.append(np.floor(solver._arrays.position * SCENE.cells))
        solver.advance(1)
    cells.append(np.floor(solver._arrays.position * SCENE.cells))
    changes = np.diff(cells, axis=0)
    last = [np.flatnonzero(column)[-1] + 1 if column.any() else -1 for column in changes.T]
    assert solver._arrays.totals[0] == np.abs(changes).sum() > 100
    np.testing.assert_array_equal(solver.snapshot().last_crossing, last)


@pytest.mark.parametrize("cfl", [1.5, 10.0])
@pytest.mark.parametrize("method", ["mpm", "ugimp", "cpgimp", "bspline"])
def test_an_unstable_run_is_a_result(method, cfl):
    """Too long a step ends as ``unstable`` with a reason, in valid JSON, and leaves its neighbours alone."""
    neighbour, alone = BarSolver(SCENE), BarSolver(SCENE)
    neighbour.advance(100)
    bad = run(replace(SCENE, method=method, cfl=cfl), prices=False)
    assert bad.status == "unstable" and "the automatic step" in bad.reason and bad.steps <= bad.scene.steps
    json.dumps(bad.to_dict(), allow_nan=False)
    neighbour.advance(100)
    alone.advance(200)
    for name in STATE:
        np.testing.assert_array_equal(getattr(neighbour._arrays, name), getattr(alone._arrays, name))


def test_a_run_that_goes_bad_in_its_last_steps_is_noticed():
    """The kernel looks every 8 steps; a run shorter than that is looked at when it ends."""
    result = run(replace(SCENE, cfl=10.0, periods=1, amplitude=0.1, sample_every=1), prices=False)
    assert result.steps < CHECK_EVERY and result.status == "unstable"


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("name", STATE)
def test_a_number_gone_bad_is_noticed(name, value):
    """NaN or infinity in any particle's state stops the run at the next look, inside the arrays' bounds."""
    solver = BarSolver(SCENE)
    solver.advance(10)
    getattr(solver._arrays, name)[17] = value
    solver.advance(64)
    assert not solver.sound and solver.step == 2 * CHECK_EVERY and "particle" in solver.reason()


def test_a_folded_particle_is_noticed():
    """F <= 0 is matter turned inside out: no result, however finite the numbers."""
    solver = BarSolver(SCENE)
    solver._arrays.deformation_gradient[5] = -0.1
    solver.measure()
    assert not solver.sound and "particle 5" in solver.reason() and "inside out" in solver.reason()


def test_progress_is_told():
    """``on_progress`` rises to 1."""
    seen = []
    run(SCENE, seen.append)
    assert seen == sorted(seen) and seen[-1] == 1.0
