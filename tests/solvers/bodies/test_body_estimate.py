"""Estimates and bars of a body's run: against an exact motion and finer companions, and where there must be none."""

import dataclasses

import numpy as np
import pytest

from solvers.bodies.body_file import library_text, parse_body
from solvers.bodies.companion import BodyCompanion
from solvers.bodies.estimate import Differences, ErrorEstimate, corner_exponent, extrapolation_factor
from solvers.bodies.goal import Goal
from solvers.bodies.goal_values import GoalSeries, goal_weights
from solvers.bodies.material_points import MaterialPoints
from solvers.bodies.run import SAMPLES, run_body
from solvers.study.coverage.random_cantilevers import compare_with_truth
from tests.solvers.bodies import exact_bodies

BEAM, BLOCK, SECTOR = (parse_body(library_text(name)) for name in ("cantilever", "thrown_block", "swinging_sector"))


@pytest.mark.parametrize(("nu", "exponent", "factor"), [(0.1, 0.867, 0.325), (0.2, 0.781, 0.392), (0.3, 0.711, 0.461),
                                                        (0.4, 0.650, 0.535), (0.45, 0.622, 0.575)])
def test_the_singularity_of_a_clamped_corner(nu, exponent, factor):
    """Williams' exponents in plane strain."""
    assert corner_exponent(nu) == pytest.approx(exponent, abs=6e-4)
    assert extrapolation_factor(dataclasses.replace(BEAM, poissons_ratio=nu)) == pytest.approx(factor, abs=1e-3)
    assert extrapolation_factor(dataclasses.replace(BLOCK, poissons_ratio=nu)) == 0


def test_the_factor_of_a_clamped_corner_is_continuous():
    """From 0.1 at Poisson's ratio 0, where nothing is singular, to the law's at 0.1. Measured on 4 x 1 elements at 0,
    0.02, 0.05 and 0.1: 0.12, 0.13, 0.18 and 0.29; on 8 x 2: 0.12, 0.14, 0.21 and 0.33."""
    factors = [extrapolation_factor(dataclasses.replace(BEAM, poissons_ratio=nu)) for nu in np.linspace(0, 0.2, 21)]
    assert factors[0] == 0.1 and (np.diff(factors) > 0).all() and np.diff(factors).max() < 0.05
    assert factors[5] == pytest.approx(0.195, abs=0.025)


@pytest.mark.parametrize(("method", "cells"), [("ugimp", 16), ("cpgimp", 16), ("cpdi", 16), ("cpgimp", 32)])
def test_the_index_of_the_axis_aligned_motion(method, cells):
    """Control: sums of the true errors over the samples, within the bounds that issue and theory give."""
    body = exact_bodies.square(method, cells)
    result = run_body(body)
    run, errors = MaterialPoints(body, SAMPLES, body.lattice_counts, half_start=True), []
    for _ in range(SAMPLES):
        run.advance()
        u, v, _ = exact_bodies.square_motion(run.lattice.position, run.time)
        errors.append([np.sqrt(np.sum(one**2, axis=1).mean()) for one in (run.displacement - u, run.velocity - v)])
    index = [result.estimate[name].mean / true for name, true in zip("xv", np.mean(errors, axis=0), strict=True)]
    assert all(0.97 <= one <= 1.04 for one in index)


def test_bars_hold_and_a_finer_companion_agrees():
    """The cantilever's tip, its period and a named stress."""
    body = dataclasses.replace(BEAM, cells_per_metre=4)
    result = run_body(body)
    index, true = compare_with_truth(body, result, order=6)
    assert result.status == "ok" and not result.remarks and result.estimate["x"].trust == "number"
    assert 0.98 <= index["x"] <= 1.02
    for name, value in true.items():
        found = result.goals[name]
        assert 0.1 * found.bar <= abs(found.value - value) <= found.bar < 0.1 * abs(found.value)


def test_equal_runs_give_equal_bits():
    body = dataclasses.replace(SECTOR, cells_per_metre=8, t_end=0.2)
    first, second = (run_body(body).to_dict() for _ in range(2))
    assert {**first, "seconds": 0} == {**second, "seconds": 0}


def test_a_body_that_may_fold_gets_a_number_until_then():
    """The field's classic, a soft cantilever: two families of companions part at about 1.3 s."""
    body = dataclasses.replace(BEAM, youngs_modulus=1e6, t_end=3.0, cells_per_metre=4, domain=((-1, -6), (6, 4)),
                               elements_across=None)
    result = run_body(body)
    assert 1.1 <= result.until <= 1.4 and len(result.remarks) == 1
    for words in ("pressed to less than half near", "may fold", "differ by as much as they find"):
        assert words in result.remarks[0]
    assert all(goal.value is not None for goal in result.goals.values())
    with_bars = {name for name, goal in result.goals.items() if goal.bar is not None}
    assert with_bars == {"stress"}  # at 0.65 s; the tip is lowest at 1.1 s, when the body is pressed to less than half
    early = run_body(dataclasses.replace(body, t_end=0.8))
    assert early.until == 0.8 and early.goals["lowest"].bar is not None


def test_a_run_that_leaves_its_domain_says_so():
    result = run_body(dataclasses.replace(BLOCK, cells_per_metre=8, domain=((-0.5, -0.5), (1.5, 1.5))))
    assert result.status == "unstable" and "left the domain" in result.reason and result.time < BLOCK.t_end
    assert result.goals["corner"].value is None and result.estimate["x"].mean > 0


def test_companions_that_have_failed_are_not_asked_again(monkeypatch):
    """The particles go on to the end; goals have values without bars."""
    steps = []

    def advance(self):
        steps.append(self)
        self.motion[:] = np.nan

    monkeypatch.setattr(BodyCompanion, "advance", advance)
    result = run_body(dataclasses.replace(SECTOR, cells_per_metre=8, t_end=0.2))
    assert len(steps) == 2 and result.status == "ok" and result.time == pytest.approx(0.2) and not result.estimate
    assert "the companions have failed" in result.remarks[0]
    assert all(goal.bar is None and goal.value is not None for goal in result.goals.values())


def differences(coarse, error=0.1):
    """Of a run 0.1 off a companion whose motion is 1, for this one of the coarser companion and estimated ``error``."""
    return Differences(*(np.full(3, one) for one in (abs(coarse - 1), 0.1, error)))


@pytest.mark.parametrize(("coarse", "trust"), [(1.02, "number"), (1.05, "30 %"), (1.2, "none")])
def test_delta_decides_how_far_to_believe(coarse, trust):
    """The companions differ by 0.2, 0.5 and twice of what they find."""
    estimate = ErrorEstimate(BLOCK)
    estimate.add(0.1, differences(coarse), 1.0, np.zeros(2))
    one = estimate.quantities()["x"]
    assert one.delta == pytest.approx((coarse - 1) / 0.1) and one.trust == trust
    assert one.final == pytest.approx(0.1)
    assert (one.to_dict()["final"] is None) == (trust == "none") == bool(estimate.remarks(1))


def test_delta_of_an_extrapolated_position():
    """0.3 of the companions' difference over the error that is left: K = 0.461 at a Poisson's ratio of 0.3."""
    estimate = ErrorEstimate(BEAM)
    estimate.add(0.1, differences(0.9, 0.1 - 0.0461), 1.0, np.zeros(2))
    assert estimate.quantities()["x"].delta == pytest.approx(0.3 * 0.1 / (0.1 - 0.0461))
    assert estimate.quantities()["v"].delta == pytest.approx(1)


@pytest.mark.parametrize(("coarse", "stretch"), [(np.nan, 1.0), (np.inf, 1.0), (1.0, -0.1)])
def test_a_companion_that_fails_ends_the_estimate(coarse, stretch):
    """Without a finite motion, or turned inside out."""
    estimate = ErrorEstimate(BEAM)
    estimate.add(0.1, differences(1.0), 1.0, np.zeros(2))
    estimate.add(0.2, differences(coarse), stretch, np.zeros(2))
    estimate.add(0.3, differences(1.0), 1.0, np.zeros(2))
    assert estimate.until == 0.1 and "from t = 0.2 s the companions have failed" in estimate.sentence


@pytest.mark.parametrize(("value", "expected"), [
    ("min y", 0.3), ("end y", 0.65 + 0.35 * np.cos(7.0)), ("time of return y", 2 * np.pi / 5), ("max y", 1.0)])
def test_goals_of_a_swing(value, expected):
    """y = 1 - 0.35 (1 - cos 5 t), of which a parabola through samples finds extremes to fourth order."""
    times, X = np.linspace(0, 1.4, 61), np.array([[x, y] for x in range(5) for y in range(5)], float)
    goal = Goal(value, (2.0, 1.0))
    series = GoalSeries(goal, goal_weights(goal, X))
    for t in times[1:]:
        series.add(np.full((3, 25, 8), 0.35 * (np.cos(5 * t) - 1)))
    found = series.evaluate(times, len(times))
    assert found.value == pytest.approx(expected, abs=1e-4) and found.bar == pytest.approx(0, abs=1e-12)


@pytest.mark.parametrize(("known", "has_bar"), [(28, False), (29, True), (45, True), (61, True)])
def test_a_goal_keeps_its_bar_beyond_the_end_of_the_estimate(known, has_bar):
    """If the lowest place, here in sample 27, and the next sample lie before it: companions have no numbers after."""
    times, goal = np.linspace(0, 1.4, 61), Goal("min y", (0.0, 1.0))
    series = GoalSeries(goal, np.ones(1))
    for k, t in enumerate(times[1:], 1):
        fields = np.full((3, 1, 8), 0.35 * (np.cos(5 * t) - 1))
        fields[1:] *= 1.01 if k < known else np.nan
        series.add(fields)
    found = series.evaluate(times, known)
    assert found.value == pytest.approx(0.3, abs=1e-4)
    assert found.bar == (pytest.approx(0.007, rel=1e-3) if has_bar else None)


@pytest.mark.parametrize(("value", "bar"), [("end y", 0.4), ("max |sigma_xx|", 0.8)])
def test_a_bar_is_the_estimate_and_the_companions_difference(value, bar):
    """Run 1.3, coarser companion 0.9, finer 1: doubled for a stress."""
    series = GoalSeries(Goal(value, (2.0, 2.0)), np.array([0.25, 0.75]))
    for _ in range(2):
        series.add(np.tile(np.array([1.3, 0.9, 1.0])[:, None, None], (1, 2, 8)))
    assert series.evaluate(np.arange(3.0), 3).bar == pytest.approx(bar)
    assert series.evaluate(np.arange(3.0), 2).bar is None
