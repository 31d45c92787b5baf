"""What follows from a displacement: the printed forces of ring and vortex. That all problems obey their equations is in
tests/solvers/scene/test_exact_solutions.py."""

import math
from dataclasses import replace

import numpy as np
import pytest

from solvers.motion.jets import Jet, cos, exp, log, sin, sqrt, variables
from solvers.motion.laws.elastic_material import LAWS, ElasticMaterial
from solvers.motion.laws.material_law import determinant, stress_increment, volume_growth
from solvers.motion.separable_field import NotPeriodicError, separate
from solvers.problems.planar.body_force import body_force_at
from solvers.problems.planar.particle_layout import particle_layout
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


@pytest.mark.parametrize("law", LAWS)
def test_a_law_is_the_slope_of_its_energy(law):
    """P = dW/dF, sigma = P F^T/J, and dP F^T = rate(dF F^-1)."""
    chance, material, h = np.random.default_rng(4), ElasticMaterial(LAWS[law], 3.0, 2.0), 1e-6
    F = np.eye(2).ravel()[:, None] + 0.3 * chance.uniform(-1, 1, (4, 50))
    J, P, tensor = determinant(F), material.first_piola_stress(F), F.T.reshape(-1, 2, 2)
    b = tensor @ tensor.swapaxes(1, 2)
    for k in range(4):
        near = [F + sign * h * np.eye(4)[k][:, None] for sign in (1, -1)]
        W = [material.law.energy(one, volume_growth(one), np.log(determinant(one)), 3.0, 2.0) for one in near]
        np.testing.assert_allclose(P[k], (W[0] - W[1]) / (2 * h), rtol=0, atol=1e-8)
        dP = (np.subtract(*map(material.first_piola_stress, near)) / (2 * h)).T.reshape(-1, 2, 2)
        L = (np.eye(4)[k].reshape(2, 2) @ np.linalg.inv(tensor)).reshape(-1, 4).T
        found = stress_increment(L, (b[:, 0, 0], b[:, 0, 1], b[:, 1, 1]), *material.coefficients(F, J))
        np.testing.assert_allclose(np.stack(found, axis=1).reshape(-1, 2, 2), dP @ tensor.swapaxes(1, 2), rtol=0,
                                   atol=1e-7)
    xx, xy, yy = material.cauchy_stress(F)
    sigma = np.stack(P).T.reshape(-1, 2, 2) @ tensor.transpose(0, 2, 1) / J[:, None, None]
    np.testing.assert_allclose(np.stack([xx, xy, xy, yy], axis=1).reshape(-1, 2, 2), sigma, rtol=0, atol=1e-13)


def test_where_a_law_is_no_longer_elliptic():
    """Pressed to s along both axes waves of shear have lambda (s^2 - 1) + mu (2 s^2 - 1); the other law keeps mu."""
    F, (lam, mu) = np.array([[0.8], [0.0], [0.0], [0.8]]), (3.0, 2.0)
    least = {law: ElasticMaterial(LAWS[law], lam, mu).least_wave_stiffness(F) for law in LAWS}
    assert least == pytest.approx({"neo-hookean": 1, "st-venant-kirchhoff": lam * (0.64 - 1) / mu + 2 * 0.64 - 1})


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
    with np.errstate(divide="ignore"), pytest.raises(NotPeriodicError, match=why):
        separate(field, np.random.default_rng(1).uniform(size=(40, 2)), 1.0)


def test_fast_waves_that_few_times_would_take_for_slow_ones_are_seen():
    """At the multiples of 1/16, .. 1/256 of a period sin(600 pi t) is as good as sin(88 pi t)."""
    X, t = np.random.default_rng(1).uniform(size=(40, 2)), 0.123
    found = separate(lambda X, t: X * (np.sin(2 * math.pi * t) + 0.01 * np.sin(600 * math.pi * t))[:, None], X, 1.0)
    np.testing.assert_allclose(found(t), X * (np.sin(2 * math.pi * t) + 0.01 * np.sin(600 * math.pi * t)), atol=1e-12)


def test_a_field_that_rests_is_one_function():
    found = separate(lambda X, t: X + 0.0 * t[:, None], np.random.default_rng(1).uniform(size=(40, 2)), 1.0)
    assert found.rank == 1 and found.harmonics == 1
