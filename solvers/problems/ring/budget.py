"""What the ring tells the error budget of itself: its exact motion, and that lambda is 0."""

import numpy as np

from solvers.problems.planar.budget.moment import Moment
from solvers.problems.planar.budget.on_demand import PlanarBudget
from solvers.problems.ring import exact
from solvers.problems.ring.scene import RingScene
from solvers.problems.ring.solver import RingSolver


def moment(scene: RingScene, X: np.ndarray, t: float) -> Moment:
    """The exact solution at the material positions X (P, 2): separable, F - I is T(t) times a field."""
    R = np.linalg.norm(X, axis=1)
    e = X / R[:, None]
    (w, slope, _), (size, speed, change) = exact.shape(R), exact.time_factors(scene, t)
    outward = e[:, :, None] * e[:, None, :]
    gradient = (w / R)[:, None, None] * (np.eye(2) - outward) + slope[:, None, None] * outward
    radial = w[:, None] * e
    force = exact.body_force(scene, R, t)[:, None] * e
    return Moment(size * radial, speed * radial, change * radial, force, np.eye(2) + size * gradient, speed * gradient,
                  change * gradient)


BUDGET = PlanarBudget(RingSolver, moment, lambda scene: (0.0, 0.5 * scene.modulus))
