"""What follows from a displacement: the printed forces of ring and vortex. That all problems obey their equations is in
tests/solvers/scene/test_exact_solutions.py."""

import math
from dataclasses import replace

import numpy as np
import pytest

from solvers.motion.jets import Jet, cos, exp, log, sin, sqrt, variables
from solvers.motion.neo_hookean import cauchy_stress, first_piola_stress, strain_energy
from solvers.motion.separable_field import NotPeriodic, separate
from solvers.problems.planar.body_force import body_force_at
from solvers.problems.planar.layout import particle_layout
from solvers.problems.ring import RingScene
from solvers.problems.vortex import VortexScene
from tests.closed_forms import ring, vortex

TIMES = (0.0, 0.13, 0.31, 0.77)  # of a period
SCENES = {"ring": (RingScene(cells=12), ring), "vortex": (VortexScene(cells=16, amplitude=0.7), vortex)}


@pytest.fixture(params=SCENES)
def problem(request):
    scene, closed = SCENES[request.param]
    return scene, scene.EXACT, closed, particle_layout(scene).position


@pytest.mark.parametrize("part", TIMES)
def test_closed_forms_are_met(problem, part):
    """To rounding of the largest value over the body and a period, of u and of b, which has a and Div P in it; all else
    is held against these in tests/solvers/scene/test_exact_solutions.py."""
    scene, solution, closed, X = problem
    t = part * scene.period
    fields = [(scene, solution.displacement, closed.displacement), (scene, solution.body_force, closed.body_force),
              (replace(scene, body_force="two-tone"), body_force_at, closed.body_force)]
    for scene, derived, printed in fields:
        size = max(np.abs(printed(scene, X, one * scene.period)).max() for one in TIMES)
        np.testing.assert_allclose(derived(scene, X, t), printed(scene, X, t), rtol=0, atol=5e-15 * size,
                                   err_msg=printed.__name__)


def test_a_law_is_the_slope_of_its_energy():
    """P = dW/dF, and sigma = P F^T/J."""
    chance, moduli = np.random.default_rng(4), (3.0, 2.0)
    F = np.eye(2).ravel()[:, None] + 0.3 * chance.uniform(-1, 1, (4, 50))
    P, h = first_piola_stress(F, *moduli), 1e-6
    for k in range(4):
        ends = [strain_energy(F + sign * h * np.eye(4)[k][:, None], *moduli) for sign in (1, -1)]
        np.testing.assert_allclose(P[k], (ends[0] - ends[1]) / (2 * h), rtol=0, atol=1e-8)
    xx, xy, yy = cauchy_stress(F, *moduli)
    J, P, F = F[0] * F[3] - F[1] * F[2], np.stack(P).T.reshape(-1, 2, 2), F.T.reshape(-1, 2, 2)
    sigma = P @ F.transpose(0, 2, 1) / J[:, None, None]
    np.testing.assert_allclose(np.stack([xx, xy, xy, yy], axis=1).reshape(-1, 2, 2), sigma, rtol=0, atol=1e-13)


@pytest.mark.parametrize("function", [
    lambda X, Y, t: sin(X * Y) / (1 + t * t) - exp(-X) * cos(3 * t), lambda X, Y, t: sqrt(2 + X) ** 3 * log(2 + Y * t),
    lambda X, Y, t: (X - Y) ** 2 * (X - Y) ** 0 + 2 / (3 + X * t) - X ** 1 / 4], ids=["waves", "roots", "powers"])
def test_derivatives_are_those_of_differences(function):
    """First ones by central differences of values, second ones by those of first ones."""
    at, h = np.array([0.3, 0.7, 0.2]), 1e-6
    jet = function(*variables(*at))

    def shifted(k, sign):
        return function(*variables(*(at + sign * h * np.eye(3)[k])))

    for k in range(3):
        ahead, behind = shifted(k, 1), shifted(k, -1)
        assert jet.derivative(k) == pytest.approx((ahead.value - behind.value) / (2 * h), abs=1e-8)
        for m in range(3):
            slope = (ahead.derivative(m) - behind.derivative(m)) / (2 * h)
            assert jet.derivative(k, m) == pytest.approx(slope, abs=1e-8)


def test_what_is_zero_by_structure_costs_nothing():
    X, _, t = variables(np.ones(3), np.ones(3), 0.5)
    product = sin(2 * X) * t
    assert product.first[1] is product.second[1] is product.second[3] is None and product.derivative(1) == 0.0
    assert isinstance(np.ones(3) * X, Jet) and (3.0 - X).value.tolist() == [2.0, 2.0, 2.0]


# ---- as data ------------------------------------------------------------------------------------------------------


def test_a_field_is_few_functions_of_time(problem):
    """Values at any time, and both derivatives, to 1e-13 of the largest; ring and vortex have small ranks."""
    scene, solution, _, X = problem
    found = separate(lambda X, t: solution.displacement(scene, X, t), X, scene.period)
    forced = separate(lambda X, t: solution.body_force(scene, X, t), X, scene.period)
    assert found.rank <= 14 and forced.rank <= 16
    for table, fields in ((found, (solution.displacement, solution.velocity, solution.acceleration)),
                          (forced, (solution.body_force,))):
        for derivative, field in enumerate(fields):
            for part in TIMES:
                exact = field(scene, X, part * scene.period)
                size = max(np.abs(field(scene, X, one * scene.period)).max() for one in TIMES)
                np.testing.assert_allclose(table(part * scene.period, derivative), exact, rtol=0, atol=2e-13 * size)


@pytest.mark.parametrize(("field", "why"), [
    (lambda X, t: np.stack([X[:, 0] * np.exp(t)], axis=1), "not its period"),
    (lambda X, t: np.stack([X[:, 0] * np.sign(np.sin(2 * math.pi * t))], axis=1), "not its period"),
    (lambda X, t: np.stack([X[:, 0] / (t - 0.5)], axis=1), "not finite")], ids=["grows", "jumps", "has a pole"])
def test_what_does_not_come_back_is_refused(field, why):
    with np.errstate(divide="ignore"), pytest.raises(NotPeriodic, match=why):
        separate(field, np.random.default_rng(1).uniform(size=(40, 2)), 1.0)


def test_fast_waves_that_few_times_would_take_for_slow_ones_are_seen():
    """At the multiples of 1/16, .. 1/256 of a period sin(600 pi t) is as good as sin(88 pi t)."""
    X, t = np.random.default_rng(1).uniform(size=(40, 2)), 0.123
    found = separate(lambda X, t: X * (np.sin(2 * math.pi * t) + 0.01 * np.sin(600 * math.pi * t))[:, None], X, 1.0)
    np.testing.assert_allclose(found(t), X * (np.sin(2 * math.pi * t) + 0.01 * np.sin(600 * math.pi * t)), atol=1e-12)


def test_a_field_that_rests_is_one_function():
    found = separate(lambda X, t: X + 0.0 * t[:, None], np.random.default_rng(1).uniform(size=(40, 2)), 1.0)
    assert found.rank == 1 and found.harmonics == 1
