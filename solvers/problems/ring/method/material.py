"""What the ring is made of and what pushes it: stress and body force of a particle."""

import taichi as ti

from solvers.kernels.elementary import cos, sin
from solvers.problems.ring.exact import INNER, OUTER, SECOND_FREQUENCY, SECOND_SIZE


@ti.func
def kirchhoff_stress(ring: ti.template(), p):
    """J sigma = mu (F F^T - I) as (xx, xy, yy): the paper's eq 37 with its misprint mended, for nu = 0."""
    F = ring.deformation_gradient[p]
    mu = ring.shear_modulus
    return ti.Vector([mu * (F[0] * F[0] + F[1] * F[1] - 1), mu * (F[0] * F[2] + F[1] * F[3]),
                      mu * (F[2] * F[2] + F[3] * F[3] - 1)])


@ti.func
def stress_of(ring: ti.template(), p, on: ti.template()):
    """J sigma as (xx, xy, yx, yy), or P = mu (F - F^-T) where the weights stay those of the material at rest."""
    tau = kirchhoff_stress(ring, p)
    stress = ti.Vector([tau[0], tau[1], tau[1], tau[2]])
    if ti.static(on.frozen):
        F = ring.deformation_gradient[p]
        per_J = 1 / (F[0] * F[3] - F[1] * F[2])
        stress = ring.shear_modulus * (F - per_J * ti.Vector([F[3], -F[2], -F[1], F[0]]))
    return stress


@ti.func
def radial_force_at(ring: ti.template(), known, t, on: ti.template()):
    """The body force per mass at time t where ``known`` is (R, w, w', w''), radius and exact solution.

    For "material" see ``solvers.problems.ring.exact.body_force``. "two-tone" adds w^2 A/2 cos(pi (R - a)/(b - a))
    sin(1.7 wt), for which no exact solution is built in: there an estimate has to stand alone.
    """
    R, shape, slope, curvature = known[0], known[1], known[2], known[3]
    T = ring.amplitude * sin(ring.angular_frequency * t)
    mu, w, per_R = ring.shear_modulus, ring.angular_frequency, 1 / R
    radial = 1 + T * slope
    hoop = 1 + T * shape * per_R
    per_radial = 1 / radial
    difference = mu * (radial - per_radial - hoop + 1 / hoop)
    bending = mu * (1 + per_radial * per_radial) * T * curvature
    force = -w * w * T * shape - (bending + difference * per_R) / ring.density
    if ti.static(on.body_force == "two-tone"):
        across = cos(ti.math.pi * (R - INNER) / (OUTER - INNER))
        force += SECOND_SIZE * w * w * ring.amplitude * across * sin(SECOND_FREQUENCY * w * t)
    return force


@ti.func
def radial_forces(ring: ti.template(), t, on: ti.template()):
    """The body force per mass at every material radius that a particle has."""
    if ti.static(on.body_force != "none"):
        for k in range(ring.radius_count):
            ring.radial_force[k] = radial_force_at(ring, ring.radii[k], t, on)


@ti.func
def body_force_on(ring: ti.template(), p):
    """The body force on a particle, in N."""
    return ring.mass[p] * ring.radial_force[ring.radius[p]] * ring.direction[p]


@ti.func
def tangent(ring: ti.template(), p, on: ti.template()):
    """k V, the same along all directions: mu V0 (1 + the largest eigenvalue of F F^T); for frozen weights that of its
    inverse."""
    F = ring.deformation_gradient[p]
    xx, yy, xy = F[0] * F[0] + F[1] * F[1], F[2] * F[2] + F[3] * F[3], F[0] * F[2] + F[1] * F[3]
    root = ti.sqrt((xx - yy) ** 2 + 4 * xy * xy)
    largest = 0.5 * (xx + yy + root)
    if ti.static(on.frozen):
        J = F[0] * F[3] - F[1] * F[2]
        largest = largest / (J * J)
    return ring.shear_modulus * ring.mass[p] / ring.density * (1 + largest), ti.Vector([1.0, 0.0, 1.0])
