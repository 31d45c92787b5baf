"""What the vortex knows of itself, for snapshots (see ``solvers.problems.planar.solver``)."""

import numpy as np

from solvers.motion.neo_hookean import cauchy_stress
from solvers.problems.planar.parts import SnapshotMeasures
from solvers.problems.vortex import exact
from solvers.problems.vortex.method.body import VortexBody
from solvers.problems.vortex.scene import VortexScene

Vector = tuple[np.ndarray, np.ndarray]
Tensor = tuple[np.ndarray, np.ndarray, np.ndarray]


def vector_errors(scene: VortexScene, a: VortexBody, time: float) -> tuple[Vector, Vector]:
    turn, q = exact.turn(scene, a.radii[:, 0], time), a.position_velocity
    (x, y), rate = _turned(a, turn.angle), turn.rate[a.radius]
    return (q[:, 0] - x, q[:, 1] - y), (q[:, 2] + rate * y, q[:, 3] - rate * x)


def acceleration_error(scene: VortexScene, a: VortexBody, time: float) -> Vector:
    turn = exact.turn(scene, a.radii[:, 0], time)
    (x, y), square, gain = _turned(a, turn.angle), (turn.rate**2)[a.radius], turn.acceleration[a.radius]
    return a.acceleration[:, 0] + square * x + gain * y, a.acceleration[:, 1] + square * y - gain * x


def _turned(a: VortexBody, angle: np.ndarray) -> Vector:
    """The particles (P,) where they are when their circles (K,) have turned by ``angle``."""
    c, s = np.cos(angle)[a.radius], np.sin(angle)[a.radius]
    X, Y = np.ascontiguousarray(a.material_position.T)
    return c * X - s * Y, s * X + c * Y


def stress(a: VortexBody) -> Tensor:
    return cauchy_stress(np.ascontiguousarray(a.deformation_gradient.T), a.lame_modulus, a.shear_modulus)


def stress_error(scene: VortexScene, a: VortexBody, time: float) -> Tensor:
    R = a.radii[:, 0]
    xx, xy, yy = stress(a)
    x, y = _turned(a, exact.turn(scene, R, time).angle)
    c, s = x / R[a.radius], y / R[a.radius]
    _, shear, hoop = (part[a.radius] for part in exact.polar_stress(scene, R, time))
    return (xx - (hoop * s * s - 2 * shear * c * s), xy - (shear * (c * c - s * s) - hoop * c * s),
            yy - (hoop * c * c + 2 * shear * c * s))


def component(a: VortexBody, quantity: str) -> np.ndarray:
    """Around the centre: see ``exact.field``."""
    q = a.position_velocity
    c, s = q[:, :2].T / np.hypot(q[:, 0], q[:, 1])  # e_r where the particles are
    if quantity == "sigma":
        xx, xy, yy = stress(a)
        return (yy - xx) * c * s + xy * (c * c - s * s)
    if quantity == "x":
        e, X = a.direction, a.material_position
        return (q[:, 1] - X[:, 1]) * e[:, 0] - (q[:, 0] - X[:, 0]) * e[:, 1]
    vectors = q[:, 2:] if quantity == "v" else a.acceleration
    return vectors[:, 1] * c - vectors[:, 0] * s


def exact_component(scene: VortexScene, a: VortexBody, quantity: str, time: float) -> np.ndarray:
    return exact.field(scene, quantity, a.radii[:, 0], time)[a.radius]


def body_force(a: VortexBody, some: np.ndarray) -> np.ndarray:
    f, e = a.polar_force[a.radius[some]], a.direction[some]
    return a.mass[some][:, None] * (f[:, :1] * e + f[:, 1:] * np.stack([-e[:, 1], e[:, 0]], axis=1))


SNAPSHOT = SnapshotMeasures(vector_errors, acceleration_error, stress, stress_error, component, exact_component,
                            body_force)
