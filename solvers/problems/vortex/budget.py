"""What the vortex tells the error budget of itself: its exact motion and its moduli."""

import numpy as np

from solvers.problems.planar.budget.moment import Moment
from solvers.problems.planar.budget.on_demand import PlanarBudget
from solvers.problems.vortex import exact
from solvers.problems.vortex.scene import VortexScene
from solvers.problems.vortex.solver import VortexSolver


def moment(scene: VortexScene, X: np.ndarray, t: float) -> Moment:
    """The exact solution at the material positions X (P, 2).

    F depends on time through g alone, F = Q(g h) (I + R g h' e_Theta e_R^T); with J a left turn by 90 degrees and
    B = R h' J Q e_R e_R^T = R h' Q e_Theta e_R^T: F_g = h J F + B and F_gg = -h^2 F + 2 h J B.
    """
    R = np.linalg.norm(X, axis=1)
    (h, slope, _), (_, speed, change) = exact.shape(R), exact.time_factors(scene, t)
    angle, e = exact.turn(scene, R, t).angle, X / R[:, None]
    around = exact.combined(e, -np.sin(angle), np.cos(angle))  # Q e_Theta
    F, h = exact.deformation_gradient(scene, X, t), h[:, None, None]
    B = (R * slope)[:, None, None] * around[:, :, None] * e[:, None, :]
    first, second = h * _left(F) + B, -h * h * F + 2 * h * _left(B)
    return Moment(exact.displacement(scene, X, t), exact.velocity(scene, X, t), exact.acceleration(scene, X, t),
                  exact.body_force(scene, X, t), F, speed * first, speed**2 * second + change * first)


def _left(tensors: np.ndarray) -> np.ndarray:
    """J times tensors (P, 2, 2)."""
    return np.stack([-tensors[:, 1], tensors[:, 0]], axis=1)


BUDGET = PlanarBudget(VortexSolver, moment, exact.lame)
