"""What a manufactured problem tells the error budget of itself: its exact motion, with F_tt from the motion's table."""

from typing import Any

import numpy as np

from solvers.motion.exact_solution import TIME, X_AXIS, Y_AXIS, columns
from solvers.problems.manufactured.scene import motion_table
from solvers.problems.planar.budget.reference import Moment


def moment(scene: Any, X: np.ndarray, t: float) -> Moment:
    """The exact solution at the particles' material positions X (P, 2)."""
    jets, P = scene.EXACT.jets(scene, X, t), len(X)
    rate = [one.derivative(axis, TIME) for one in jets for axis in (X_AXIS, Y_AXIS)]
    return Moment(columns((jets.x.value, jets.y.value), P), columns(jets.velocity, P), columns(jets.acceleration, P),
                  columns(jets.body_force(scene.lame_moduli, scene.density), P),
                  columns(jets.deformation_gradient, P).reshape(-1, 2, 2), columns(rate, P).reshape(-1, 2, 2),
                  motion_table(scene)(t, 2)[:, 2:].reshape(-1, 2, 2))
