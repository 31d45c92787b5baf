"""Breakdown of a step of the bar, from the arrays after the step."""

import numpy as np

from solvers.problems.bar.method.periodic_nodes import MOST_HALF_WIDTH
from solvers.problems.bar.scene import BarScene
from solvers.problems.bar.state import InstrumentedBar
from solvers.solver import particle_step_breakdown
from solvers.solver.particle_step_breakdown import ParticleState, ParticleStepBreakdown, PeriodicOrMirrorNode


def particle_state(scene: BarScene, a: InstrumentedBar) -> ParticleState:
    """Returns a copy of the present x, v, F and stress of all particles, in SI, from the solver's arrays ``a``."""
    x, v, F = (values[:, None].copy() for values in (a.position, a.velocity, a.deformation_gradient))
    return ParticleState(x, v, F[:, None] / a.unstretched, a.modulus * (F[:, None] - a.unstretched))


def breakdown(scene: BarScene, a: InstrumentedBar, particle: int, step: int,
              before: ParticleState) -> ParticleStepBreakdown:
    """Returns the breakdown of the last step, number ``step``, around the particle of this number, from the arrays
    ``a`` after it and the state of all particles ``before`` it (:func:`particle_state`)."""
    N, h, time = scene.cells, scene.spacing, (step - 1) * scene.time_step
    links = particle_step_breakdown.find_links(particle, a.first_node[:, None] + np.arange(3),
                                               lambda some: _weights(a, some), lambda node: _images(node, N, h))
    place = a.material_position[:, None] if scene.frozen else before.position
    period = np.floor(place)  # the solver's nodes are those of the particle's own period
    links.shift[:] += period[particle] - period[links.members]
    seen = before.mirror(links)
    F, g = before.deformation_gradient[:, 0, 0] * a.unstretched, (links.nodes - 1) % N + 1  # of images their nodes
    width = {"mpm": 0.0, "cpgimp": 1.0 if scene.frozen else F}.get(scene.method, 1.0) * np.ones_like(F)
    width = np.minimum(h * a.half_width * width, h * MOST_HALF_WIDTH)
    tension = a.volume * (1.0 if scene.frozen else F) * before.stress[:, 0, 0]
    mass = a.density * a.volume
    node_mass, (velocity, acceleration) = mass * a.node_sums[g, 0], a.node_motion[links.nodes].T
    body = mass * a.node_sums[g, 3]
    if scene.body_force == "node":
        body = node_mass * a.force_scale * np.sin(a.angular_frequency * time) * a.node_sine[g]
    internal = a.node_sums[g, 2]
    if scene.linearity_preserving:  # corrected by sums that are not stored
        internal = node_mass * acceleration - body

    def column(values: np.ndarray) -> np.ndarray:
        return values[:, None].copy()

    k = links.members
    return ParticleStepBreakdown(step, time, scene.time_step, h, links, seen, particle_state(scene, a).mirror(links),
                                 np.full(len(k), mass), place[k] + links.shift, column(width[k])[:, None],
                                 column(tension[k])[:, None], column((links.nodes - 1) * h + period[particle]),
                                 node_mass, column(mass * a.node_sums[g, 1]), column(internal), column(body),
                                 column(acceleration), column(velocity))


def _weights(a: InstrumentedBar, some: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    left, right, slope_left, slope_right = a.weights[some].T
    return (np.stack([left, 1 - left - right, right], axis=1),
            np.stack([slope_left, -slope_left - slope_right, slope_right], axis=1)[:, :, None])


def _images(node: int, cells: int, spacing: float) -> list[PeriodicOrMirrorNode]:
    home = (node - 1) % cells + 1
    return [PeriodicOrMirrorNode(other, (1.0,), ((node - other) * spacing,))
            for other in (home - cells, home, home + cells) if 0 <= other <= cells + 3]
