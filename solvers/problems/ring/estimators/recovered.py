"""The recovered estimator on the ring (see ``solvers.problems.planar.estimators.recovered``): lambda = 0, P = mu (F -
F^-T)."""

import numpy as np
import taichi as ti

from solvers.problems.planar.estimators import recovered
from solvers.problems.ring import exact
from solvers.problems.ring.method.material import kirchhoff_stress, radial_force_at


@ti.func
def force(ring: ti.template(), known, t, on: ti.template()):
    """The body force per mass, which is radial."""
    return ti.Vector([radial_force_at(ring, known, t, on), 0.0])


@ti.func
def stress(ring: ti.template(), a, b, c, d):
    """P e_R and P e_angle, mu (F - F^-T), where F e_R = (a, c) and F e_angle = (b, d)."""
    per_J = 1 / (a * d - b * c)
    return ring.shear_modulus * ti.Vector([a - per_J * d, c + per_J * b, b + per_J * c, d - per_J * a])


@ti.func
def stress_error(ring: ti.template(), p, a, b, c, d):
    """sigma_p less mu/J (F F^T - I) of that gradient; as xx, xy, yy and nothing."""
    F = ring.deformation_gradient[p]
    own = kirchhoff_stress(ring, p) / (F[0] * F[3] - F[1] * F[2])
    scale = ring.shear_modulus / (a * d - b * c)
    return ti.Vector([own[0] - scale * (a * a + b * b - 1), own[1] - scale * (a * c + b * d),
                      own[2] - scale * (c * c + d * d - 1), 0.0])


def side(scene, angle):
    """Of an element at the inner rim."""
    return exact.INNER / angle.per_element


def velocity(scene, R):
    """At the start, along e_R and e_angle: radial."""
    return scene.amplitude * scene.angular_frequency * exact.shape(R)[0], np.zeros_like(R)


TRAITS = recovered.RecoveredTraits(force, stress, stress_error, closed=False)
HOOKS = recovered.hooks(TRAITS, side, velocity)
