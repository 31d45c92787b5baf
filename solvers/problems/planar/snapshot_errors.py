"""Errors of a plane body's arrays in numpy, as in a snapshot: computed minus exact.

The page computes them with every frame, so they must be cheap: the exact solution is evaluated once per orbit and
rotated to its particles, and vectors (x, y) and tensors (xx, xy, yy), each (P,), are written out in components, since
numpy's products of many small matrices are slow.
"""

from typing import Any

import numpy as np

from solvers.problems.planar.method.body import PlanarBody

Vector = tuple[np.ndarray, np.ndarray]
Tensor = tuple[np.ndarray, np.ndarray, np.ndarray]
#: Components of an error: (x, y) of a vector, (xx, xy, yy) of a tensor, None where it is unknown.
Parts = tuple[np.ndarray, ...] | None
Errors = list[Parts]  # of x, v, sigma and a


@np.errstate(all="ignore")  # for unstable runs
def true_errors(scene: Any, a: PlanarBody, step: int) -> Errors:
    """Returns true errors in SI of x, v, sigma and a (None if that is off) of the arrays ``a`` after ``step`` steps."""
    time = step * scene.time_step
    used = None
    if step and scene.has("acceleration"):  # the one that the last step has used
        x, y = _rotate_to_particles(a, *scene.EXACT.jets(scene, a.orbit_point, time - scene.time_step).acceleration)
        used = a.acceleration[:, 0] - x, a.acceleration[:, 1] - y
    return [*vector_errors(scene, a, time), stress_error(scene, a, time), used]


def vector_errors(scene: Any, a: PlanarBody, time: float) -> tuple[Vector, Vector]:
    """Returns the true errors of x (m) and of v (m/s) in the arrays ``a`` at ``time`` s, each as components (P,)."""
    exact = scene.EXACT.jets(scene, a.orbit_point, time)
    (x, y), (v_x, v_y) = _rotate_to_particles(a, exact.x.value, exact.y.value), _rotate_to_particles(a, *exact.velocity)
    X, q = a.material_position, a.position_velocity
    return (q[:, 0] - X[:, 0] - x, q[:, 1] - X[:, 1] - y), (q[:, 2] - v_x, q[:, 3] - v_y)


def cauchy_stress_of(scene: Any, a: PlanarBody) -> Tensor:
    """Returns the Cauchy stress of the particles in the arrays ``a``, as xx, xy, yy (P,) in Pa."""
    return scene.material.cauchy_stress(np.ascontiguousarray(a.deformation_gradient.T))


def stress_error(scene: Any, a: PlanarBody, time: float) -> Tensor:
    """Returns the true error of the Cauchy stress in the arrays ``a`` at ``time`` s, as xx, xy, yy (P,) in Pa."""
    xx, xy, yy = (one[a.orbit] for one in scene.EXACT.stress(scene, a.orbit_point, time).T)
    c, s = np.ascontiguousarray(a.direction.T)
    mean, half, double = 0.5 * (xx + yy), 0.5 * (xx - yy), 2 * c * s
    cosine = c * c - s * s
    along, across = half * cosine - xy * double, half * double + xy * cosine
    mine = cauchy_stress_of(scene, a)
    return mine[0] - mean - along, mine[1] - across, mine[2] - mean + along


def body_force(a: PlanarBody, some: np.ndarray) -> np.ndarray:
    """Returns the body force (c, 2), in N per metre of thickness, on the particles with the indices ``some`` (c,)."""
    return a.mass[some][:, None] * np.stack(rotate_vectors(a.direction[some], *a.orbit_force[a.orbit[some]].T), axis=1)


def _rotate_to_particles(a: PlanarBody, x: Any, y: Any) -> Vector:
    """Returns components (P,) of vectors x, y (K,) at the orbits' points, rotated to the orbits' particles."""
    return rotate_vectors(a.direction, *(np.broadcast_to(one, len(a.orbit_point))[a.orbit] for one in (x, y)))


def rotate_vectors(e: np.ndarray, x: np.ndarray, y: np.ndarray) -> Vector:
    """Returns components (P,) of vectors x, y (P,), each rotated by the angle from the x axis to its e (P, 2)."""
    c, s = np.ascontiguousarray(e.T)
    return x * c - y * s, y * c + x * s
