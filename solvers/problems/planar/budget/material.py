"""The stress that the errors of a budget make.

The stress is neo-Hookean in the plane, lambda ln J I + mu (F F^T - I) as Kirchhoff's. In two dimensions det F is
quadratic in F, and so is F F^T: the difference of either between F and F0 is linear in F - F0, with coefficients at the
mean of the two. The logarithm, and 1/J, are divided by their secants. So the stress of a sum of errors is the sum of
their stresses, to round-off, however large they are.
"""

from typing import NamedTuple

import numpy as np


class Material(NamedTuple):
    """Its moduli in Pa; ``at_rest``: the first Piola-Kirchhoff stress is meant, as weights of the rest want it."""

    bulk: float  # lambda
    shear: float  # mu
    at_rest: bool

    def stress(self, F: np.ndarray) -> np.ndarray:
        """J sigma, or P, of F (P, 2, 2)."""
        J = np.linalg.det(F)[:, None, None]
        if self.at_rest:
            return self.shear * F + (self.bulk * np.log(J) - self.shear) / J * cofactor(F)
        return self.bulk * np.log(J) * np.eye(2) + self.shear * (F @ F.swapaxes(1, 2) - np.eye(2))

    def difference(self, F: np.ndarray, F0: np.ndarray, parts: np.ndarray) -> np.ndarray:
        """What each part (C, P, 2, 2) of F - F0 has of stress(F) - stress(F0): linear in the part."""
        mean = 0.5 * (F + F0)
        J, J0 = np.linalg.det(F), np.linalg.det(F0)
        grown = np.einsum("pij,cpij->cp", cofactor(mean), parts)  # J - J0
        relative = (J - J0) / J0
        secant = np.where(relative == 0, 1.0, np.log1p(relative) / np.where(relative == 0, 1.0, relative)) / J0
        if not self.at_rest:
            product = parts @ mean.swapaxes(1, 2)
            return self.shear * (product + product.swapaxes(2, 3)) \
                + self.bulk * (secant * grown)[:, :, None, None] * np.eye(2)
        before, after = ((self.bulk * np.log(j) - self.shear) / j for j in (J0, J))
        # (a ln J - m)/J is a product of a ln J - m and 1/J, with their secants
        slope = self.bulk * secant * 0.5 * (1 / J + 1 / J0) \
            - (self.bulk * 0.5 * (np.log(J) + np.log(J0)) - self.shear) / (J * J0)
        return self.shear * parts + (0.5 * (before + after))[:, None, None] * cofactor(parts) \
            + (slope * grown)[:, :, None, None] * cofactor(mean)


def cofactor(F: np.ndarray) -> np.ndarray:
    """J F^-T of tensors (..., 2, 2): linear in F."""
    return np.stack([F[..., 1, 1], -F[..., 1, 0], -F[..., 0, 1], F[..., 0, 0]], axis=-1).reshape(F.shape)
