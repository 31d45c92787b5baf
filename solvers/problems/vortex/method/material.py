"""What pushes the vortex: the body force of a particle."""

import taichi as ti

from solvers.kernels.elementary import cos, sin
from solvers.problems.vortex.exact import SECOND_FREQUENCY, SECOND_SIZE


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
