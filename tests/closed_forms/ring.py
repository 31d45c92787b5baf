"""The ring's manufactured solution, as functions of the material position X and the time t.

u = T(t) w(R) e_R with T = A sin(wt), w = c pi, between the radii a = 0.4 and b = 0.6. The cubic w has w(b) = 1 and
w'(a) = w'(b) = 0, so that with nu = 0 both free surfaces carry no traction. F is diagonal in polar directions,
F_r = 1 + T w', F_theta = 1 + T w/R, and P = mu (F - 1/F) in each, mu = E/2 (neo-Hookean with lambda = 0).
"""

from typing import Any

import numpy as np

from solvers.problems.planar.budget.moment import Moment
from solvers.scene.scene import Scene

INNER, OUTER = 0.4, 0.6
SECOND_SIZE = 0.5  # of the force's second tone, in w^2 A
SECOND_FREQUENCY = 1.7  # of the second tone, over that of the first
_SCALE = OUTER * (OUTER - 3 * INNER)
C1, C2, C3 = -6 * INNER / _SCALE, 3 * (INNER + OUTER) / (OUTER * _SCALE), -2 / (OUTER * _SCALE)


def shape(R: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """w, w' and w'' at the radii R."""
    return ((C3 * R + C2) * R + C1) * R, (3 * C3 * R + 2 * C2) * R + C1, 6 * C3 * R + 2 * C2


def time_factors(scene: Scene, t: Any) -> tuple[Any, Any, Any]:
    """T, T' and T'' at the time t: with w(R) the radial displacement, velocity and acceleration."""
    A, w = scene.amplitude, scene.angular_frequency
    T = A * np.sin(w * t)
    return T, A * w * np.cos(w * t), -w * w * T


def _radially(X: np.ndarray, factor: float) -> np.ndarray:
    """Vectors (P, 2) of the size ``factor`` w(R) along e_R."""
    R = np.linalg.norm(X, axis=1)
    return X * (factor * shape(R)[0] / R)[:, None]


def displacement(scene: Scene, X: np.ndarray, t: float) -> np.ndarray:
    """u (P, 2) in metres at the material positions X (P, 2)."""
    return _radially(X, time_factors(scene, t)[0])


def velocity(scene: Scene, X: np.ndarray, t: float) -> np.ndarray:
    """v = u_t (P, 2) in m/s."""
    return _radially(X, time_factors(scene, t)[1])


def acceleration(scene: Scene, X: np.ndarray, t: float) -> np.ndarray:
    """a = u_tt = -w^2 u (P, 2) in m/s^2."""
    return -scene.angular_frequency**2 * displacement(scene, X, t)


def stretches(scene: Scene, R: np.ndarray, t: Any) -> tuple[np.ndarray, np.ndarray]:
    """F_r and F_theta at the radii R."""
    (w, slope, _), T = shape(R), time_factors(scene, t)[0]
    return 1 + T * slope, 1 + T * w / R


def deformation_gradient(scene: Scene, X: np.ndarray, t: float) -> np.ndarray:
    """F (P, 2, 2) at the material positions X (P, 2)."""
    R = np.linalg.norm(X, axis=1)
    radial, hoop = stretches(scene, R, t)
    outward = np.einsum("pi,pj->pij", X, X) / (R * R)[:, None, None]
    return hoop[:, None, None] * np.eye(2) + (radial - hoop)[:, None, None] * outward


def principal_stresses(scene: Scene, R: np.ndarray, t: float) -> tuple[np.ndarray, np.ndarray]:
    """Cauchy stress along and across e_R at the radii R, in pascals: mu/J (F F^T - I), the paper's eq 37 corrected."""
    radial, hoop = stretches(scene, R, t)
    scale = 0.5 * scene.modulus / (radial * hoop)
    return scale * (radial**2 - 1), scale * (hoop**2 - 1)


def stress(scene: Scene, X: np.ndarray, t: float) -> np.ndarray:
    """Cauchy stress sigma_xx, sigma_xy, sigma_yy (P, 3) in pascals."""
    R = np.linalg.norm(X, axis=1)
    along, across = principal_stresses(scene, R, t)
    c, s = X[:, 0] / R, X[:, 1] / R
    return np.stack([along * c * c + across * s * s, (along - across) * c * s, along * s * s + across * c * c], axis=1)


def field(scene: Scene, quantity: str, R: np.ndarray, t: float) -> np.ndarray:
    """The radial component at the radii R of a quantity by its key (``samples.QUANTITIES``), u for x, as a method has
    it after the time t: its acceleration is the one that its last step used, which began a step before."""
    if quantity == "sigma":
        return principal_stresses(scene, R, t)[0]
    factors = time_factors(scene, max(0.0, t - scene.time_step) if quantity == "a" else t)
    return shape(R)[0] * factors["xva".index(quantity)]


def body_force(scene: Scene, R: np.ndarray, t: Any) -> np.ndarray:
    """Radial body force per mass, in m/s^2, that makes u the solution: rho b = rho u_tt - P_r' - (P_r - P_theta)/R.
    With two tones w^2 A/2 cos(pi (R - a)/(b - a)) sin(1.7 wt) beside it; zero for the free ring."""
    if scene.body_force == "none":
        return np.zeros(np.broadcast_shapes(R.shape, np.shape(t)))
    w, _, curvature = shape(R)
    T, mu, frequency = time_factors(scene, t)[0], 0.5 * scene.modulus, scene.angular_frequency
    radial, hoop = stretches(scene, R, t)
    difference = mu * (radial - 1 / radial - hoop + 1 / hoop)
    force = -frequency**2 * T * w - (mu * (1 + 1 / radial**2) * T * curvature + difference / R) / scene.density
    if scene.body_force == "two-tone":
        across = np.cos(np.pi * (R - INNER) / (OUTER - INNER))
        force += SECOND_SIZE * frequency**2 * scene.amplitude * across * np.sin(SECOND_FREQUENCY * frequency * t)
    return force


def moment(scene: Scene, X: np.ndarray, t: float) -> Moment:
    """The exact solution at the material positions X (P, 2): separable, F - I is T(t) times a field."""
    R = np.linalg.norm(X, axis=1)
    e = X / R[:, None]
    (w, slope, _), (size, speed, change) = shape(R), time_factors(scene, t)
    outward = e[:, :, None] * e[:, None, :]
    gradient = (w / R)[:, None, None] * (np.eye(2) - outward) + slope[:, None, None] * outward
    radial = w[:, None] * e
    force = body_force(scene, R, t)[:, None] * e
    return Moment(size * radial, speed * radial, change * radial, force, np.eye(2) + size * gradient, speed * gradient,
                  change * gradient)
