"""The field for a plot: the component around the centre of one quantity, and how far it is from the exact."""

import numpy as np

from solvers.problems.vortex import exact
from solvers.problems.vortex.errors import stress
from solvers.problems.vortex.scene import VortexScene
from solvers.problems.vortex.state import WatchedVortex


def exact_field(scene: VortexScene, quantity: str, R: np.ndarray, t: float) -> np.ndarray:
    """At the radii R, of a quantity by its key (``samples.QUANTITIES``), u for x: along e_Theta of the particle at rest
    for x, along e_theta of where it is for v and a, and sigma_rt; as a method has it after the time t: its acceleration
    is the one that its last step used, which began a step before."""
    if quantity == "sigma":
        return exact.polar_stress(scene, R, t)[1]
    turn = exact.turn(scene, R, max(0.0, t - scene.time_step) if quantity == "a" else t)
    return R * {"x": np.sin(turn.angle), "v": turn.rate, "a": turn.acceleration}[quantity]


def field(scene: VortexScene, a: WatchedVortex, quantity: str, t: float) -> np.ndarray:
    """The same of the particles, and its deviation from :func:`exact_field` (P, 2), NaN where one is not known."""
    R = a.radii[:, 0]
    with np.errstate(all="ignore"):  # a run gone bad holds anything
        c, s = a.motion[:, :2].T / np.hypot(a.motion[:, 0], a.motion[:, 1])  # e_r where the particles are
        if quantity == "sigma":
            xx, xy, yy = stress(a)
            values = (yy - xx) * c * s + xy * (c * c - s * s)
        elif quantity == "a" and not scene.has("acceleration"):
            values = np.full(len(c), np.nan)
        elif quantity == "x":
            e, X = a.direction, a.material_position
            values = (a.motion[:, 1] - X[:, 1]) * e[:, 0] - (a.motion[:, 0] - X[:, 0]) * e[:, 1]
        else:
            vectors = a.motion[:, 2:] if quantity == "v" else a.acceleration
            values = vectors[:, 1] * c - vectors[:, 0] * s
        deviation = values - exact_field(scene, quantity, R, t)[a.radius] if scene.solution_known \
            else np.full(len(c), np.nan)
    return np.stack([values, deviation], axis=1)
