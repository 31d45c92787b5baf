"""Quantities as wrong as they are large are named, and so is what was held against nothing."""

from dataclasses import replace

import numpy as np
import pytest

from app.commands.run.text_summary import run_table
from solvers.engine.soundness_monitor import SoundnessMonitor
from solvers.problems import PROBLEMS
from solvers.problems.bar.scene import BarScene
from solvers.problems.planar.particle_layout import particle_layout
from solvers.problems.ring import RingScene
from solvers.problems.vortex import VortexScene
from solvers.running.run import build
from solvers.solver.verdict_basis import large_errors

#: Both are right in x, and were called ok.
NOISY = {"v": BarScene(method="cpgimp", cells=5, ppc=6, amplitude=0.028, cfl=0.0562, periods=40,
                       linearity_preserving=True, estimators=("companion",)),
         "sigma": RingScene(method="mpm", cells=42, amplitude=0.1718, modulus=0.3271, density=0.02674, cfl=0.0661,
                            periods=0.3042, estimators=())}
WORDS = {"v": "velocity", "sigma": "stress"}


@pytest.mark.parametrize("quantity", NOISY)
def test_a_quantity_as_wrong_as_it_is_large_is_named(quantity, simulate):
    result = simulate(NOISY[quantity])
    values = result.to_dict()
    largest = result.series[f"error_{quantity}"].max() / result.scene.rms_of(quantity)
    assert (values["status"], result.broken_at) == ("ok", None)
    assert f"the {WORDS[quantity]} is off by up to {largest:.2g} times its own size" in values["reason"]
    found = values["as_large_as_itself"][quantity]
    assert (found["by"], found["size"]) == ("truth", pytest.approx(largest)) and 0 < found["since"] < values["t"]
    assert "x" not in values["as_large_as_itself"] and "ok for x, not for" in run_table(values)


def test_a_step_too_long_is_named_beside_them_and_recovered_does_not_hold(simulate):
    """Too short a run to break by it: positions are ok, the stress is not."""
    long = BarScene(method="mpm", amplitude=0.0034, periods=0.25, cfl=1.5, estimators=("recovered",))
    result = simulate(long)
    assert result.status == "ok" and result.not_valid["recovered"].endswith("give a cfl of 0.94 or less")
    times = f"{long.time_step / long.step_bound:.2g}"
    assert "the stress is off" in result.reason
    assert f"the time step is {times} times the longest stable" in result.reason
    assert "time step" not in simulate(NOISY["v"]).reason


def test_the_companion_says_it_where_the_truth_is_off(simulate):
    scene = replace(NOISY["v"], effects=("estimate", "soundness"))
    found = simulate(scene).to_dict()
    assert found["as_large_as_itself"]["v"]["by"] == "companion" and "according to companion" in found["reason"]


def test_a_run_that_goes_on_is_told_the_same(simulate):
    """The page's watch sees the samples piece by piece."""
    scene = NOISY["v"]
    result, solver = simulate(scene), build(scene)
    watch = SoundnessMonitor(scene)
    watch.check_samples(solver.measure(), scene.particles)
    while solver.step < scene.steps:
        watch.check_samples(solver.advance(min(500, scene.steps - solver.step)), scene.particles)
    status, reason, since = watch.current_status(solver, {})
    assert (status, since) == ("ok", None)
    assert reason == result.reason and watch.unchecked_note({}) is None


@pytest.mark.parametrize(("changes", "words"), [
    ({"effects": ()}, "only two checks were made: numbers stay finite"),
    ({"effects": ("soundness",)}, "velocity and stress were not checked"),
    ({"effects": ("truth",)}, None),
    ({"effects": ("truth",), "sample_every": 200}, "nothing was checked between two samples, 0.42 periods apart"),
    ({"effects": ("truth",), "sample_every": 10**6}, "nothing was checked between two samples, 0.5 periods apart"),
    ({"effects": ("estimate", "acceleration", "soundness"), "estimators": ("transport",)},
     "velocity, stress and acceleration were not checked"),
    ({"effects": ("estimate", "soundness"), "estimators": ("companion",)}, None)])
def test_what_was_held_against_nothing_is_said(changes, words, simulate):
    result = simulate(replace(BarScene(cells=12, periods=0.5, estimators=()), **changes)).to_dict()
    assert result["status"] == "ok"
    assert result["not_checked"] is None if words is None else words in result["not_checked"]
    assert words is None or words in run_table(result)


@pytest.mark.parametrize("scene", [BarScene(), BarScene(body_force="none"), RingScene(), VortexScene(amplitude=1.3)],
                         ids=lambda scene: f"{scene.problem}-{scene.body_force}")
def test_a_quantitys_own_size_is_that_of_the_exact_motion(scene):
    """Against means over a lattice of particles and 50 instants; within a hundredth, for these are another quadrature
    than that of the scene."""
    exact, times = PROBLEMS[scene.problem].reference, (np.arange(50) + 0.5) / 50 * scene.period
    if scene.problem == "bar":
        X, volume = (np.arange(200) + 0.5)[:, None] / 200, np.ones(200)
    else:
        layout = particle_layout(replace(scene, cells=60))
        X, volume = layout.position, layout.volume
    squares = {"v": [(exact.velocity(scene, X, t) ** 2).reshape(len(X), -1).sum(axis=1) for t in times],
               "sigma": [exact.exact_stress(scene, X, t).reshape(len(X), -1) ** 2 for t in times]}
    squares["sigma"] = [one @ np.array([1, 2, 1])[:one.shape[1]] if one.shape[1] == 3 else one.sum(axis=1)
                        for one in squares["sigma"]]
    for quantity, values in squares.items():
        assert scene.rms_of(quantity) == pytest.approx(np.sqrt(np.average(np.mean(values, axis=0), weights=volume)),
                                                       rel=0.01)


def test_nothing_is_named_without_errors(simulate):
    result = simulate(BarScene(cells=20, ppc=2, linearity_preserving=True, periods=0.5, estimators=()))
    assert result.reason is None and not large_errors(result.scene, result.series)
    assert all(result.scene.rms_of(q) > 0 and np.isfinite(result.scene.rms_of(q)) for q in ("x", "v", "sigma", "a"))


def test_how_long_a_run_was_accurate_does_not_depend_on_its_samples(simulate):
    """Nor on how long it goes on. Within a tenth of a period, though 4 or 40 samples are taken in one."""
    base = BarScene(ppc=1, cells=20, cfl=0.2, estimators=(), effects=("truth",))
    lives = [simulate(replace(base, periods=periods, sample_every=every)).life["accurate"]
             for periods, every in ((2, 5), (3, 5), (2, 50))]
    assert lives[0] == lives[1] == pytest.approx(lives[2], abs=0.1)


def test_a_life_ends_between_the_samples_beside_it(simulate):
    """On the straight line between them, at a tenth of the amplitude; the first period is that, and nothing later."""
    result = simulate(BarScene(cells=10, ppc=2, periods=2.0, estimators=()))
    time, period, A = result.series["time"], result.scene.period, result.scene.motion_amplitude
    error = np.where(time > 1.5 * period, 0.4 * A, 0.05 * A)
    life = replace(result, series={**result.series, "error_x": error}).life
    at = int(np.argmax(time > 1.5 * period))
    assert life["accurate"] * period == pytest.approx(time[at - 1] + (time[at] - time[at - 1]) / 7)
    assert life["first_period"] == pytest.approx(0.05) and life["sound"] is None
