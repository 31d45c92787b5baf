"""The errors of each cause, carried on by the run's own step (see the package)."""

import numpy as np

from solvers.problems.planar.budget.material import Material
from solvers.problems.planar.budget.sources import MAKERS, Sources
from solvers.problems.planar.budget.weights import StepWeights


class CauseErrors:
    """The errors of x and v (3, P, 2) and of F (3, P, 2, 2) that each of ``MAKERS`` has made."""

    def __init__(self, particles: int):
        self.position = np.zeros((len(MAKERS), particles, 2))
        self.velocity = np.zeros((len(MAKERS), particles, 2))
        self.deformation_gradient = np.zeros((len(MAKERS), particles, 2, 2))

    def fields(self) -> dict[str, np.ndarray]:
        """By the names of ``solvers.scene.causes.FIELDS``."""
        return {"x": self.position, "v": self.velocity, "F": self.deformation_gradient}

    def push(self, weights: StepWeights, material: Material, F: np.ndarray, F0: np.ndarray, volume: np.ndarray,
             given: Sources, dt: float, with_particle: bool) -> None:
        """Take them through a step which began with the run's ``F`` and the exact ``F0`` (P, 2, 2), and add what each
        cause gives. L F - L0 F0 = (L - L0) F + L0 (F - F0), exactly; with frozen weights F has L only."""
        stress = material.difference(F, F0, self.deformation_gradient)
        acceleration = weights.acceleration_of(volume[:, None, None] * stress)
        moved = weights.to_nodes(self.velocity) + dt * acceleration
        faster = dt * weights.to_particles(acceleration)
        if with_particle:
            self.position += dt * (self.velocity + faster)
        else:
            self.position += dt * weights.to_particles(moved)
        self.velocity += faster
        slope = weights.gradient(moved)
        if not material.at_rest:
            slope = slope @ F + given.velocity_gradient @ self.deformation_gradient
        self.deformation_gradient += dt * slope
        self.position += given.position
        self.velocity += given.velocity
        self.deformation_gradient += given.deformation_gradient
