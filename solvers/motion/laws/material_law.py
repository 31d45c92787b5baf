"""Interface of a material law in the plane, and the formulas that follow from any law, for any kind of number.

In two dimensions an isotropic hyperelastic law is an energy of F:F and J; here W = f(F:F) + g(J). With b = F F^T,
J F^-T, which is linear in F, and L = dF F^-1 for a change of F,

    P = q F + (r - q) F^-T,    J sigma = q (b - I) + r I,    q = 2 f',  r = q + J g',
    dP F^T = q L b + (q - r) L^T + x tr L I + A (b:L) b,     A = 4 f'',  x = J (J g')',

and waves along N in the material have the stiffnesses of q I + A (F N)(F N)^T + (x + q - r) (F^-T N)(F^-T N)^T. F and L
are (xx, xy, yx, yy), symmetric tensors (xx, xy, yy), in numpy (``solvers.motion.laws.elastic_material``) or kernels.
"""

from collections.abc import Callable
from typing import Any, NamedTuple


class MaterialLaw(NamedTuple):
    """Law of elasticity in the plane: name, ``text`` with TeX, and functions of F, J and moduli lambda, mu in Pa."""

    name: str
    text: str
    energy: Callable[..., Any]  # (F, J - 1, ln J, lambda, mu) -> W per reference volume
    coefficients: Callable[..., Any]  # (F, J, lambda ln J, lambda, mu) -> q, r, A, x
    logarithmic: bool  # whether ln J is in it, which costs; others are given anything


def determinant(F: Any) -> Any:
    """Returns J = det F of ``F`` as (xx, xy, yx, yy)."""
    return F[0] * F[3] - F[1] * F[2]


def volume_growth(F: Any) -> Any:
    """Returns det F - 1 of ``F`` as (xx, xy, yx, yy), accurate where F is near the identity."""
    xx, yy = F[0] - 1, F[3] - 1
    return xx + yy + (xx * yy - F[1] * F[2])


def piola(F: Any, q: Any, k: Any) -> Any:
    """Returns the first Piola-Kirchhoff stress in Pa as (xx, xy, yx, yy), like ``F``; k = (r - q)/J, in Pa like q."""
    return q * F[0] + k * F[3], q * F[1] - k * F[2], q * F[2] - k * F[1], q * F[3] + k * F[0]


def kirchhoff(F: Any, q: Any, r: Any) -> Any:
    """Returns the Kirchhoff stress J sigma as (xx, xy, yy) in Pa of ``F`` as (xx, xy, yx, yy), from q and r in Pa."""
    return (q * (F[0] * F[0] + F[1] * F[1] - 1) + r, q * (F[0] * F[2] + F[1] * F[3]),
            q * (F[2] * F[2] + F[3] * F[3] - 1) + r)


def stress_increment(L: Any, b: Any, q: Any, r: Any, A: Any, x: Any) -> Any:
    """Returns dP F^T (xx, xy, yx, yy) in Pa of L = dF F^-1, likewise, and b = F F^T (xx, xy, yy); q to x in Pa."""
    trace, grown = x * (L[0] + L[3]), A * (L[0] * b[0] + (L[1] + L[2]) * b[1] + L[3] * b[2])
    return (q * (L[0] * b[0] + L[1] * b[1]) + trace + (q - r) * L[0] + grown * b[0],
            q * (L[0] * b[1] + L[1] * b[2]) + (q - r) * L[2] + grown * b[1],
            q * (L[2] * b[0] + L[3] * b[1]) + (q - r) * L[1] + grown * b[1],
            q * (L[2] * b[1] + L[3] * b[2]) + trace + (q - r) * L[3] + grown * b[2])


def stiffness_metric(F: Any, J: Any, q: Any, r: Any, A: Any, x: Any) -> Any:
    """Returns M = q b + A b^2 + (x + q - r) I as (xx, xy, yy) in Pa, of ``F`` (xx, xy, yx, yy) and b = F F^T: the
    stiffness between nodes whose weights have gradients g and h in space is bounded by the product of their sizes in M.
    By Cayley and Hamilton b^2 = (F:F) b - J^2 I."""
    xx, xy, yy = F[0] * F[0] + F[1] * F[1], F[0] * F[2] + F[1] * F[3], F[2] * F[2] + F[3] * F[3]
    of_b, rest = q + A * (xx + yy), x + q - r - A * J * J
    return of_b * xx + rest, of_b * xy, of_b * yy + rest


def reference_stiffness_metric(F: Any, J: Any, q: Any, r: Any, A: Any, x: Any) -> Any:
    """Returns F^-1 M F^-T = q I + A C + (x + q - r) C^-1 as (xx, xy, yy) in Pa, C = F^T F: M for gradients at rest."""
    xx, xy, yy = F[0] * F[0] + F[2] * F[2], F[0] * F[1] + F[2] * F[3], F[1] * F[1] + F[3] * F[3]
    per = (x + q - r) / (J * J)
    return q + A * xx + per * yy, (A - per) * xy, q + A * yy + per * xx


def wave_stiffness(q: Any, r: Any, A: Any, x: Any, stretched: Any, pressed: Any) -> Any:
    """Returns the stiffness in Pa of waves along a principal axis N that move along F N, from |F N|^2, |F^-T N|^2."""
    return q + A * stretched + (x + q - r) * pressed
