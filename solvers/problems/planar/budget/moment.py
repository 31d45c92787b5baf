"""The exact solution of a plane problem at one time, as the budget asks for it."""

from typing import NamedTuple

import numpy as np


class Moment(NamedTuple):
    """At the material positions of P particles, SI."""

    displacement: np.ndarray  # u (P, 2)
    velocity: np.ndarray  # v (P, 2)
    acceleration: np.ndarray  # a (P, 2)
    body_force: np.ndarray  # per mass (P, 2)
    deformation_gradient: np.ndarray  # F (P, 2, 2)
    rate: np.ndarray  # F_t, which is the gradient of v along X (P, 2, 2)
    second_rate: np.ndarray  # F_tt, that of a (P, 2, 2)
