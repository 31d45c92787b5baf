"""The compressible neo-Hookean law in plane strain, of any kind of number.

Strain energy per reference volume W = mu/2 (F:F - 2 - 2 ln J) + lambda/2 (ln J)^2, so that P = mu F +
(lambda ln J - mu) F^-T and J sigma = mu (F F^T - I) + lambda ln J I. F is given as (F_xx, F_xy, F_yx, F_yy): arrays
(P,), or jets.
Source: Bonet & Wood, Nonlinear Continuum Mechanics, 2nd ed., Cambridge 2008, section 6.4.3.
"""

from collections.abc import Iterable
from typing import Any

from solvers.motion.jets import log


def first_piola_stress(F: Iterable[Any], lame_lambda: float, mu: float) -> tuple[Any, Any, Any, Any]:
    """P_xx, P_xy, P_yx, P_yy in the unit of the moduli."""
    xx, xy, yx, yy = F
    J = xx * yy - xy * yx
    across = -mu / J if lame_lambda == 0 else (lame_lambda * log(J) - mu) / J
    return mu * xx + across * yy, mu * xy - across * yx, mu * yx - across * xy, mu * yy + across * xx


def cauchy_stress(F: Iterable[Any], lame_lambda: float, mu: float) -> tuple[Any, Any, Any]:
    """sigma_xx, sigma_xy, sigma_yy in the unit of the moduli."""
    xx, xy, yx, yy = F
    J = xx * yy - xy * yx
    pressure, scale = lame_lambda * log(J) / J, mu / J
    return (scale * (xx * xx + xy * xy - 1) + pressure, scale * (xx * yx + xy * yy),
            scale * (yx * yx + yy * yy - 1) + pressure)


def strain_energy(F: Iterable[Any], lame_lambda: float, mu: float) -> Any:
    """W per reference volume in J/m^3, where the moduli are in Pa."""
    xx, xy, yx, yy = F
    growth = log(xx * yy - xy * yx)
    return 0.5 * mu * (xx * xx + xy * xy + yx * yx + yy * yy - 2 - 2 * growth) + 0.5 * lame_lambda * growth * growth
