"""The expanding ring as printed, as functions of the material position X (P, 2) and the time t.

u = T w(R) e_R with T = A sin(wt), w = c pi, between the radii a = 0.4 and b = 0.6. The cubic w has w(b) = 1 and
w'(a) = w'(b) = 0, so that with nu = 0 both free surfaces carry no traction. F is diagonal in polar directions,
F_r = 1 + T w', F_theta = 1 + T w/R, and P = mu (F - 1/F) in each, mu = E/2 (neo-Hookean with lambda = 0).
"""

import numpy as np

from solvers.scene.scene import Scene

INNER, OUTER = 0.4, 0.6
_SCALE = OUTER * (OUTER - 3 * INNER)
C1, C2, C3 = -6 * INNER / _SCALE, 3 * (INNER + OUTER) / (OUTER * _SCALE), -2 / (OUTER * _SCALE)


def shape(R: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """w, w' and w'' at the radii R."""
    return ((C3 * R + C2) * R + C1) * R, (3 * C3 * R + 2 * C2) * R + C1, 6 * C3 * R + 2 * C2


def displacement(scene: Scene, X: np.ndarray, t: float) -> np.ndarray:
    R = np.linalg.norm(X, axis=1)
    return X * (scene.amplitude * np.sin(scene.angular_frequency * t) * shape(R)[0] / R)[:, None]


def _stretches(scene: Scene, R: np.ndarray, t: float) -> tuple[np.ndarray, np.ndarray]:
    (w, slope, _), T = shape(R), scene.amplitude * np.sin(scene.angular_frequency * t)
    return 1 + T * slope, 1 + T * w / R


def body_force(scene: Scene, X: np.ndarray, t: float) -> np.ndarray:
    """Per mass: rho b = rho u_tt - P_r' - (P_r - P_theta)/R, and with a second tone w^2 A/2 cos(pi (R - a)/(b - a))
    sin(1.7 wt) along e_R."""
    R = np.linalg.norm(X, axis=1)
    (w, _, curvature), (radial, hoop) = shape(R), _stretches(scene, R, t)
    A, mu, frequency = scene.amplitude, 0.5 * scene.modulus, scene.angular_frequency
    T, difference = A * np.sin(frequency * t), mu * (radial - 1 / radial - hoop + 1 / hoop)
    force = -frequency**2 * T * w - (mu * (1 + 1 / radial**2) * T * curvature + difference / R) / scene.density
    if scene.body_force == "two-tone":
        across = np.cos(np.pi * (R - INNER) / (OUTER - INNER))
        force += 0.5 * frequency**2 * A * across * np.sin(1.7 * frequency * t)
    return X * (force / R)[:, None]
