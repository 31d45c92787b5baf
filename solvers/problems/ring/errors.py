"""The ring's true errors at every particle, for snapshots: computed minus exact, in numpy.

What is known of a particle's radius is looked up, for the page asks for them with every frame.
"""

import numpy as np

from solvers.problems.planar.errors import Fields
from solvers.problems.ring import exact
from solvers.problems.ring.scene import RingScene
from solvers.problems.ring.state import WatchedRing


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
