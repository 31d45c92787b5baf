"""The generalized vortex as printed, as functions of the material position X (P, 2) and the time t.

Every circle of a ring between the radii a = 0.75 and b = 1.25 turns as a whole: x = Q(alpha) X, alpha = g(t) h(R), with
g = A sin(w t), w = pi B, and h = 1 - 32 (R-1)^2 + 256 (R-1)^4. Both h and h' vanish at the rims, which therefore rest
and carry no traction. In the turned polar frame (e_r, e_theta at the present angle Theta + alpha)

    F = [[1, 0], [R alpha_R, 1]], J = 1, sigma_rr = 0, sigma_rt = mu R alpha_R, sigma_tt = mu (R alpha_R)^2

for the neo-Hookean material sigma = lambda ln J/J I + mu/J (F F^T - I): lambda drops out of the solution, but not out
of the errors. Source: Brannon, Kamojjala & Sadeghirad, Establishing credibility of particle methods through
verification testing, Particles 2011; Kamojjala, Brannon, Sadeghirad & Guilkey, Eng. Comput. 31 (2015) 199-213.
"""

from typing import NamedTuple

import numpy as np

from solvers.scene.scene import Scene


class Turn(NamedTuple):
    """alpha at some radii and its derivatives in time and radius, each (K,)."""

    angle: np.ndarray  # alpha
    rate: np.ndarray  # alpha_t, 1/s
    acceleration: np.ndarray  # alpha_tt, 1/s^2
    slope: np.ndarray  # alpha_R, 1/m
    curvature: np.ndarray  # alpha_RR, 1/m^2


def turn(scene: Scene, R: np.ndarray, t: float) -> Turn:
    """By how much the circles of radius R are turned, and how that changes."""
    s, w, A = R - 1, scene.angular_frequency, scene.amplitude
    h, slope, curvature = 1 - 32 * s**2 + 256 * s**4, -64 * s + 1024 * s**3, -64 + 3072 * s**2
    g, rate = A * np.sin(w * t), A * w * np.cos(w * t)
    return Turn(g * h, rate * h, -w * w * g * h, g * slope, g * curvature)


def _frame(scene: Scene, X: np.ndarray, t: float) -> tuple[np.ndarray, Turn, np.ndarray, np.ndarray]:
    """R and the turn there, each (P, 1); e_r and e_theta (P, 2) at the present angle."""
    R = np.linalg.norm(X, axis=1)[:, None]
    now, e = turn(scene, R, t), X / R
    e = np.cos(now.angle) * e + np.sin(now.angle) * _left(e)
    return R, now, e, _left(e)


def _left(vectors: np.ndarray) -> np.ndarray:
    """Vectors (P, 2) turned by 90 degrees to the left."""
    return np.stack([-vectors[:, 1], vectors[:, 0]], axis=1)


def displacement(scene: Scene, X: np.ndarray, t: float) -> np.ndarray:
    R, _, e, _ = _frame(scene, X, t)
    return R * e - X


def body_force(scene: Scene, X: np.ndarray, t: float) -> np.ndarray:
    """Per mass: rho b = rho a - div sigma, div sigma = -sigma_tt/R e_r + (sigma_rt' + 2 sigma_rt/R) e_theta; and with a
    second tone w^2 A/2 R h(R) sin(1.7 wt) along e_theta."""
    R, now, e, around = _frame(scene, X, t)
    w, per_mass = scene.angular_frequency, 0.5 * scene.modulus / (1 + scene.poisson_ratio) / scene.density
    along = -R * now.rate**2 + per_mass * R * now.slope**2
    across = R * now.acceleration - per_mass * (3 * now.slope + R * now.curvature)
    if scene.body_force == "two-tone":
        across = across + 0.5 * w * R * turn(scene, R, 0.0).rate * np.sin(1.7 * w * t)  # whose rate is A w h at first
    return along * e + across * around
