"""The recovered estimator on the vortex (see ``solvers.problems.planar.estimators.recovered``): a whole turn, and
lambda.

P = mu F + (lambda ln J - mu) F^-T. Its reference moves by an explicit method in the material frame, where waves along a
circle that is sheared by g run sqrt(1 + g^2) times as fast as at rest (nearly, see ``crossing_rate``), and its steps
are as much shorter: in a vortex with A = 1 hardly longer than the run's, and then it costs more than the run.
"""

import numpy as np
import taichi as ti

from solvers.estimators import recovery
from solvers.problems.planar.estimators import recovered
from solvers.problems.vortex import exact, validity
from solvers.problems.vortex.method.material import cauchy_stress, force_at
from solvers.problems.vortex.scene import polar_counts
from solvers.scene.estimator_hooks import EstimatorHooks

MOST_ROUGH = 7.0  # as on the ring


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


PROBLEM = recovered.Problem(force_at, stress, stress_error, closed=True)


@ti.func
def after_step(vortex: ti.template(), base, step, on: ti.template()):
    """Its turn."""
    recovered.after_step(vortex, step, PROBLEM, on)


@ti.func
def report(vortex: ti.template(), base, step, on: ti.template()):
    """Its estimates."""
    recovered.report(vortex, base, step, PROBLEM, on)


def lines(scene):
    """The lattice's lines, around and across the ring."""
    return recovered.lines(scene, exact.INNER, exact.OUTER, polar_counts(scene.cells, scene.ppc), 2 * np.pi, "periodic")


def interval(scene):
    """Steps of the run to one of the estimator's."""
    angle, radius = lines(scene)
    side = min(1 / angle.per_element / validity.crossing_rate(scene), 1 / radius.per_element)
    return recovery.steps_between(scene, recovered.WAVE_CFL * side)


def allocate(scene):
    """Operators along both lines, and the reference, whose initial velocity is along the circles."""
    angle, radius = lines(scene)
    R = exact.INNER + radius.particles() / radius.per_point
    return recovered.allocate(scene, angle, radius, exact.INNER, (np.zeros_like(R), R * exact.turn(scene, R, 0.0).rate),
                              interval(scene), validity.uneven(scene))


HOOKS = EstimatorHooks(
    memory=recovered.MEMORY, allocate=allocate, interval=interval, after_step=after_step, report=report,
    verdict=lambda scene, memory: recovered.verdict(scene, memory, MOST_ROUGH))
