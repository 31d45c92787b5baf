"""The recovered estimator on the vortex (see ``solvers.problems.planar.estimators.recovered``): a whole turn, and
lambda.

P = mu F + (lambda ln J - mu) F^-T. Its reference moves by an explicit method in the material frame, where waves along a
circle that is sheared by g run sqrt(1 + g^2) times as fast as at rest (nearly, see ``crossing_rate``), and its steps
are as much shorter: in a vortex with A = 1 hardly longer than the run's, and then it costs more than the run.
"""

import numpy as np
import taichi as ti

from solvers.problems.planar.estimators import recovered
from solvers.problems.planar.method.neo_hookean import cauchy_stress
from solvers.problems.vortex import exact
from solvers.problems.vortex.method.material import force_at
from solvers.problems.vortex_limits import crossing_rate


@ti.func
def stress(vortex: ti.template(), a, b, c, d):
    """P e_R and P e_angle, where F e_R = (a, c) and F e_angle = (b, d)."""
    J = a * d - b * c
    mu, back = vortex.shear_modulus, (vortex.lame_modulus * ti.log(J) - vortex.shear_modulus) / J
    return ti.Vector([mu * a + back * d, mu * c - back * b, mu * b - back * c, mu * d + back * a])


@ti.func
def stress_error(vortex: ti.template(), p, a, b, c, d):
    """sigma_p less lambda ln J/J I + mu/J (F F^T - I) of that gradient; as xx, xy, yy and nothing."""
    own, J = cauchy_stress(vortex, p), a * d - b * c
    mu, bulk = vortex.shear_modulus / J, vortex.lame_modulus * ti.log(J) / J
    return ti.Vector([own[0] - mu * (a * a + b * b - 1) - bulk, own[1] - mu * (a * c + b * d),
                      own[2] - mu * (c * c + d * d - 1) - bulk, 0.0])


def side(scene, angle):
    """Of an element, as a wave takes it along the circle where it is fastest."""
    return 1 / angle.per_element / crossing_rate(scene)


def velocity(scene, R):
    """At the start, along e_R and e_angle: along the circles."""
    return np.zeros_like(R), R * exact.turn(scene, R, 0.0).rate


TRAITS = recovered.RecoveredTraits(force_at, stress, stress_error, closed=True)
HOOKS = recovered.hooks(TRAITS, side, velocity)
