"""The exact solution that a displacement makes along a line whose stress is linear in its stretch, P = E (F - 1): as
``solvers.motion.exact_solution`` in the plane, with the body force per mass b = u_tt - c^2 u_XX, c^2 = E/rho."""

from collections.abc import Callable
from typing import Any

import numpy as np

from solvers.motion.exact_solution import TIME, X_AXIS
from solvers.motion.jets import Jet, variables


class LineSolution:
    """Functions of (scene, X in m, t in s, or a time for each X) that follow from u(scene, X, Y, t) of any kind of
    number, one component, and that have the shape of X. ``scene`` gives the ``wave_speed`` c in m/s."""

    def __init__(self, displacement: Callable[[Any, Any, Any, Any], tuple[Any, ...]]):
        self._displacement = displacement

    def derivatives(self, scene: Any, X: np.ndarray, t: Any, *axes: tuple[int, ...]) -> list[np.ndarray]:
        """Of u: () itself, (X_AXIS,) its slope, (TIME, TIME) its acceleration."""
        t = np.reshape(t, X.shape) if np.ndim(t) else t
        (u,) = self._displacement(scene, *variables(X, None, t))
        found = [u.derivative(*one) if one else u.value for one in axes] if isinstance(u, Jet) \
            else [0.0 if one else u for one in axes]
        return [np.array(np.broadcast_to(one, X.shape)) for one in found]

    def displacement(self, scene: Any, X: np.ndarray, t: Any) -> np.ndarray:
        """u in m."""
        return self.derivatives(scene, X, t, ())[0]

    def velocity(self, scene: Any, X: np.ndarray, t: Any) -> np.ndarray:
        """v in m/s."""
        return self.derivatives(scene, X, t, (TIME,))[0]

    def acceleration(self, scene: Any, X: np.ndarray, t: Any) -> np.ndarray:
        """a in m/s^2."""
        return self.derivatives(scene, X, t, (TIME, TIME))[0]

    def deformation_gradient(self, scene: Any, X: np.ndarray, t: Any) -> np.ndarray:
        """F = 1 + u_X."""
        return 1 + self.derivatives(scene, X, t, (X_AXIS,))[0]

    def body_force(self, scene: Any, X: np.ndarray, t: Any) -> np.ndarray:
        """b per mass in m/s^2, the force that makes the displacement the solution."""
        a, bend = self.derivatives(scene, X, t, (TIME, TIME), (X_AXIS, X_AXIS))
        return a - scene.wave_speed**2 * bend
