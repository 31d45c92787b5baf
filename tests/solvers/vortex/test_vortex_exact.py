"""The vortex's exact solution: checked against the equations it must satisfy, by differences and by hand."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from solvers.problems.vortex import exact

#: Not the usual numbers: a rotation beyond 45 degrees, another material, another period.
SCENE = SimpleNamespace(amplitude=1.2, angular_frequency=0.7 * np.pi, modulus=1700.0, poisson_ratio=0.4, density=900.0)
TIME = 0.55  # g = 1.12 rad: 64 degrees at the middle of the ring
RADII = np.array([0.76, 0.87, 1.0, 1.08, 1.23])
ANGLES = np.array([0.3, 1.9, 3.3, 4.4, 6.0])
POINTS = np.stack([RADII * np.cos(ANGLES), RADII * np.sin(ANGLES)], axis=1)
STEP = 1e-4
#: Central differences of fourth order: truncation is d^4/30 of the fifth derivative, about 1e6 where the
#: solution varies within 0.06 m, so 3e-12; rounding is 1e-16/d for one difference and 1e-16/d^2 for one of another.
ONE, TWO = 1e-10, 1e-6  # relative, of one difference and of two, one of the other


def difference(function, d: float) -> np.ndarray:
    """f'(0), (8 (f(d) - f(-d)) - (f(2d) - f(-2d)))/12 d."""
    return (8 * (function(d) - function(-d)) - (function(2 * d) - function(-2 * d))) / (12 * d)


def gradient(function, X: np.ndarray) -> np.ndarray:
    """d f_i/d X_j by differences, (P, ..., 2)."""
    return np.stack([difference(lambda s, e=e: function(X + s * e), STEP) for e in np.eye(2)], axis=-1)


def first_piola(X: np.ndarray, t: float = TIME) -> np.ndarray:
    """P = mu (F - F^-T) + lambda ln J F^-T, of F by differences of the positions."""
    F = gradient(lambda Y: exact.position(SCENE, Y, t), X)
    lam, mu = exact.lame(SCENE)
    inverse = np.linalg.inv(F).transpose(0, 2, 1)
    return mu * (F - inverse) + lam * np.log(np.linalg.det(F))[:, None, None] * inverse


def same(ours: np.ndarray, theirs: np.ndarray, tolerance: float) -> None:
    """To ``tolerance`` of the largest."""
    assert np.abs(ours - theirs).max() < tolerance * np.abs(theirs).max()


def test_it_is_far_from_small():
    assert np.abs(exact.turn(SCENE, RADII, TIME).angle).max() > np.pi / 4
    assert np.abs(RADII * exact.turn(SCENE, RADII, TIME).slope).max() > 1


def test_displacement_is_the_change_of_position():
    same(exact.displacement(SCENE, POINTS, TIME), exact.position(SCENE, POINTS, TIME) - POINTS, 1e-14)
    assert np.all(exact.displacement(SCENE, POINTS, 0.0) == 0)


def test_velocity_and_acceleration_are_time_derivatives():
    for of, derivative in ((exact.position, exact.velocity), (exact.velocity, exact.acceleration)):
        same(difference(lambda s, of=of: of(SCENE, POINTS, TIME + s), STEP), derivative(SCENE, POINTS, TIME), ONE)
    assert np.abs(exact.acceleration(SCENE, POINTS, 0.0)).max() > 1  # the circles turn at once


def test_deformation_gradient():
    """Against differences of the positions; and J = 1."""
    F = exact.deformation_gradient(SCENE, POINTS, TIME)
    same(gradient(lambda X: exact.position(SCENE, X, TIME), POINTS), F, ONE)
    np.testing.assert_allclose(np.linalg.det(F), 1, rtol=0, atol=1e-13)


def test_stress_follows_from_the_deformation():
    """sigma = P F^T/J with lambda, which must drop out."""
    F = exact.deformation_gradient(SCENE, POINTS, TIME)
    sigma = np.einsum("pij,pkj->pik", first_piola(POINTS), F)
    same(sigma.reshape(-1, 4)[:, [0, 1, 3]], exact.stress(SCENE, POINTS, TIME), ONE * 10)


@pytest.mark.parametrize("t", [0.0, TIME, 1.3])
def test_momentum_balance_in_cartesian_components(t):
    """rho x_tt = Div P + rho b, everything but b by differences of the positions alone."""
    P_X = gradient(lambda X: first_piola(X, t), POINTS)
    divergence = P_X[:, :, 0, 0] + P_X[:, :, 1, 1]
    inertia = difference(lambda s: difference(lambda r: exact.position(SCENE, POINTS, t + s + r), 1e-3), 1e-3)
    same(inertia - divergence / SCENE.density, exact.body_force(SCENE, POINTS, t), TWO)


def test_lambda_drops_out_of_the_force():
    """With another Poisson's ratio and the same mu the same force."""
    _, mu = exact.lame(SCENE)
    other = SimpleNamespace(**{**vars(SCENE), "poisson_ratio": 0.1, "modulus": 2 * 1.1 * mu})
    assert exact.lame(other)[0] != pytest.approx(exact.lame(SCENE)[0])
    np.testing.assert_allclose(exact.body_force(other, POINTS, TIME), exact.body_force(SCENE, POINTS, TIME), rtol=1e-12)


@pytest.mark.parametrize("radius", [exact.INNER, exact.OUTER])
def test_rims_rest_and_carry_no_traction(radius):
    """sigma e_r = 0, u = 0 and v = 0 there, to rounding; between them they do not."""
    rim = radius * np.stack([np.cos(ANGLES), np.sin(ANGLES)], axis=1)
    xx, xy, yy = exact.stress(SCENE, rim, TIME).T
    n = rim / radius
    traction = np.stack([xx * n[:, 0] + xy * n[:, 1], xy * n[:, 0] + yy * n[:, 1]])
    assert np.abs(traction).max() < 1e-12 * SCENE.modulus
    assert np.abs(exact.displacement(SCENE, rim, TIME)).max() < 1e-14
    assert np.abs(exact.velocity(SCENE, rim, TIME)).max() < 1e-14


def test_usual_numbers():
    """What one finds by hand for A = B = 1, E = 1000, nu = 0.3, rho = 1000 at t = 1/2, when g = 1 and g' = 0.

    At R = 1: h = 1, h' = 0, h'' = -64, so alpha_tt = -pi^2 and b_t = -pi^2 + 64 mu/rho, b_r = 0. At R = 0.875:
    h = 1 - 1/2 + 1/16 = 9/16, h' = 64/8 - 1024/512 = 6, sigma_tt = mu (0.875 * 6)^2. mu = 5000/13, lambda = 7500/13.
    """
    scene = SimpleNamespace(amplitude=1.0, angular_frequency=np.pi, modulus=1000.0, poisson_ratio=0.3, density=1000.0)
    lam, mu = exact.lame(scene)
    assert (lam, mu) == (pytest.approx(7500 / 13), pytest.approx(5000 / 13))
    R = np.array([1.0, 0.875])
    along, across = exact.polar_force(scene, R, 0.5)
    assert across[0] == pytest.approx(-np.pi**2 + 64 * mu / 1000) and along[0] == pytest.approx(0, abs=1e-12)
    assert exact.turn(scene, R, 0.5).angle[1] == pytest.approx(9 / 16)
    assert exact.polar_stress(scene, R, 0.5)[2][1] == pytest.approx(mu * 5.25**2)
    assert exact.shape(R)[0][0] == 1 and exact.shape(R)[1][1] == pytest.approx(6)
