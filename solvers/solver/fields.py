"""All that a body's particles are at an instant, with the errors of it that are known or estimated, sign and all."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

TRUTH = "truth"  # the name of the true errors among those of estimators


class Values(NamedTuple):
    """Displacement (P, D) in m, velocity (P, D) in m/s and Cauchy stress (P, S) in Pa, which is sigma along the bar
    (S = 1) and xx, xy, yy in the plane (S = 3); or the errors of these, computed minus exact."""

    displacement: np.ndarray
    velocity: np.ndarray
    stress: np.ndarray

    def less(self, errors: "Values") -> "Values":
        """What they would be without these errors."""
        return Values(*(mine - theirs for mine, theirs in zip(self, errors, strict=True)))


@dataclass(frozen=True)
class Fields:
    """P particles: where they are at rest (P, D) in m, their mass in kg and volume at the start in m^D (P,), what they
    are, and the errors of that by the name of who says so: each estimator that ran, and :data:`TRUTH`."""

    material_position: np.ndarray
    mass: np.ndarray
    volume: np.ndarray
    values: Values
    errors: Mapping[str, Values] = field(default_factory=dict)
