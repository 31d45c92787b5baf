"""The law of St. Venant and Kirchhoff in plane strain, S = lambda tr E I + 2 mu E of Green's strain E = (F^T F - I)/2.

W = lambda/2 (tr E)^2 + mu E:E is lambda/8 (F:F - 2)^2 + mu/4 ((F:F - 1)^2 + 1 - 2 J^2). It softens in compression:
along one axis its stress is largest at a stretch of 1/sqrt(3), and shear waves lose their stiffness sooner.
Source: Holzapfel, Nonlinear Solid Mechanics, Wiley 2000, section 6.5.
"""

from typing import Any

from solvers.motion.laws.material_law import MaterialLaw


def energy(F: Any, growth: Any, log_J: Any, bulk: Any, mu: Any) -> Any:
    """Returns W in J per m^3 at rest, of ``F`` (xx, xy, yx, yy), by E, because F:F - 2 is rounding at small strains;
    ``bulk`` is lambda in Pa, ``growth`` and ``log_J`` are unused."""
    xx, yy = 0.5 * ((F[0] - 1) * (F[0] + 1) + F[2] * F[2]), 0.5 * ((F[3] - 1) * (F[3] + 1) + F[1] * F[1])
    xy = 0.5 * (F[0] * F[1] + F[2] * F[3])
    return 0.5 * bulk * (xx + yy) * (xx + yy) + mu * (xx * xx + yy * yy + 2 * xy * xy)


def coefficients(F: Any, J: Any, volumetric: Any, bulk: Any, mu: Any) -> Any:
    """Returns q, r, A, x of ``laws.material_law`` in Pa; ``bulk`` is lambda in Pa, ``volumetric`` unused."""
    stretched = F[0] * F[0] + F[1] * F[1] + F[2] * F[2] + F[3] * F[3]
    q = 0.5 * bulk * (stretched - 2) + mu * (stretched - 1)
    return q, q - mu * J * J, bulk + 2 * mu, -2 * mu * J * J


LAW = MaterialLaw("st-venant-kirchhoff", r"St. Venant-Kirchhoff: $S = \lambda\,\mathrm{tr}(E) I + 2 \mu E$ with "
                  r"$E = \frac{1}{2}(F^T F - I)$, $P = F S$, $\sigma = \frac{1}{J} P F^T$",
                  energy, coefficients, logarithmic=False)
