"""What the ring's results must be: scaling laws and known failures. The independent program's table and the orders
are in tests/solvers/estimators/test_accuracy.py."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from solvers.problems.ring import exact
from solvers.problems.ring.scene import RingScene
from solvers.problems.ring.solver import RingSolver
from solvers.scene.rules import SceneError

METHODS = ["ugimp", "cpgimp", "cpdi"]
SHORT = RingScene(cells=16, periods=0.25, cfl=0.1, estimators=(), effects=("truth",))


def table_scene(method: str, cells: int) -> RingScene:
    return RingScene(method=method, cells=cells, dt=2e-5, periods=1, estimators=())


@pytest.mark.parametrize("change", [
    {"cells": 17}, {"ppc": 3}, {"amplitude": 0.11}, {"modulus": 1.1e7}, {"density": 1100.0},
    {"cfl": 0.11}, {"cfl": None, "dt": 1e-4}, {"periods": 0.3}, {"periods": None, "t_end": 0.006},
    {"layout": "cartesian"}, {"body_force": "none"}, {"velocity": "particle"}, {"method": "ugimp"}], ids=str)
def test_every_input_reaches_the_kernel(change, simulate):
    """An input baked into compiled code would leave the result as it was."""
    one, other = simulate(SHORT).final, simulate(replace(SHORT, **change)).final
    assert one.velocity.shape != other.velocity.shape or not np.array_equal(one.velocity, other.velocity)
    assert np.isfinite(other.velocity).all()


@pytest.mark.parametrize(("modulus", "density"), [(4e7, 1000.0), (1e7, 10.0), (3.3e5, 270.0)])
def test_modulus_and_density_only_scale_time(modulus, density, simulate):
    """At one cfl and number of periods: same x, v scaled by c, sigma by E; rounding over 66 steps."""
    one, other = simulate(SHORT), simulate(replace(SHORT, modulus=modulus, density=density))
    c = other.scene.wave_speed / SHORT.wave_speed
    assert one.steps == other.steps
    for name, scale in {"error_x": 1, "error_v": c, "error_sigma": modulus / SHORT.modulus}.items():
        np.testing.assert_allclose(other.series[name], scale * one.series[name], rtol=1e-8,
                                   atol=1e-11 * scale * np.abs(one.series[name]).max())


@pytest.mark.parametrize("method", METHODS)
def test_unstable_runs_end_with_a_reason(method, simulate):
    """At cfl 1.2 every method breaks (limits are 0.8 and 0.9): a result, and a sentence that says what to do."""
    result = simulate(RingScene(method=method, cells=24, cfl=1.2, periods=5))
    assert result.status == "unstable" and result.steps < result.scene.steps
    assert "went unstable" in result.reason and "shorter steps" in result.reason


@pytest.mark.parametrize("method", METHODS)
def test_energy_balance(method, simulate):
    """Kinetic + strain - work keeps its start to 5 % at 24 cells; a missing term would show as a fifth or more."""
    series = simulate(RingScene(method=method, cells=24, cfl=0.05)).series
    balance = series["kinetic"] + series["strain"] - series["work"]
    assert np.abs(balance / balance[0] - 1).max() < 0.05
    assert np.ptp(series["strain"]) > 0.2 * balance[0] and np.ptp(series["work"]) > 0.2 * balance[0]


def test_snapshot_errors_are_the_sampled_norms(simulate):
    """The RMS of the snapshot's errors (numpy) is the last sample (kernel); rounding relative to the fields."""
    result = simulate(RingScene(cells=16, periods=0.25, cfl=0.1))
    rms = np.sqrt((result.final.error**2).mean(0))
    for value, name in zip(rms, ("error_x", "error_v", "error_sigma", "error_a"), strict=True):
        assert value == pytest.approx(result.series[name][-1], rel=1e-9), name
    estimate = np.sqrt((result.final.estimate["transport"] ** 2).mean(0))
    assert estimate[0] == pytest.approx(result.series["transport/estimate_x"][-1], rel=1e-9)


def test_particle_velocity_is_much_worse(simulate):
    """Eq 24 as printed, x += dt v_p: at least ten times the error of the grid's velocity at 48 cells, or a break."""
    other = simulate(replace(table_scene("cpdi", 48), velocity="particle"))
    best = simulate(table_scene("cpdi", 48)).error["x"]["final"]
    assert other.status == "unstable" or other.error["x"]["final"] > 10 * best


def test_polar_layout_is_much_better_than_the_staircase(simulate):
    """A staircase rim is not free of traction where it should be: velocity error at least three times larger."""
    stairs = simulate(replace(table_scene("cpdi", 48), layout="cartesian"))
    assert stairs.error["v"]["final"] > 3 * simulate(table_scene("cpdi", 48)).error["v"]["final"]


def test_resonance_growth_and_expected_life():
    """The factors computed for the exact motion, and the periods that CPDI lasts at A = 0.15 on 24, 48 and 96 cells."""
    for A, growth in ((0.1, 1.0), (0.12, 1.44), (0.13, 1.84), (0.14, 2.20), (0.15, 2.57)):
        assert RingScene(amplitude=A).growth == pytest.approx(growth, abs=5e-3)
    large = RingScene(amplitude=0.15)
    for first, periods in ((1.07e-3, 5.8), (1.64e-4, 7.8), (2.26e-5, 9.9)):
        assert large.expected_life(first) == pytest.approx(periods, abs=0.05)
    assert RingScene(amplitude=0.1).expected_life() == math.inf
    assert "grows 2.57-fold a period or faster" in RingScene(amplitude=0.16).warnings()[0]


def test_amplitude_rules():
    """Inversion from 0.386 on is refused, resonance from 0.115 and wrinkling above 0.198 only told."""
    assert RingScene(amplitude=0.114).warnings() == []
    assert "parametric resonance" in RingScene(amplitude=0.115).warnings()[0]
    assert "wrinkles" not in RingScene(amplitude=0.19).warnings()[0]
    assert "wrinkles" in RingScene(amplitude=0.2).warnings()[0]
    for value in (0.386, 0.5, 0.0, -0.1, math.nan):
        with pytest.raises(SceneError, match="amplitude"):
            RingScene(amplitude=value)
    R = np.linspace(exact.INNER, exact.OUTER, 10_001)
    w, slope, _ = exact.shape(R)
    assert 1 / max(np.abs(slope).max(), (w / R).max()) == pytest.approx(0.386, abs=1e-3)


@pytest.mark.parametrize(("amplitude", "growth"), [(0.12, 1.44), (0.13, 1.84)])
def test_the_rings_own_motion_is_unstable(amplitude, growth):
    """A kick of 1e-9 m grows in the mode with two waves around as Floquet's theory has it for the exact motion, and not
    for any scheme: multipliers of linearised elastodynamics, to 5 %, once other modes have been outgrown."""
    scene = RingScene(cells=24, amplitude=amplitude, cfl=0.3, periods=16, estimators=(), effects=())
    kicked, plain = RingSolver(scene), RingSolver(scene)
    X = plain._arrays.material_position
    kicked._arrays.position_velocity[:, :2] += 1e-9 * np.random.default_rng(3).normal(size=X.shape)
    R, angle, steps = np.hypot(*X.T), np.arctan2(X[:, 1], X[:, 0]), round(scene.period / scene.time_step)
    sizes = []
    for _ in range(16):
        for solver in (kicked, plain):
            solver.advance(steps)
        u = kicked._arrays.position_velocity[:, :2] - plain._arrays.position_velocity[:, :2]
        radial, hoop = (u * X).sum(axis=1) / R, (u[:, 1] * X[:, 0] - u[:, 0] * X[:, 1]) / R
        sizes.append(abs(np.mean(radial * np.cos(2 * angle))) + abs(np.mean(hoop * np.sin(2 * angle))))
    assert (sizes[-1] / sizes[-9]) ** (1 / 8) == pytest.approx(growth, rel=0.05)
