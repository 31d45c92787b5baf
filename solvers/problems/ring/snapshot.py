"""What the ring knows of itself, for snapshots (see ``solvers.problems.planar.solver``): all is radial."""

import numpy as np

from solvers.problems.planar.parts import SnapshotMeasures
from solvers.problems.ring import exact
from solvers.problems.ring.method.body import RingBody
from solvers.problems.ring.scene import RingScene

Vector = tuple[np.ndarray, np.ndarray]
Tensor = tuple[np.ndarray, np.ndarray, np.ndarray]


def vector_errors(scene: RingScene, a: RingBody, time: float) -> tuple[Vector, Vector]:
    shift, speed, _ = exact.time_factors(scene, time)
    w, q, X = a.radii[a.radius, 1], a.position_velocity, a.material_position
    return (_beyond(q[:, 0] - X[:, 0], q[:, 1] - X[:, 1], shift * w, a.direction),
            _beyond(q[:, 2], q[:, 3], speed * w, a.direction))


def acceleration_error(scene: RingScene, a: RingBody, time: float) -> Vector:
    radial = exact.time_factors(scene, time)[2] * a.radii[a.radius, 1]
    return _beyond(a.acceleration[:, 0], a.acceleration[:, 1], radial, a.direction)


def _beyond(x: np.ndarray, y: np.ndarray, radial: np.ndarray, direction: np.ndarray) -> Vector:
    """The vectors (x, y) less the exact ones, of size ``radial`` along e_R."""
    return x - radial * direction[:, 0], y - radial * direction[:, 1]


def stress(a: RingBody) -> Tensor:
    """mu/J (F F^T - I)."""
    F = np.ascontiguousarray(a.deformation_gradient.T)
    scale = a.shear_modulus / (F[0] * F[3] - F[1] * F[2])
    return (scale * (F[0] * F[0] + F[1] * F[1] - 1), scale * (F[0] * F[2] + F[1] * F[3]),
            scale * (F[2] * F[2] + F[3] * F[3] - 1))


def stress_error(scene: RingScene, a: RingBody, time: float) -> Tensor:
    along, across = exact.principal_stresses(scene, a.radii[:, 0], time)
    mean, half = (0.5 * (along + across))[a.radius], (0.5 * (along - across))[a.radius]
    c, s = np.ascontiguousarray(a.direction.T)
    turned = half * (c * c - s * s)
    xx, xy, yy = stress(a)
    return xx - mean - turned, xy - 2 * half * c * s, yy - mean + turned


def component(a: RingBody, quantity: str) -> np.ndarray:
    """Along e_R at the material position."""
    c, s = np.ascontiguousarray(a.direction.T)
    if quantity == "sigma":
        F = np.ascontiguousarray(a.deformation_gradient.T)
        x, y = F[0] * c + F[2] * s, F[1] * c + F[3] * s  # F^T e_R
        return a.shear_modulus / (F[0] * F[3] - F[1] * F[2]) * (x * x + y * y - 1)
    vectors = {"x": a.position_velocity[:, :2], "v": a.position_velocity[:, 2:], "a": a.acceleration}[quantity]
    if quantity == "x":
        vectors = vectors - a.material_position
    return vectors[:, 0] * c + vectors[:, 1] * s


def exact_component(scene: RingScene, a: RingBody, quantity: str, time: float) -> np.ndarray:
    return exact.field(scene, quantity, a.radii[:, 0], time)[a.radius]


def body_force(a: RingBody, some: np.ndarray) -> np.ndarray:
    return (a.mass * a.radial_force[a.radius])[some, None] * a.direction[some]


SNAPSHOT = SnapshotMeasures(vector_errors, acceleration_error, stress, stress_error, component, exact_component,
                            body_force)
