"""The field that a frame brings for a plot: the radial component of one quantity, and how far it is from the exact."""

import numpy as np

from solvers.problems.ring import exact
from solvers.problems.ring.scene import RingScene
from solvers.problems.ring.state import WatchedRing


def field(scene: RingScene, a: WatchedRing, quantity: str, t: float) -> np.ndarray:
    """Along e_R at the material position: the quantity and its deviation from ``exact.field`` (P, 2), NaN where one is
    not known. The stress is Cauchy's, mu/J (F F^T - I)."""
    c, s = np.ascontiguousarray(a.direction.T)
    with np.errstate(all="ignore"):  # a run gone bad holds anything
        if quantity == "sigma":
            F = np.ascontiguousarray(a.deformation_gradient.T)
            x, y = F[0] * c + F[2] * s, F[1] * c + F[3] * s  # F^T e_R
            values = 0.5 * scene.modulus / (F[0] * F[3] - F[1] * F[2]) * (x * x + y * y - 1)
        elif quantity == "a" and not scene.has("acceleration"):
            values = np.full(len(c), np.nan)
        else:
            vectors = {"x": a.motion[:, :2], "v": a.motion[:, 2:], "a": a.acceleration}[quantity]
            if quantity == "x":
                vectors = vectors - a.material_position
            values = vectors[:, 0] * c + vectors[:, 1] * s
        deviation = values - exact.field(scene, quantity, a.radii[:, 0], t)[a.radius] if scene.solution_known \
            else np.full(len(c), np.nan)
    return np.stack([values, deviation], axis=1)
