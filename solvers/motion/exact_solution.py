"""Exact solution by a displacement and a material law: motion, stress and the body force that causes it.

The method of manufactured solutions: of u(X, Y, t) follow v = u_t, a = u_tt, F = I + Grad u, the stress P(F), and the
body force per mass b = a - Div P/rho that makes u the solution. Source: Roache, J. Fluids Eng. 124 (2002) 4-10.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from solvers.motion.jets import Jet, variables
from solvers.motion.laws.elastic_material import ElasticMaterial

X_AXIS, Y_AXIS, TIME = range(3)
SECOND_FREQUENCY = 1.7  # of a body force's second tone, over that of the first
#: (scene, X, Y, t) -> (u_x, u_y), of any kind of number: arrays, or jets with the functions of ``solvers.motion.jets``.
Displacement = Callable[[Any, Any, Any, Any], tuple[Any, Any]]


class DisplacementJets(NamedTuple):
    """Displacement of P material points in m: its components as jets of second order in X, Y and t."""

    x: Jet
    y: Jet

    @property
    def velocity(self) -> tuple[Any, Any]:
        """Components v_x, v_y in m/s, each an array (P,) or a number."""
        return self.x.derivative(TIME), self.y.derivative(TIME)

    @property
    def acceleration(self) -> tuple[Any, Any]:
        """Components a_x, a_y in m/s^2, each an array (P,) or a number."""
        return self.x.derivative(TIME, TIME), self.y.derivative(TIME, TIME)

    @property
    def displacement_and_gradient(self) -> tuple[Any, ...]:
        """Components u_x, u_y in m, and Grad u = F - I as xX, xY, yX, yY, each an array (P,) or a number."""
        return (self.x.value, self.y.value, *(one.derivative(axis) for one in self for axis in (X_AXIS, Y_AXIS)))

    @property
    def deformation_gradient(self) -> tuple[Any, Any, Any, Any]:
        """Components F_xx, F_xy, F_yx, F_yy, each an array (P,) or a number."""
        return (1.0 + self.x.derivative(X_AXIS), self.x.derivative(Y_AXIS),
                self.y.derivative(X_AXIS), 1.0 + self.y.derivative(Y_AXIS))

    def body_force(self, material: ElasticMaterial, density: float) -> tuple[Any, Any]:
        """Returns the force per mass a - Div P/rho in m/s^2 as b_x, b_y; ``density`` is rho in kg/m^3."""
        F = [Jet(value, (one.derivative(axis, X_AXIS), one.derivative(axis, Y_AXIS), None), ())
             for value, (one, axis) in zip(self.deformation_gradient,
                                           ((one, axis) for one in self for axis in (X_AXIS, Y_AXIS)), strict=True)]
        P = material.first_piola_stress(F)
        divergence = (P[0].derivative(X_AXIS) + P[1].derivative(Y_AXIS),
                      P[2].derivative(X_AXIS) + P[3].derivative(Y_AXIS))
        a = self.acceleration
        return a[0] - divergence[0] / density, a[1] - divergence[1] / density


class ExactSolution:
    """Motion of a body in the plane and what causes it, as functions of (scene, X (P, 2) in m, t in s).

    ``displacement`` is the function (scene, X, Y, t) -> (u_x, u_y) in m that all follow from. ``scene`` has the
    ``material``, the ``density`` in kg/m^3, and whatever the displacement needs.
    """

    def __init__(self, displacement: Displacement):
        self._displacement = displacement

    def jets(self, scene: Any, X: np.ndarray, t: Any) -> DisplacementJets:
        """Returns displacement and derivatives at material points ``X`` (P, 2) in m, at one time in s or (P,)."""
        u = self._displacement(scene, *variables(X[:, 0], X[:, 1], t))
        return DisplacementJets(*(one if isinstance(one, Jet) else Jet(one) for one in u))

    def displacement(self, scene: Any, X: np.ndarray, t: Any) -> np.ndarray:
        """Returns displacements (P, 2) in m of material points ``X`` (P, 2) in m, at one time in s or (P,)."""
        return stack_components(self._displacement(scene, X[:, 0], X[:, 1], t), len(X))

    def position(self, scene: Any, X: np.ndarray, t: Any) -> np.ndarray:
        """Returns positions X + u (P, 2) in m of material points ``X`` (P, 2) in m, at one time in s or (P,)."""
        return X + self.displacement(scene, X, t)

    def velocity(self, scene: Any, X: np.ndarray, t: Any) -> np.ndarray:
        """Returns velocities (P, 2) in m/s of material points ``X`` (P, 2) in m, at one time in s or (P,)."""
        return stack_components(self.jets(scene, X, t).velocity, len(X))

    def acceleration(self, scene: Any, X: np.ndarray, t: Any) -> np.ndarray:
        """Returns accelerations (P, 2) in m/s^2 of points ``X`` (P, 2) in m at rest, at one time in s or (P,)."""
        return stack_components(self.jets(scene, X, t).acceleration, len(X))

    def deformation_gradient(self, scene: Any, X: np.ndarray, t: Any) -> np.ndarray:
        """Returns F (P, 2, 2) at material points ``X`` (P, 2) in m, at one time in s or (P,)."""
        return stack_components(self.jets(scene, X, t).deformation_gradient, len(X)).reshape(-1, 2, 2)

    def stress(self, scene: Any, X: np.ndarray, t: Any) -> np.ndarray:
        """Returns Cauchy stress xx, xy, yy (P, 3) in Pa at points ``X`` (P, 2) in m at rest, at a time in s or (P,)."""
        return stack_components(scene.material.cauchy_stress(self.jets(scene, X, t).deformation_gradient), len(X))

    def body_force(self, scene: Any, X: np.ndarray, t: Any) -> np.ndarray:
        """Returns the force per mass (P, 2) in m/s^2 that the motion needs, at points ``X`` (P, 2) in m, times in s."""
        return stack_components(self.jets(scene, X, t).body_force(scene.material, scene.density), len(X))


def stack_components(components: Any, points: int) -> np.ndarray:
    """Returns C ``components``, each an array (P,) or a number, as one array (P, C) for P = ``points``."""
    return np.stack([np.broadcast_to(one, points) for one in components], axis=1)
