"""The generalized vortex, as functions of the material position X and the time t.

Every circle of a ring between the radii a = 0.75 and b = 1.25 turns as a whole: x = Q(alpha) X, alpha = g(t) h(R), with
g = A sin(w t), w = pi B, and h = 1 - 32 (R-1)^2 + 256 (R-1)^4. Both h and h' vanish at the rims, which therefore rest
and carry no traction. In the turned polar frame (e_r, e_theta at the present angle Theta + alpha)

    F = [[1, 0], [R alpha_R, 1]], J = 1, sigma_rr = 0, sigma_rt = mu R alpha_R, sigma_tt = mu (R alpha_R)^2

for the neo-Hookean material sigma = lambda ln J/J I + mu/J (F F^T - I): lambda drops out of the solution, but not out
of the errors. Source: Brannon, Kamojjala & Sadeghirad, Establishing credibility of particle methods through
verification testing, Particles 2011; Kamojjala, Brannon, Sadeghirad & Guilkey, Eng. Comput. 31 (2015) 199-213.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from solvers.problems.planar.budget.moment import Moment
from solvers.scene.scene import Scene

INNER, OUTER = 0.75, 1.25
MIDDLE = 0.5 * (INNER + OUTER)
BEND, RISE = -32.0, 256.0  # of h, in (R-1)^2 and (R-1)^4: so that h = h' = 0 at both rims
SECOND_SIZE = 0.5  # of the force's second tone, in w^2 A R h
SECOND_FREQUENCY = 1.7  # of the second tone, over that of the first


class Turn(NamedTuple):
    """alpha at some radii and its derivatives in time and radius, each (K,)."""

    angle: np.ndarray  # alpha
    rate: np.ndarray  # alpha_t, 1/s
    acceleration: np.ndarray  # alpha_tt, 1/s^2
    slope: np.ndarray  # alpha_R, 1/m
    curvature: np.ndarray  # alpha_RR, 1/m^2


def lame(scene: Any) -> tuple[float, float]:
    """lambda and mu in Pa, from E and nu (plane strain) of a ``VortexScene``, whose file imports this one."""
    mu = 0.5 * scene.modulus / (1 + scene.poisson_ratio)
    return 2 * mu * scene.poisson_ratio / (1 - 2 * scene.poisson_ratio), mu


def shape(R: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """h, h' and h'' at the radii R."""
    s = R - MIDDLE
    square = s * s
    return (1 + (BEND + RISE * square) * square, (2 * BEND + 4 * RISE * square) * s, 2 * BEND + 12 * RISE * square)


def time_factors(scene: Scene, t: Any) -> tuple[Any, Any, Any]:
    """g, g' and g'' at the time t: with h(R) the angle, its rate and its acceleration."""
    w, A = scene.angular_frequency, scene.amplitude
    return A * np.sin(w * t), A * w * np.cos(w * t), -A * w * w * np.sin(w * t)


def turn(scene: Scene, R: np.ndarray, t: Any) -> Turn:
    """By how much the circles of radius R are turned, and how that changes."""
    (h, slope, curvature), (g, rate, acceleration) = shape(R), time_factors(scene, t)
    return Turn(g * h, rate * h, acceleration * h, g * slope, g * curvature)


def _polar(X: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Radii (P,) and directions e_R (P, 2) of material positions."""
    R = np.linalg.norm(X, axis=1)
    return R, X / R[:, None]


def right(vectors: np.ndarray) -> np.ndarray:
    """Vectors (..., 2) turned by 90 degrees to the right."""
    return np.stack([vectors[..., 1], -vectors[..., 0]], axis=-1)


def combined(e: np.ndarray, along: np.ndarray, across: np.ndarray) -> np.ndarray:
    """along e + across e_theta (P, 2), e the directions (P, 2) and e_theta those turned by 90 degrees to the left."""
    return along[:, None] * e - across[:, None] * right(e)


def _turned(e: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """Vectors (P, 2) turned by the angles (P,)."""
    return combined(e, np.cos(angle), np.sin(angle))


def position(scene: Scene, X: np.ndarray, t: float) -> np.ndarray:
    """x (P, 2) in metres at the material positions X (P, 2)."""
    return _turned(X, turn(scene, np.linalg.norm(X, axis=1), t).angle)


def displacement(scene: Scene, X: np.ndarray, t: float) -> np.ndarray:
    """u = x - X (P, 2) in metres; where the angle is small, without the cancellation of that difference."""
    angle = turn(scene, np.linalg.norm(X, axis=1), t).angle
    return -2 * (np.sin(0.5 * angle) ** 2)[:, None] * X + np.sin(angle)[:, None] * -right(X)


def velocity(scene: Scene, X: np.ndarray, t: float) -> np.ndarray:
    """v = x_t = R alpha_t e_theta (P, 2) in m/s."""
    R, e = _polar(X)
    now = turn(scene, R, t)
    return combined(_turned(e, now.angle), np.zeros_like(R), R * now.rate)


def acceleration(scene: Scene, X: np.ndarray, t: float) -> np.ndarray:
    """a = x_tt = -R alpha_t^2 e_r + R alpha_tt e_theta (P, 2) in m/s^2: not zero at the start."""
    R, e = _polar(X)
    now = turn(scene, R, t)
    return combined(_turned(e, now.angle), -R * now.rate**2, R * now.acceleration)


def deformation_gradient(scene: Scene, X: np.ndarray, t: float) -> np.ndarray:
    """F = Q (I + R alpha_R e_Theta e_R^T) (P, 2, 2)."""
    R, E = _polar(X)
    now = turn(scene, R, t)
    e = _turned(E, now.angle)
    image = e - (R * now.slope)[:, None] * right(e)  # F e_R
    return image[:, :, None] * E[:, None, :] + right(e)[:, :, None] * right(E)[:, None, :]


def polar_stress(scene: Scene, R: np.ndarray, t: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Cauchy stress rr, rt, tt in the turned polar frame at the radii R, in pascals."""
    mu, shear = lame(scene)[1], R * turn(scene, R, t).slope
    return np.zeros_like(R), mu * shear, mu * shear**2


def stress(scene: Scene, X: np.ndarray, t: float) -> np.ndarray:
    """Cauchy stress sigma_xx, sigma_xy, sigma_yy (P, 3) in pascals."""
    R, E = _polar(X)
    _, shear, hoop = polar_stress(scene, R, t)
    c, s = _turned(E, turn(scene, R, t).angle).T
    return np.stack([hoop * s * s - 2 * shear * c * s, shear * (c * c - s * s) - hoop * c * s,
                     hoop * c * c + 2 * shear * c * s], axis=1)


def polar_force(scene: Scene, R: np.ndarray, t: Any) -> tuple[np.ndarray, np.ndarray]:
    """Body force per mass along e_r and e_theta at the present angle, in m/s^2, at the radii R.

    rho b = rho a - div sigma, and in the turned frame div sigma = -sigma_tt/R e_r + (sigma_rt' + 2 sigma_rt/R) e_theta.
    """
    now, per_mass = turn(scene, R, t), lame(scene)[1] / scene.density
    return (-R * now.rate**2 + per_mass * R * now.slope**2,
            R * now.acceleration - per_mass * (3 * now.slope + R * now.curvature))


def field(scene: Scene, quantity: str, R: np.ndarray, t: float) -> np.ndarray:
    """At the radii R, of a quantity by its key (``samples.QUANTITIES``), u for x: along e_Theta of the particle at rest
    for x, along e_theta of where it is for v and a, and sigma_rt; as a method has it after the time t: its acceleration
    is the one that its last step used, which began a step before."""
    if quantity == "sigma":
        return polar_stress(scene, R, t)[1]
    now = turn(scene, R, max(0.0, t - scene.time_step) if quantity == "a" else t)
    return R * {"x": np.sin(now.angle), "v": now.rate, "a": now.acceleration}[quantity]


def body_force(scene: Scene, X: np.ndarray, t: float) -> np.ndarray:
    """Body force per mass (P, 2), in m/s^2, on the material points X that makes x = Q X the solution."""
    R, E = _polar(X)
    return combined(_turned(E, turn(scene, R, t).angle), *polar_force(scene, R, t))


def circle_force(scene: Scene, R: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Body force per mass (T, K) at the radii R and the times t (T, 1), in m/s^2: along e_R of the particle at rest,
    and as imaginary part along e_Theta."""
    if scene.body_force == "none":
        return np.zeros(np.broadcast_shapes(R.shape, t.shape), complex)
    along, around = polar_force(scene, R, t)
    if scene.body_force == "two-tone":
        w = scene.angular_frequency
        around = around + SECOND_SIZE * w * w * scene.amplitude * R * shape(R)[0] * np.sin(SECOND_FREQUENCY * w * t)
    return np.exp(1j * turn(scene, R, t).angle) * (along + 1j * around)


def force_at_rest(scene: Scene, R: np.ndarray, t: float) -> np.ndarray:
    """The same (K, 2) at one time, as vectors."""
    force = circle_force(scene, R, np.array([[t]]))[0]
    return np.stack([force.real, force.imag], axis=1)


def on_axis(R: np.ndarray) -> np.ndarray:
    """Points (K, 2) of the radii R on the x axis, where e_R and e_Theta are the axes."""
    return np.stack([R, np.zeros_like(R)], axis=1)


def moment(scene: Scene, X: np.ndarray, t: float) -> Moment:
    """The exact solution at the material positions X (P, 2).

    F depends on time through g alone, F = Q(g h) (I + R g h' e_Theta e_R^T); with J a left turn by 90 degrees and
    B = R h' J Q e_R e_R^T = R h' Q e_Theta e_R^T: F_g = h J F + B and F_gg = -h^2 F + 2 h J B.
    """
    R = np.linalg.norm(X, axis=1)
    (h, slope, _), (_, speed, change) = shape(R), time_factors(scene, t)
    angle, e = turn(scene, R, t).angle, X / R[:, None]
    around = combined(e, -np.sin(angle), np.cos(angle))  # Q e_Theta
    F, h = deformation_gradient(scene, X, t), h[:, None, None]
    B = (R * slope)[:, None, None] * around[:, :, None] * e[:, None, :]
    first, second = h * _left(F) + B, -h * h * F + 2 * h * _left(B)
    return Moment(displacement(scene, X, t), velocity(scene, X, t), acceleration(scene, X, t),
                  body_force(scene, X, t), F, speed * first, speed**2 * second + change * first)


def _left(tensors: np.ndarray) -> np.ndarray:
    """J times tensors (P, 2, 2)."""
    return np.stack([-tensors[:, 1], tensors[:, 0]], axis=1)
