"""The neo-Hookean law for kernels, whose formulas ``solvers.motion.neo_hookean`` has for numpy.

A body has ``shear_modulus`` mu, ``lame_modulus`` lambda and, found once a step, ``volumetric`` = lambda ln J (P,); but
where lambda is 0 by the problem, :func:`stress` is made without it.
"""

from collections.abc import Callable

import taichi as ti

from solvers.kernels.elementary import log

FAR, TERMS = 1 / 7, 9  # |J-1|/|J+1| up to which so many terms give ln J to rounding: J from 3/4 to 4/3
FLATTEST = 1e-300  # det F below which its logarithm is not asked for: the run is at its end


@ti.func
def determinant(F):
    return F[0] * F[3] - F[1] * F[2]


@ti.func
def cauchy_stress_of(body: ti.template(), F):
    """sigma = [lambda ln J I + mu (F F^T - I)]/J as (xx, xy, yy), of F as (xx, xy, yx, yy) in the body's material."""
    J = determinant(F)
    mu, bulk = body.shear_modulus, body.lame_modulus * log(ti.max(J, FLATTEST))
    return ti.Vector([mu * (F[0] * F[0] + F[1] * F[1] - 1) + bulk, mu * (F[0] * F[2] + F[1] * F[3]),
                      mu * (F[2] * F[2] + F[3] * F[3] - 1) + bulk]) / J


@ti.func
def cauchy_stress(body: ti.template(), p):
    """The same of particle p."""
    return cauchy_stress_of(body, body.deformation_gradient[p])


@ti.func
def find_volumetric(body: ti.template(), start, end):
    """Find lambda ln J of the particles from ``start`` to ``end``: in a loop of its own, for a call of the logarithm
    among the sums at the nodes would cost a third of the step. Of four particles at a time, for a processor does sums
    and products of so many at once; the last one is found again where there are not four.
    """
    for group in range((end - start + 3) // 4):
        J, first = ti.Vector([0.0] * 4), start + 4 * group
        for k in ti.static(range(4)):
            J[k] = determinant(body.deformation_gradient[ti.min(first + k, end - 1)])
        logarithm = logarithms(J)
        for k in ti.static(range(4)):
            body.volumetric[ti.min(first + k, end - 1)] = body.lame_modulus * logarithm[k]


@ti.func
def logarithms(J):
    """ln of four numbers: near 1, where a sound run has its J, by the series of 2 artanh((J-1)/(J+1)), to rounding."""
    s = (J - 1) / (J + 1)
    square, series = s * s, ti.Vector([0.0] * 4)
    for k in ti.static(range(TERMS)):
        series = series * square + 1 / (2 * (TERMS - k) - 1)
    logarithm = 2 * s * series
    if not square.max() <= FAR * FAR:  # true for NaN too
        for k in ti.static(range(4)):
            logarithm[k] = log(ti.max(J[k], FLATTEST))
    return logarithm


def stress_of(volumetric: bool) -> Callable:
    """The stress of a step, as a function for kernels, of bodies whose lambda may be other than 0, or is 0."""
    @ti.func
    def stress(body: ti.template(), p, on: ti.template()):
        """J sigma as (xx, xy, yx, yy), or P = mu F + (lambda ln J - mu) F^-T where the weights stay those of rest."""
        F, mu = body.deformation_gradient[p], body.shear_modulus
        shear = mu * (F[0] * F[2] + F[1] * F[3])
        full = ti.Vector([mu * (F[0] * F[0] + F[1] * F[1] - 1), shear, shear, mu * (F[2] * F[2] + F[3] * F[3] - 1)])
        back = -mu
        if ti.static(volumetric):
            bulk = body.volumetric[p]
            full, back = full + ti.Vector([bulk, 0.0, 0.0, bulk]), bulk - mu
        if ti.static(on.frozen):
            full = mu * F + back / determinant(F) * ti.Vector([F[3], -F[2], -F[1], F[0]])
        return full

    return stress


@ti.func
def tangent(body: ti.template(), p, on: ti.template()):
    """V0, and the metric mu b + (lambda + mu - lambda ln J) I with b = F F^T; with frozen weights
    mu I + (lambda + mu - lambda ln J) C^-1. See ``solvers.problems.planar.step_bound``."""
    mu, lam, F = body.shear_modulus, body.lame_modulus, body.deformation_gradient[p]
    J = determinant(F)
    rest = lam + mu - lam * log(ti.max(J, FLATTEST))
    metric = mu * ti.Vector([F[0] * F[0] + F[1] * F[1], F[0] * F[2] + F[1] * F[3], F[2] * F[2] + F[3] * F[3]]) \
        + rest * ti.Vector([1.0, 0.0, 1.0])
    if ti.static(on.frozen):
        per = rest / (J * J)
        metric = mu * ti.Vector([1.0, 0.0, 1.0]) + per * ti.Vector([
            F[1] * F[1] + F[3] * F[3], -F[0] * F[1] - F[2] * F[3], F[0] * F[0] + F[2] * F[2]])
    return body.mass[p] / body.density, metric


@ti.func
def strain_energy(body: ti.template(), p):
    """mu/2 (F:F - 2 - 2 ln J) + lambda/2 (ln J)^2 of a particle, in J."""
    F = body.deformation_gradient[p]
    growth = log(ti.max(determinant(F), FLATTEST))
    return 0.5 * body.mass[p] / body.density * (body.shear_modulus * (
        F[0] * F[0] + F[1] * F[1] + F[2] * F[2] + F[3] * F[3] - 2 - 2 * growth) + body.lame_modulus * growth * growth)
