"""The errors of each cause: their sources in a step, and their propagation.

The exact solution has a defect under one step of the run. With f the method's nodal force of the exact stress, f~ that
of the same stress in pieces, and "down" the mass-weighted mean over a node's particles, the acceleration's defect is

    crossings    (f - f~)/m            a particle, or its domain, counts where a part of its piece does not lie
    coarse grid  f~/m - down(a0 - b)   pieces of constant stress, seen by hats

and beside that: the velocity gradient at particles instead of pieces (crossings), the mapping of v and a to the nodes
and back (coarse grid), and symplectic Euler (time step). The body force acts at material points, without a defect.
"""

from typing import NamedTuple

import numpy as np

from solvers.motion.laws.stress_difference import StressDifference
from solvers.problems.planar.budget.body_pieces import MovedBodyPieces
from solvers.problems.planar.budget.exact_state import ExactState
from solvers.problems.planar.step_weights import StepWeights

#: The causes of ``solvers.scene.error_causes`` that exist here: a body force at material points makes no error.
LOCAL_CAUSES = ("crossings", "coarse_grid", "time_step")
CROSSINGS, COARSE_GRID, TIME_STEP = range(len(LOCAL_CAUSES))


class StepErrorSources(NamedTuple):
    """Errors that each of ``LOCAL_CAUSES`` adds in a step to x in m, v in m/s (3, P, 2) and F (3, P, 2, 2), and the
    velocity gradient of the exact motion (P, 2, 2) in 1/s."""

    position: np.ndarray
    velocity: np.ndarray
    deformation_gradient: np.ndarray
    velocity_gradient: np.ndarray


def step_error_sources(weights: StepWeights, pieces: MovedBodyPieces, now: ExactState, then: ExactState,
                       stress: np.ndarray, volume: np.ndarray, dt: float, with_particle: bool,
                       frozen: bool) -> StepErrorSources:
    """Returns the errors that each cause adds in the step of ``dt`` s from the exact state ``now`` to ``then``, by the
    run's ``weights`` and ``pieces``. ``stress`` (P, 2, 2), Pa, is J sigma of the exact F now, or P if the weights are
    ``frozen``; ``volume`` (P,) in m^2 is at rest; ``with_particle``: particles move with their own velocity."""
    particles = len(volume)
    x, v = np.zeros((len(LOCAL_CAUSES), particles, 2)), np.zeros((len(LOCAL_CAUSES), particles, 2))
    F = np.zeros((len(LOCAL_CAUSES), particles, 2, 2))
    before = np.broadcast_to(np.eye(2), (particles, 2, 2)) if frozen else now.deformation_gradient
    moved = now.velocity + dt * now.acceleration
    down = weights.average_to_nodes(np.stack([moved, now.acceleration, now.velocity,
                                              now.acceleration - now.body_force]))

    method = weights.stress_acceleration((volume[:, None, None] * stress)[None])[0]
    in_pieces = weights.per_mass * pieces.nodal_force(stress / np.linalg.det(before)[:, None, None])
    missed = np.stack([method - in_pieces, in_pieces - down[3]])  # accelerations at the nodes (2, N, 2)
    gradients = weights.gradient(np.concatenate([missed, down[:1]]))
    both = [CROSSINGS, COARSE_GRID]
    v[both] += dt * weights.interpolate_to_particles(missed)
    x[both] += dt * v[both]
    F[both] += dt**2 * gradients[:2] @ before

    there_and_back = weights.interpolate_to_particles(down[1:3]) - np.stack([now.acceleration, now.velocity])
    v[COARSE_GRID] += dt * there_and_back[0]
    x[COARSE_GRID] += dt**2 * there_and_back[0] + (0.0 if with_particle else dt * there_and_back[1])
    from_pieces, wanted = pieces.gradient(down[0]), now.rate + dt * now.second_rate
    F[CROSSINGS] += dt * (gradients[2] - from_pieces) @ before
    F[COARSE_GRID] += dt * (from_pieces @ before - wanted)

    x[TIME_STEP] += dt * moved - (then.displacement - now.displacement)
    v[TIME_STEP] += dt * now.acceleration - (then.velocity - now.velocity)
    F[TIME_STEP] += dt * wanted - (then.deformation_gradient - now.deformation_gradient)
    return StepErrorSources(x, v, F, gradients[2] + dt * (gradients[0] + gradients[1]))


class CauseErrors:
    """Errors of x in m, of v in m/s (3, P, 2) and of F (3, P, 2, 2) that each of ``LOCAL_CAUSES`` has caused so far."""

    def __init__(self, particles: int):
        self.position = np.zeros((len(LOCAL_CAUSES), particles, 2))
        self.velocity = np.zeros((len(LOCAL_CAUSES), particles, 2))
        self.deformation_gradient = np.zeros((len(LOCAL_CAUSES), particles, 2, 2))

    def fields(self) -> dict[str, np.ndarray]:
        """Returns the errors "x" in m, "v" in m/s (3, P, 2) and "F" (3, P, 2, 2)."""
        return {"x": self.position, "v": self.velocity, "F": self.deformation_gradient}

    def propagate(self, weights: StepWeights, material: StressDifference, F: np.ndarray, F0: np.ndarray,
                  volume: np.ndarray, sources: StepErrorSources, dt: float, with_particle: bool) -> None:
        """Propagates the errors through a step of ``dt`` s that began with the run's ``F`` and the exact ``F0`` (P, 2,
        2), and adds the step's ``sources``; ``volume`` and ``with_particle`` as in :func:`step_error_sources`. L F - L0
        F0 = (L - L0) F + L0 (F - F0), exactly; with frozen weights F has L only."""
        stress = material.split_difference(F, F0, self.deformation_gradient)
        acceleration = weights.stress_acceleration(volume[:, None, None] * stress)
        moved = weights.average_to_nodes(self.velocity) + dt * acceleration
        faster = dt * weights.interpolate_to_particles(acceleration)
        if with_particle:
            self.position += dt * (self.velocity + faster)
        else:
            self.position += dt * weights.interpolate_to_particles(moved)
        self.velocity += faster
        slope = weights.gradient(moved)
        if not material.at_rest:
            slope = slope @ F + sources.velocity_gradient @ self.deformation_gradient
        self.deformation_gradient += dt * slope
        self.position += sources.position
        self.velocity += sources.velocity
        self.deformation_gradient += sources.deformation_gradient
