"""Difference of two stresses as an exact sum over parts of the difference of their F, however large it is.

In two dimensions F:F, det F and F F^T are quadratic in F: the difference of one between F and F0 is linear in F - F0,
with coefficients at the mean of the two. What a law makes of F:F and of J is divided by its secants.
"""

from typing import NamedTuple

import numpy as np

from solvers.motion.laws.elastic_material import ElasticMaterial

PLACES, SHARES = np.polynomial.legendre.leggauss(10)  # a secant is a mean of slopes: to rounding up to J/J0 = 2


class StressDifference(NamedTuple):
    """Differences of a material's J sigma in Pa; ``at_rest``, for frozen weights, of its first Piola-Kirchhoff P."""

    material: ElasticMaterial
    at_rest: bool

    def stress(self, F: np.ndarray) -> np.ndarray:
        """Returns J sigma, or P if ``at_rest``, (P, 2, 2) in Pa, of deformation gradients ``F`` (P, 2, 2)."""
        P = np.stack(self.material.first_piola_stress(F.reshape(-1, 4).T), axis=1).reshape(-1, 2, 2)
        return P if self.at_rest else P @ F.swapaxes(1, 2)

    def split_difference(self, F: np.ndarray, F0: np.ndarray, parts: np.ndarray) -> np.ndarray:
        """Returns what each of C ``parts`` (C, P, 2, 2) of F - F0 adds, linearly, to stress(F) - stress(F0), in Pa."""
        mean, J, J0 = 0.5 * (F + F0), np.linalg.det(F), np.linalg.det(F0)
        q, k, A, _ = (0.5 * (one + other) for one,
                      other in zip(self._stress_coefficients(F, J), self._stress_coefficients(F0, J0), strict=True))
        slope = sum(share * self._stress_coefficients(F, 0.5 * (J + J0 + place * (J - J0)))[3]
                    for place, share in zip(PLACES, 0.5 * SHARES, strict=True))
        of_q, grown = (np.einsum("pij,cpij->cp", one, parts)[:, :, None, None] for one in (mean, cofactor(mean)))
        of_q, of_k = A * of_q, slope * grown
        if self.at_rest:
            return q * parts + k * cofactor(parts) + of_q * mean + of_k * cofactor(mean)
        product, b = parts @ mean.swapaxes(1, 2), 0.5 * (F @ F.swapaxes(1, 2) + F0 @ F0.swapaxes(1, 2))
        return q * (product + product.swapaxes(2, 3)) + of_q * b \
            + (k * grown + 0.5 * (J + J0)[:, None, None] * of_k) * np.eye(2)

    def _stress_coefficients(self, F: np.ndarray, J: np.ndarray) -> list[np.ndarray]:
        """Returns the coefficients q, k of P = q F + k cof F, A, which is twice the slope of q with F:F, and the slope
        of k with J, each (P, 1, 1)."""
        q, r, A, x = self.material.coefficients(F.reshape(-1, 4).T, J)
        k = (r - q) / J
        return [np.broadcast_to(one, J.shape)[:, None, None] for one in (q, k, A, (x / J - k) / J)]


def cofactor(F: np.ndarray) -> np.ndarray:
    """Returns the cofactors J F^-T of tensors ``F`` (..., 2, 2), of the same shape: linear in F."""
    return np.stack([F[..., 1, 1], -F[..., 1, 0], -F[..., 0, 1], F[..., 0, 0]], axis=-1).reshape(F.shape)
