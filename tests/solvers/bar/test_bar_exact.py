"""The exact bar (eqs 29-34): the reference that every error is measured against must itself be right.

Derivatives by central differences of step 1e-4: truncation (2 pi d)^2/6 of the value, rounding eps/d^2 of it
in second derivatives; both are below 1e-6 of the largest value.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from solvers.problems.bar import exact
from solvers.problems.bar.scene import BarScene
from solvers.problems.bar.solver import BarSolver

SCENE = BarScene(amplitude=0.05, modulus=7.0, density=1.3)
X = np.linspace(0, 1, 37)
TIMES = [0.0, 0.1, 0.37, 1.9]
D = 1e-4
RELATIVE = 1e-6


def close(one: np.ndarray, other: np.ndarray, size: float) -> bool:
    return np.abs(one - other).max() <= RELATIVE * size


@pytest.mark.parametrize("t", TIMES)
def test_momentum_balance(t):
    """rho u_tt = P_X + rho b: the corrected body force 3 w^2 u, not the printed one with another A."""
    u = [exact.displacement(SCENE, X, t + k * D) for k in (-1, 0, 1)]
    acceleration = (u[0] - 2 * u[1] + u[2]) / D**2
    divergence = (exact.stress(SCENE, X + D, t) - exact.stress(SCENE, X - D, t)) / (2 * D)
    size = 4 * SCENE.angular_frequency**2 * SCENE.amplitude
    force = divergence + SCENE.density * exact.body_force(SCENE, X, t)
    assert close(SCENE.density * acceleration, force, 3 * size)
    assert close(acceleration, exact.acceleration(SCENE, X, t), size)


@pytest.mark.parametrize("t", TIMES)
def test_kinematics_and_stress(t):
    """v = u_t, F = 1 + u_X, P = E(F - 1)."""
    u_t = (exact.displacement(SCENE, X, t + D) - exact.displacement(SCENE, X, t - D)) / (2 * D)
    u_X = (exact.displacement(SCENE, X + D, t) - exact.displacement(SCENE, X - D, t)) / (2 * D)
    F = exact.deformation_gradient(SCENE, X, t)
    assert close(u_t, exact.velocity(SCENE, X, t), SCENE.amplitude * SCENE.angular_frequency)
    assert close(1 + u_X, F, 1.0)
    np.testing.assert_array_equal(exact.stress(SCENE, X, t), SCENE.modulus * (F - 1))


def test_period_and_frequency():
    """w = pi sqrt(E/rho) for unit length, and everything repeats after 2 pi/w."""
    assert SCENE.angular_frequency == pytest.approx(math.pi * math.sqrt(7 / 1.3), rel=1e-15)
    for what in (exact.displacement, exact.velocity, exact.deformation_gradient, exact.body_force):
        now, later = what(SCENE, X, 0.3), what(SCENE, X, 0.3 + SCENE.period)
        assert np.abs(now - later).max() <= 1e-13 * max(1, np.abs(now).max())


def test_bar_inverts_exactly_at_the_amplitude_limit():
    """F = 1 + 2 pi A cos sin: its minimum over X and t is 1 - 2 pi A."""
    F = exact.deformation_gradient(SCENE, np.array([0.5]), SCENE.period / 4)
    assert F[0] == pytest.approx(1 - 2 * math.pi * 0.05, abs=1e-15)


@pytest.mark.parametrize("ppc", [1, 4, 5])
def test_initial_state_is_the_exact_one(ppc):
    """X_p = (p + 1/2) h/ppc fills the bar; u = 0, F = 1, v = A w sin 2 pi X at t = 0, without error."""
    scene = BarScene(cells=12, ppc=ppc)
    snapshot = BarSolver(scene).snapshot()
    X = snapshot.material_position
    np.testing.assert_allclose(X, (np.arange(12 * ppc) + 0.5) / (12 * ppc), rtol=0, atol=1e-15)
    np.testing.assert_array_equal(snapshot.position, X)
    np.testing.assert_array_equal(snapshot.deformation_gradient, 1)
    np.testing.assert_array_equal(snapshot.velocity, exact.velocity(scene, X, 0.0))
    np.testing.assert_array_equal(snapshot.error, 0)
