"""The vortex's true errors at every particle, for snapshots: computed minus exact, in numpy.

What is known of a particle's circle is looked up, for the page asks for them with every frame.
"""

import numpy as np

from solvers.problems.planar.errors import Fields
from solvers.problems.vortex import exact
from solvers.problems.vortex.scene import VortexScene
from solvers.problems.vortex.state import WatchedVortex


def true_fields(scene: VortexScene, a: WatchedVortex, step: int, with_acceleration: bool) -> Fields:
    """The true errors of x, v, sigma and a after ``step`` steps, in components."""
    time, R = step * scene.time_step, a.radii[:, 0]
    turn = exact.turn(scene, R, time)
    x, y = _turned(a, turn.angle)
    rate = turn.rate[a.radius]
    with np.errstate(all="ignore"):  # a run gone bad holds anything
        position = a.motion[:, 0] - x, a.motion[:, 1] - y
        velocity = a.motion[:, 2] + rate * y, a.motion[:, 3] - rate * x
        stress = _stress_error(scene, a, time)
        acceleration = None
        if with_acceleration and step:  # the one that the last step used
            turn = exact.turn(scene, R, time - scene.time_step)
            x, y = _turned(a, turn.angle)
            square, gain = (turn.rate**2)[a.radius], turn.acceleration[a.radius]
            acceleration = a.acceleration[:, 0] + square * x + gain * y, a.acceleration[:, 1] + square * y - gain * x
    return [position, velocity, stress, acceleration]


def _turned(a: WatchedVortex, angle: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The particles (P,) where they are when their circles (K,) have turned by ``angle``."""
    c, s = np.cos(angle)[a.radius], np.sin(angle)[a.radius]
    X, Y = np.ascontiguousarray(a.material_position.T)
    return c * X - s * Y, s * X + c * Y


def _stress_error(scene: VortexScene, a: WatchedVortex, time: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The error (xx, xy, yy) of the Cauchy stress."""
    R = a.radii[:, 0]
    xx, xy, yy = stress(a)
    x, y = _turned(a, exact.turn(scene, R, time).angle)
    c, s = x / R[a.radius], y / R[a.radius]
    _, shear, hoop = (part[a.radius] for part in exact.polar_stress(scene, R, time))
    return (xx - (hoop * s * s - 2 * shear * c * s), xy - (shear * (c * c - s * s) - hoop * c * s),
            yy - (hoop * c * c + 2 * shear * c * s))


def stress(a: WatchedVortex) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Cauchy's stress (xx, xy, yy) of the particles: lambda ln J/J I + mu/J (F F^T - I)."""
    F = np.ascontiguousarray(a.deformation_gradient.T)
    J = F[0] * F[3] - F[1] * F[2]
    mu, bulk = a.shear_modulus / J, a.lame_modulus * np.log(J) / J
    return (mu * (F[0] * F[0] + F[1] * F[1] - 1) + bulk, mu * (F[0] * F[2] + F[1] * F[3]),
            mu * (F[2] * F[2] + F[3] * F[3] - 1) + bulk)
