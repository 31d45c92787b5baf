"""The compressible neo-Hookean law in plane strain, W = mu/2 (F:F - 2 - 2 ln J) + lambda/2 (ln J)^2.

Source: Bonet & Wood, Nonlinear Continuum Mechanics, 2nd ed., Cambridge 2008, section 6.4.3.
"""

from typing import Any

from solvers.motion.laws.material_law import MaterialLaw


def energy(F: Any, growth: Any, log_J: Any, bulk: Any, mu: Any) -> Any:
    """Returns W in J per m^3 at rest, of ``F`` (xx, xy, yx, yy), det F - 1 and ln J; ``bulk`` is lambda in Pa.
    F:F - 2 is (F_xx - F_yy)^2 + (F_xy + F_yx)^2 + 2 (J - 1): as a difference W of small strains would be rounding."""
    stretch, shear = F[0] - F[3], F[1] + F[2]
    return mu * (0.5 * (stretch * stretch + shear * shear) + (growth - log_J)) + 0.5 * bulk * log_J * log_J


def coefficients(F: Any, J: Any, volumetric: Any, bulk: Any, mu: Any) -> Any:
    """Returns q, r, A, x of ``laws.material_law`` in Pa; ``volumetric`` is lambda ln J, ``bulk`` lambda in Pa."""
    return mu, volumetric, 0.0, bulk


LAW = MaterialLaw("neo-hookean", r"Neo-Hookean: $\sigma = \frac{\lambda \ln J}{J} I + \frac{\mu}{J}(F F^T - I)$, "
                  r"$P = \mu F + (\lambda \ln J - \mu) F^{-T}$", energy, coefficients, logarithmic=True)
