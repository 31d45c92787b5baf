"""Material in the plane, in numpy: a law with its moduli."""

from typing import Any, NamedTuple

import numpy as np

from solvers.motion.jets import log
from solvers.motion.laws import neo_hookean, st_venant_kirchhoff
from solvers.motion.laws.material_law import MaterialLaw, determinant, kirchhoff, piola, wave_stiffness

LAWS: dict[str, MaterialLaw] = {one.LAW.name: one.LAW for one in (neo_hookean, st_venant_kirchhoff)}
NEO_HOOKEAN = neo_hookean.LAW.name
ANGLES = np.linspace(0, np.pi, 24, endpoint=False)[:, None]  # of directions of waves


class ElasticMaterial(NamedTuple):
    """Elastic material in the plane: law and moduli in Pa. F is (xx, xy, yx, yy), arrays (P,) or jets."""

    law: MaterialLaw
    bulk: float  # lambda
    mu: float

    def coefficients(self, F: Any, J: Any) -> tuple[Any, Any, Any, Any]:
        """Returns q, r, A, x of ``solvers.motion.laws.material_law`` in Pa; J may differ from det F."""
        volumetric = self.bulk * log(J) if self.law.logarithmic and self.bulk != 0 else 0.0
        return self.law.coefficients(F, J, volumetric, self.bulk, self.mu)

    def first_piola_stress(self, F: Any) -> tuple[Any, Any, Any, Any]:
        """Returns P_xx, P_xy, P_yx, P_yy in Pa of ``F`` as (xx, xy, yx, yy), each an array (P,) or a jet."""
        J = determinant(F)
        q, r, *_ = self.coefficients(F, J)
        return piola(F, q, (r - q) / J)

    def cauchy_stress(self, F: Any) -> tuple[Any, Any, Any]:
        """Returns sigma_xx, sigma_xy, sigma_yy in Pa of ``F`` as (xx, xy, yx, yy), each an array (P,) or a jet."""
        J = determinant(F)
        xx, xy, yy = kirchhoff(F, *self.coefficients(F, J)[:2])
        return xx / J, xy / J, yy / J

    def max_frequency_factor(self, F: Any, stretched: Any, pressed: Any) -> Any:
        """Returns the largest factor, at least 1, by which ``F`` raises frequencies of waves along a principal axis N:
        the root of their stiffness over that at rest. ``stretched`` is |F N|^2, ``pressed`` |F^-T N|^2, arrays (P,)."""
        found = wave_stiffness(*self.coefficients(F, determinant(F)), stretched, pressed)
        return max(1.0, float(np.max(found)) / (self.bulk + 2 * self.mu)) ** 0.5

    def least_wave_stiffness(self, F: np.ndarray) -> float:
        """Returns the smallest stiffness of waves in any direction, over mu, of ``F`` (4, P): xx, xy, yx, yy. Where it
        is not above 0 the law is not elliptic, and the shorter a wave, the faster it grows."""
        c, s, J = np.cos(ANGLES), np.sin(ANGLES), determinant(F)
        q, r, A, x = self.coefficients(F, J)
        rest, along = (x + q - r) / (J * J), (F[0] * c + F[1] * s, F[2] * c + F[3] * s)
        normal = F[3] * c - F[2] * s, F[0] * s - F[1] * c
        xx, xy, yy = (A * along[i] * along[j] + rest * normal[i] * normal[j] for i, j in ((0, 0), (0, 1), (1, 1)))
        return float((q + 0.5 * (xx + yy) - np.hypot(0.5 * (xx - yy), xy)).min()) / self.mu
