"""What the ring is made of and what pushes it: stress and body force of a particle."""

import taichi as ti


@ti.func
def kirchhoff_stress(ring: ti.template(), p):
    """J sigma = mu (F F^T - I) as (xx, xy, yy): the paper's eq 37 with its misprint mended, for nu = 0."""
    F = ring.deformation_gradient[p]
    mu = ring.shear_modulus
    return ti.Vector([mu * (F[0] * F[0] + F[1] * F[1] - 1), mu * (F[0] * F[2] + F[1] * F[3]),
                      mu * (F[2] * F[2] + F[3] * F[3] - 1)])


@ti.func
def radial_forces(ring: ti.template(), t, on: ti.template()):
    """The manufactured body force per mass at every material radius (see ``solvers.ring.exact.body_force``)."""
    if ti.static(on.body_force):
        T = ring.amplitude * ti.sin(ring.angular_frequency * t)
        mu, w = ring.shear_modulus, ring.angular_frequency
        for k in range(ring.radius_count):
            per_R = 1 / ring.radii[k]
            radial = 1 + T * ring.shape_slope[k]
            hoop = 1 + T * ring.shape[k] * per_R
            per_radial = 1 / radial
            difference = mu * (radial - per_radial - hoop + 1 / hoop)
            bending = mu * (1 + per_radial * per_radial) * T * ring.shape_curvature[k]
            ring.radial_force[k] = -w * w * T * ring.shape[k] - (bending + difference * per_R) / ring.density


@ti.func
def force_moment(ring: ti.template(), p, on: ti.template()):
    """What a particle gives to nodes: a node record by weight, V sigma = (xx, xy, yy) by gradient of the weight."""
    q, mass = ring.motion[p], ring.mass[p]
    push = ti.Vector([0.0, 0.0])
    if ti.static(on.body_force):
        push = mass * ring.radial_force[ring.radius[p]] * ring.direction[p]
    tau = (mass / ring.density) * kirchhoff_stress(ring, p)  # V sigma = V0 J sigma
    return ti.Vector([mass * q[2], mass * q[3], push[0], push[1], mass, 0.0, 0.0, 0.0]), tau


@ti.func
def force_record(x, y):
    """The record of a node on which nothing but a force acts."""
    return ti.Vector([0.0, 0.0, x, y, 0.0, 0.0, 0.0, 0.0])
