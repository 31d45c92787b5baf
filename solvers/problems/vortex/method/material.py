"""What the vortex is made of and what pushes it: stress and body force of a particle."""

import taichi as ti

from solvers.kernels.elementary import cos, log, sin
from solvers.problems.vortex.exact import SECOND_FREQUENCY, SECOND_SIZE

FAR, TERMS = 1 / 7, 9  # |J-1|/|J+1| up to which so many terms give ln J to rounding: J from 3/4 to 4/3
FLATTEST = 1e-300  # det F below which its logarithm is not asked for: the run is at its end


@ti.func
def determinant(F):
    return F[0] * F[3] - F[1] * F[2]


@ti.func
def kirchhoff_stress(vortex: ti.template(), p):
    """J sigma = lambda ln J I + mu (F F^T - I) as (xx, xy, yy): neo-Hookean."""
    F = vortex.deformation_gradient[p]
    mu, bulk = vortex.shear_modulus, vortex.lame_modulus * log(ti.max(determinant(F), FLATTEST))
    return ti.Vector([mu * (F[0] * F[0] + F[1] * F[1] - 1) + bulk, mu * (F[0] * F[2] + F[1] * F[3]),
                      mu * (F[2] * F[2] + F[3] * F[3] - 1) + bulk])


@ti.func
def cauchy_stress(vortex: ti.template(), p):
    """sigma as (xx, xy, yy)."""
    return kirchhoff_stress(vortex, p) / determinant(vortex.deformation_gradient[p])


@ti.func
def prepare(vortex: ti.template(), start, end):
    """Find lambda ln J of the particles from ``start`` to ``end``: in a loop of its own, for a call of the logarithm
    among the sums at the nodes would cost a third of the step. Of four particles at a time, for a processor does sums
    and products of so many at once; the last one is found again where there are not four.
    """
    for group in range((end - start + 3) // 4):
        J, first = ti.Vector([0.0] * 4), start + 4 * group
        for k in ti.static(range(4)):
            J[k] = determinant(vortex.deformation_gradient[ti.min(first + k, end - 1)])
        logarithm = logarithms(J)
        for k in ti.static(range(4)):
            vortex.volumetric[ti.min(first + k, end - 1)] = vortex.lame_modulus * logarithm[k]


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


@ti.func
def stress(vortex: ti.template(), p, on: ti.template()):
    """J sigma as (xx, xy, yx, yy), or P = mu F + (lambda ln J - mu) F^-T where the weights stay those of rest."""
    F, mu, volumetric = vortex.deformation_gradient[p], vortex.shear_modulus, vortex.volumetric[p]
    shear = mu * (F[0] * F[2] + F[1] * F[3])
    full = ti.Vector([mu * (F[0] * F[0] + F[1] * F[1] - 1) + volumetric, shear, shear,
                      mu * (F[2] * F[2] + F[3] * F[3] - 1) + volumetric])
    if ti.static(on.frozen):
        back = (volumetric - mu) / determinant(F)
        full = mu * F + back * ti.Vector([F[3], -F[2], -F[1], F[0]])
    return full


@ti.func
def force_at(vortex: ti.template(), known, t, on: ti.template()):
    """The body force per mass at time t, along e_R and e_Theta of the particle at rest, where ``known`` is
    (R, h, h', h'') of its circle.

    For "material" see ``solvers.problems.vortex.exact.polar_force``, whose frame has turned by alpha. "two-tone" adds
    w^2 A/2 R h sin(1.7 wt) around the ring, for which no exact solution is built in.
    """
    R, w, mu = known[0], vortex.angular_frequency, vortex.shear_modulus / vortex.density
    g = vortex.amplitude * sin(w * t)
    rate = vortex.amplitude * w * cos(w * t) * known[1]
    alpha, slope, curvature = g * known[1], g * known[2], g * known[3]
    along = R * (mu * slope * slope - rate * rate)
    around = -w * w * R * alpha - mu * (3 * slope + R * curvature)
    if ti.static(on.body_force == "two-tone"):
        around += SECOND_SIZE * w * w * vortex.amplitude * R * known[1] * sin(SECOND_FREQUENCY * w * t)
    c, s = cos(alpha), sin(alpha)
    return ti.Vector([c * along - s * around, s * along + c * around])


@ti.func
def forces(vortex: ti.template(), t, on: ti.template()):
    """The body force per mass on every circle that has a particle."""
    if ti.static(on.body_force != "none"):
        for k in range(vortex.radius_count):
            vortex.polar_force[k] = force_at(vortex, vortex.radii[k], t, on)


@ti.func
def body_force_on(vortex: ti.template(), p):
    """The body force on a particle, in N."""
    f, e = vortex.polar_force[vortex.radius[p]], vortex.direction[p]
    return vortex.mass[p] * ti.Vector([f[0] * e[0] - f[1] * e[1], f[0] * e[1] + f[1] * e[0]])


@ti.func
def tangent(vortex: ti.template(), p, on: ti.template()):
    """V0, and the metric mu b + (lambda + mu - lambda ln J) I with b = F F^T; with frozen weights
    mu I + (lambda + mu - lambda ln J) C^-1. See ``solvers.problems.vortex.step_bound``."""
    mu, lam, F = vortex.shear_modulus, vortex.lame_modulus, vortex.deformation_gradient[p]
    J = determinant(F)
    rest = lam + mu - lam * log(ti.max(J, FLATTEST))
    metric = mu * ti.Vector([F[0] * F[0] + F[1] * F[1], F[0] * F[2] + F[1] * F[3], F[2] * F[2] + F[3] * F[3]]) \
        + rest * ti.Vector([1.0, 0.0, 1.0])
    if ti.static(on.frozen):
        per = rest / (J * J)
        metric = mu * ti.Vector([1.0, 0.0, 1.0]) + per * ti.Vector([
            F[1] * F[1] + F[3] * F[3], -F[0] * F[1] - F[2] * F[3], F[0] * F[0] + F[2] * F[2]])
    return vortex.mass[p] / vortex.density, metric
