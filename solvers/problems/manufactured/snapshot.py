"""What a manufactured problem knows of itself, for snapshots (see ``solvers.problems.planar.solver``)."""

import numpy as np

from solvers.motion.neo_hookean import cauchy_stress
from solvers.problems.manufactured.method.body import ManufacturedBody
from solvers.problems.manufactured.scene import ManufacturedScene
from solvers.problems.planar.parts import SnapshotMeasures

Vector = tuple[np.ndarray, np.ndarray]
Tensor = tuple[np.ndarray, np.ndarray, np.ndarray]


def vector_errors(scene: ManufacturedScene, a: ManufacturedBody, time: float) -> tuple[Vector, Vector]:
    X, q = a.material_position, a.position_velocity
    exact = scene.EXACT.jets(scene, X, time)
    v_x, v_y = exact.velocity
    return ((q[:, 0] - X[:, 0] - exact.x.value, q[:, 1] - X[:, 1] - exact.y.value), (q[:, 2] - v_x, q[:, 3] - v_y))


def acceleration_error(scene: ManufacturedScene, a: ManufacturedBody, time: float) -> Vector:
    x, y = scene.EXACT.jets(scene, a.material_position, time).acceleration
    return a.acceleration[:, 0] - x, a.acceleration[:, 1] - y


def stress(a: ManufacturedBody) -> Tensor:
    return cauchy_stress(np.ascontiguousarray(a.deformation_gradient.T), a.lame_modulus, a.shear_modulus)


def stress_error(scene: ManufacturedScene, a: ManufacturedBody, time: float) -> Tensor:
    exact = scene.EXACT.stress(scene, a.material_position, time).T
    xx, xy, yy = (mine - theirs for mine, theirs in zip(stress(a), exact, strict=True))
    return xx, xy, yy


def component(a: ManufacturedBody, quantity: str) -> np.ndarray:
    """Along x."""
    if quantity == "sigma":
        return stress(a)[0]
    if quantity == "x":
        return a.position_velocity[:, 0] - a.material_position[:, 0]
    return a.position_velocity[:, 2] if quantity == "v" else a.acceleration[:, 0]


def exact_component(scene: ManufacturedScene, a: ManufacturedBody, quantity: str, time: float) -> np.ndarray:
    return scene.exact_along_x(quantity, a.material_position, time)


def body_force(a: ManufacturedBody, some: np.ndarray) -> np.ndarray:
    return a.mass[some][:, None] * a.particle_force[some]


SNAPSHOT = SnapshotMeasures(vector_errors, acceleration_error, stress, stress_error, component, exact_component,
                            body_force)
