"""The material for kernels: the formulas of ``solvers.motion.laws``, of the law that a scene's switches name.

A body has ``shear_modulus`` mu, ``lame_modulus`` lambda and, found once a step where the law needs it, ``volumetric`` =
lambda ln J (P,); but where lambda is 0 by the problem, :func:`stress` is made without it.
"""

from collections.abc import Callable
from types import FunctionType

import taichi as ti

from solvers.kernels.elementary import log
from solvers.motion.laws import law
from solvers.motion.laws.material import LAWS as IN_NUMPY

FLATTEST = 1e-300  # det F below which its logarithm is not asked for: the run is at its end


def for_kernels(formula: FunctionType) -> Callable:
    """The same function without annotations, which Taichi would read."""
    return ti.func(FunctionType(formula.__code__, formula.__globals__, formula.__name__))


LAWS = {name: one._replace(energy=for_kernels(one.energy), coefficients=for_kernels(one.coefficients))
        for name, one in IN_NUMPY.items()}
determinant, piola, kirchhoff, metric, material_metric, stiffness = map(for_kernels, (
    law.determinant, law.piola, law.kirchhoff, law.metric, law.material_metric, law.stiffness))


@ti.func
def growth(J):
    """ln J."""
    return log(ti.max(J, FLATTEST))


@ti.func
def coefficients(body: ti.template(), F, on: ti.template()):
    """J, q, r, A, x, of F as (xx, xy, yx, yy) in the body's material."""
    J, volumetric = determinant(F), 0.0
    if ti.static(LAWS[on.law].logarithmic):
        if body.lame_modulus != 0:  # a logarithm a particle is a tenth of some estimator's time
            volumetric = body.lame_modulus * growth(J)
    q, r, A, x = LAWS[on.law].coefficients(F, J, volumetric, body.lame_modulus, body.shear_modulus)
    return J, q, r, A, x


@ti.func
def cauchy_stress_of(body: ti.template(), F, on: ti.template()):
    """sigma as (xx, xy, yy), of F as (xx, xy, yx, yy) in the body's material."""
    J, q, r, _, _ = coefficients(body, F, on)
    xx, xy, yy = kirchhoff(F, q, r)
    return ti.Vector([xx, xy, yy]) / J


@ti.func
def cauchy_stress(body: ti.template(), p, on: ti.template()):
    """The same of particle p."""
    return cauchy_stress_of(body, body.deformation_gradient[p], on)


def stress_of(volumetric: bool) -> Callable:
    """The stress of a step, as a function for kernels, of bodies whose lambda may be other than 0, or is 0."""
    @ti.func
    def stress(body: ti.template(), p, on: ti.template()):
        """J sigma as (xx, xy, yx, yy), or P where the weights stay those of rest."""
        F, bulk, full = body.deformation_gradient[p], 0.0, ti.Vector([0.0] * 4)
        if ti.static(volumetric and LAWS[on.law].logarithmic):
            bulk = body.volumetric[p]
        J = determinant(F)
        q, r, _, _ = LAWS[on.law].coefficients(F, J, bulk, body.lame_modulus, body.shear_modulus)
        if ti.static(on.frozen):
            full[0], full[1], full[2], full[3] = piola(F, q, (r - q) / J)
        else:
            full[0], full[1], full[3] = kirchhoff(F, q, r)
            full[2] = full[1]
        return full

    return stress


@ti.func
def tangent(body: ti.template(), p, on: ti.template()):
    """V0, and the metric for the gradients of weights, in space or, where they stay those of rest, in the material."""
    F = body.deformation_gradient[p]
    J, q, r, A, x = coefficients(body, F, on)
    xx, xy, yy = ti.static(material_metric if on.frozen else metric)(F, J, q, r, A, x)
    return body.mass[p] / body.density, ti.Vector([xx, xy, yy])


@ti.func
def strain_energy(body: ti.template(), p, on: ti.template()):
    """Of a particle, in J."""
    F, logarithm = body.deformation_gradient[p], 0.0
    J = determinant(F)
    if ti.static(LAWS[on.law].logarithmic):
        logarithm = growth(J)
    return body.mass[p] / body.density * LAWS[on.law].energy(F, J, logarithm, body.lame_modulus, body.shear_modulus)
