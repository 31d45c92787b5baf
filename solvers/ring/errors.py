"""The ring's true errors at every particle, for snapshots: computed minus exact, in numpy.

The page asks for them with every frame, so they cost as little as can be: what is known of a particle's radius is
looked up, and tensors are written out in components, since numpy's products of many small matrices are slow.
"""

from __future__ import annotations

import numpy as np

from solvers.ring import exact
from solvers.ring.scene import RingScene
from solvers.ring.state import Arrays


def true_errors(scene: RingScene, a: Arrays, step: int, with_acceleration: bool) -> np.ndarray:
    """Sizes of the true errors of x, v, sigma and a (P, 4) after ``step`` steps."""
    time = step * scene.time_step
    shift, speed, _ = exact.time_factors(scene, time)
    w = a.shape[a.radius]
    out = np.zeros((len(w), 4))
    with np.errstate(all="ignore"):  # a run gone bad holds anything
        out[:, 0] = _size(a.motion[:, 0] - a.material_position[:, 0], a.motion[:, 1] - a.material_position[:, 1],
                          shift * w, a.direction)
        out[:, 1] = _size(a.motion[:, 2], a.motion[:, 3], speed * w, a.direction)
        out[:, 2] = _stress_error(scene, a, time)
        if with_acceleration and step:  # the one that the last step used
            before = exact.time_factors(scene, time - scene.time_step)[2]
            out[:, 3] = _size(a.acceleration[:, 0], a.acceleration[:, 1], before * w, a.direction)
    return out


def _size(x: np.ndarray, y: np.ndarray, radial: np.ndarray, direction: np.ndarray) -> np.ndarray:
    """Lengths (P,) of the vectors (x, y) less the exact ones, of size ``radial`` along e_R."""
    x, y = x - radial * direction[:, 0], y - radial * direction[:, 1]
    return np.sqrt(x * x + y * y)


def _stress_error(scene: RingScene, a: Arrays, time: float) -> np.ndarray:
    """Frobenius norms (P,) of the error of the Cauchy stress."""
    F, mu = np.ascontiguousarray(a.deformation_gradient.T), 0.5 * scene.modulus
    scale = mu / (F[0] * F[3] - F[1] * F[2])
    along, across = exact.principal_stresses(scene, a.radii, time)
    mean, half = (0.5 * (along + across))[a.radius], (0.5 * (along - across))[a.radius]
    c, s = np.ascontiguousarray(a.direction.T)
    turned = half * (c * c - s * s)
    xx = scale * (F[0] * F[0] + F[1] * F[1] - 1) - mean - turned
    xy = scale * (F[0] * F[2] + F[1] * F[3]) - 2 * half * c * s
    yy = scale * (F[2] * F[2] + F[3] * F[3] - 1) - mean + turned
    return np.sqrt(xx * xx + 2 * xy * xy + yy * yy)
