"""The exact solution of a plane problem at one time, as its error budget needs it."""

from typing import Any, NamedTuple

import numpy as np

from solvers.motion.exact_solution import TIME, X_AXIS, Y_AXIS, stack_components
from solvers.problems.planar.method.body import PlanarBody
from solvers.problems.planar.scene import motion_table


class ExactState(NamedTuple):
    """The exact solution at one time, at the material positions of P particles, in SI units."""

    displacement: np.ndarray  # u (P, 2)
    velocity: np.ndarray  # v (P, 2)
    acceleration: np.ndarray  # a (P, 2)
    body_force: np.ndarray  # per mass (P, 2)
    deformation_gradient: np.ndarray  # F (P, 2, 2)
    rate: np.ndarray  # F_t, which is the gradient of v along X (P, 2, 2)
    second_rate: np.ndarray  # F_tt, that of a (P, 2, 2)


def exact_state_at(scene: Any, a: PlanarBody, t: float) -> ExactState:
    """Returns the scene's exact solution at the time t in s, at the particles of the arrays ``a``."""
    jets, K = scene.EXACT.jets(scene, a.orbit_point, t), len(a.orbit_point)
    rate = [one.derivative(axis, TIME) for one in jets for axis in (X_AXIS, Y_AXIS)]
    vectors = [stack_components(one, K) for one in ((jets.x.value, jets.y.value), jets.velocity, jets.acceleration,
                                                    jets.body_force(scene.material, scene.density))]
    tensors = [stack_components(jets.deformation_gradient, K), stack_components(rate, K),
               motion_table(scene)(t, 2)[:, 2:]]
    c, s = a.direction.T
    Q = np.stack([c, -s, s, c], axis=1).reshape(-1, 2, 2)
    return ExactState(*(np.einsum("pij,pj->pi", Q, one[a.orbit]) for one in vectors),
                      *(Q @ one.reshape(-1, 2, 2)[a.orbit] @ Q.swapaxes(1, 2) for one in tensors))
