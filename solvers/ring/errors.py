"""The ring's true errors at every particle, for snapshots: computed minus exact, in numpy.

The page asks for them with every frame, so they cost as little as can be: what is known of a particle's radius is
looked up, and tensors are written out in components, since numpy's products of many small matrices are slow.
"""

import numpy as np

from solvers.ring import exact
from solvers.ring.scene import RingScene
from solvers.ring.state import WatchedRing

#: Components of an error: (x, y) of a vector, (xx, xy, yy) of a tensor, None where it is unknown.
Parts = tuple[np.ndarray, ...] | None
Fields = list[Parts]  # of x, v, sigma and a


def true_fields(scene: RingScene, a: WatchedRing, step: int, with_acceleration: bool) -> Fields:
    """The true errors of x, v, sigma and a after ``step`` steps, in components."""
    time = step * scene.time_step
    shift, speed, _ = exact.time_factors(scene, time)
    w = a.radii[a.radius, 1]
    with np.errstate(all="ignore"):  # a run gone bad holds anything
        position = _beyond(a.motion[:, 0] - a.material_position[:, 0], a.motion[:, 1] - a.material_position[:, 1],
                           shift * w, a.direction)
        velocity = _beyond(a.motion[:, 2], a.motion[:, 3], speed * w, a.direction)
        stress = _stress_error(scene, a, time)
        acceleration = None
        if with_acceleration and step:  # the one that the last step used
            before = exact.time_factors(scene, time - scene.time_step)[2]
            acceleration = _beyond(a.acceleration[:, 0], a.acceleration[:, 1], before * w, a.direction)
    return [position, velocity, stress, acceleration]


def estimated_fields(a: WatchedRing, estimator: int) -> Fields:
    """What the estimator of this number reports of the same errors."""
    part = slice(estimator * len(a.motion), (estimator + 1) * len(a.motion))
    motion = a.estimate[part].T
    return [(motion[0], motion[1]), (motion[2], motion[3]), tuple(a.estimate_stress[part].T[:3]),
            tuple(a.estimate_acceleration[part].T)]


def sizes(errors: Fields) -> np.ndarray:
    """Lengths of the vectors and Frobenius norms of the tensors (P, 4); 0 where an error is None."""
    out = np.zeros((next(len(parts[0]) for parts in errors if parts), len(errors)))
    with np.errstate(over="ignore", invalid="ignore"):
        for column, parts in enumerate(errors):
            if parts is not None:  # numpy's norm along so short an axis takes four times as long
                first, last = parts[0], parts[-1]
                square = first * first + last * last
                out[:, column] = np.sqrt(square if len(parts) == 2 else square + 2 * parts[1] * parts[1])
    return out


def difference(one: Fields, other: Fields) -> np.ndarray:
    """Sizes (P, 4) of ``one`` minus ``other``, direction and all. What is None counts as 0."""
    with np.errstate(over="ignore", invalid="ignore"):
        return sizes([mine if mine is None or theirs is None else
                      tuple(a - b for a, b in zip(mine, theirs, strict=True))
                      for mine, theirs in zip(one, other, strict=True)])


def _beyond(x: np.ndarray, y: np.ndarray, radial: np.ndarray, direction: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The vectors (x, y) less the exact ones, of size ``radial`` along e_R."""
    return x - radial * direction[:, 0], y - radial * direction[:, 1]


def _stress_error(scene: RingScene, a: WatchedRing, time: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The error (xx, xy, yy) of the Cauchy stress."""
    F, mu = np.ascontiguousarray(a.deformation_gradient.T), 0.5 * scene.modulus
    scale = mu / (F[0] * F[3] - F[1] * F[2])
    along, across = exact.principal_stresses(scene, a.radii[:, 0], time)
    mean, half = (0.5 * (along + across))[a.radius], (0.5 * (along - across))[a.radius]
    c, s = np.ascontiguousarray(a.direction.T)
    turned = half * (c * c - s * s)
    xx = scale * (F[0] * F[0] + F[1] * F[1] - 1) - mean - turned
    xy = scale * (F[0] * F[2] + F[1] * F[3]) - 2 * half * c * s
    yy = scale * (F[2] * F[2] + F[3] * F[3] - 1) - mean + turned
    return xx, xy, yy
