"""The field that a frame brings for a plot: one quantity of the bar's particles, and how far it is from the exact."""

import numpy as np

from solvers.problems.bar import exact
from solvers.problems.bar.scene import BarScene
from solvers.problems.bar.state import WatchedBar


def field(scene: BarScene, a: WatchedBar, quantity: str, t: float) -> np.ndarray:
    """The quantity and its deviation from ``exact.field`` (P, 2), NaN where one is not known."""
    X = a.material_position
    with np.errstate(over="ignore", invalid="ignore"):  # a run gone bad holds anything
        moved = exact.displacement(scene, X, t) if scene.is_patch else 0.0
        values = {"x": a.position - X - moved, "v": a.velocity,
                  "sigma": a.modulus * (a.deformation_gradient - a.unstretched),
                  "a": a.acceleration if scene.has("acceleration") else np.nan}[quantity]
        deviation = values - exact.field(scene, quantity, X, t) if scene.solution_known else np.nan
    return np.stack(np.broadcast_arrays(values, deviation, X)[:2], axis=1)
