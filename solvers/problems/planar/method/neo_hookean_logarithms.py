"""Kernels of the neo-Hookean law beside its formulas: the logarithms of several particles at a time."""

import taichi as ti

from solvers.problems.planar.method.material_laws import determinant, log_jacobian

FAR, TERMS = 1 / 7, 9  # |J-1|/|J+1| up to which so many terms give ln J to rounding: J from 3/4 to 4/3


@ti.func
def compute_volumetric_stress(body: ti.template(), start, end):
    """Writes lambda ln J in Pa of the particles from ``start`` up to ``end`` to ``volumetric``, in a loop of its own:
    logarithms within the sums at the nodes would cost a third of the step. It takes four particles at a time, to use
    vector instructions; where fewer are left, the last one is computed repeatedly."""
    for group in range((end - start + 3) // 4):
        J, first = ti.Vector([0.0] * 4), start + 4 * group
        for k in ti.static(range(4)):
            J[k] = determinant(body.deformation_gradient[ti.min(first + k, end - 1)])
        logarithm = logarithms(J)
        for k in ti.static(range(4)):
            body.volumetric[ti.min(first + k, end - 1)] = body.lame_modulus * logarithm[k]


@ti.func
def logarithms(J):
    """Returns ln J of a vector of four J: near 1, as in sound runs, by the series of 2 artanh((J-1)/(J+1)), exactly."""
    s = (J - 1) / (J + 1)
    square, series = s * s, ti.Vector([0.0] * 4)
    for k in ti.static(range(TERMS)):
        series = series * square + 1 / (2 * (TERMS - k) - 1)
    logarithm = 2 * s * series
    if not square.max() <= FAR * FAR:  # true for NaN too
        for k in ti.static(range(4)):
            logarithm[k] = log_jacobian(J[k])
    return logarithm
