"""Material laws in kernels: the formulas of ``solvers.motion.laws``, for the law in a scene's compile-time options.

A body has ``shear_modulus`` mu and ``lame_modulus`` lambda.
"""

from collections.abc import Callable
from types import FunctionType

import taichi as ti

from solvers.kernels.elementary_functions import log
from solvers.motion.laws import material_law
from solvers.motion.laws.elastic_material import LAWS as IN_NUMPY

MIN_LOG_JACOBIAN = 1e-300  # least det F whose logarithm is taken: the run is unstable


def strip_annotations(formula: FunctionType) -> Callable:
    """Returns the Taichi function of a ``formula`` in Python, without its annotations, which Taichi would read."""
    return ti.func(FunctionType(formula.__code__, formula.__globals__, formula.__name__))


LAWS = {name: one._replace(energy=strip_annotations(one.energy), coefficients=strip_annotations(one.coefficients))
        for name, one in IN_NUMPY.items()}
determinant, volume_growth, piola, kirchhoff, stiffness_metric, reference_stiffness_metric, wave_stiffness = map(
    strip_annotations, (material_law.determinant, material_law.volume_growth, material_law.piola,
                        material_law.kirchhoff, material_law.stiffness_metric,
                        material_law.reference_stiffness_metric, material_law.wave_stiffness))


@ti.func
def log_jacobian(J):
    """Returns ln J, for J = det F of at least ``MIN_LOG_JACOBIAN``."""
    return log(ti.max(J, MIN_LOG_JACOBIAN))


@ti.func
def coefficients(body: ti.template(), F, on: ti.template()):
    """Returns J and the law's coefficients q, r, A, x in Pa (``laws.material_law``) for F as (xx, xy, yx, yy)."""
    J, volumetric = determinant(F), 0.0
    if ti.static(LAWS[on.law].logarithmic):
        if body.lame_modulus != 0:  # a logarithm a particle is a tenth of some estimator's time
            volumetric = body.lame_modulus * log_jacobian(J)
    q, r, A, x = LAWS[on.law].coefficients(F, J, volumetric, body.lame_modulus, body.shear_modulus)
    return J, q, r, A, x


@ti.func
def cauchy_stress_of(body: ti.template(), F, on: ti.template()):
    """Returns the Cauchy stress as (xx, xy, yy) in Pa, for F as (xx, xy, yx, yy) in the body's material."""
    J, q, r, _, _ = coefficients(body, F, on)
    xx, xy, yy = kirchhoff(F, q, r)
    return ti.Vector([xx, xy, yy]) / J


@ti.func
def cauchy_stress(body: ti.template(), p, on: ti.template()):
    """Returns the Cauchy stress of particle p as (xx, xy, yy) in Pa."""
    return cauchy_stress_of(body, body.deformation_gradient[p], on)


@ti.func
def volume_and_stiffness_metric(body: ti.template(), p, on: ti.template()):
    """Returns for the step margin V0 of particle p in m^2 and a metric (xx, xy, yy) in Pa. The product of two nodes'
    weight gradients in it bounds the stiffness between them: gradients in space, or at rest with frozen weights."""
    F = body.deformation_gradient[p]
    J, q, r, A, x = coefficients(body, F, on)
    xx, xy, yy = ti.static(reference_stiffness_metric if on.frozen else stiffness_metric)(F, J, q, r, A, x)
    return body.mass[p] / body.density, ti.Vector([xx, xy, yy])


@ti.func
def strain_energy(body: ti.template(), p, on: ti.template()):
    """Returns the strain energy of particle p, in J per metre of thickness."""
    F = body.deformation_gradient[p]
    growth = volume_growth(F)
    J, log_J = 1 + growth, growth
    if J != 1:
        log_J = log_jacobian(J) * (growth / (J - 1))  # the rounding of 1 + growth cancels
    return body.mass[p] / body.density * LAWS[on.law].energy(F, growth, log_J, body.lame_modulus, body.shear_modulus)
