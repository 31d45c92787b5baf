"""What a round body in the plane is for other codes, whatever moves it."""

from __future__ import annotations

from abc import abstractmethod
from typing import Any

import numpy as np

from solvers.problems.planar.layout import Layout
from solvers.problems.reference import ProblemReference, Start

SLACK = 1e-6  # m, by which a material point may lie beyond a rim: single precision rounds
EDGES = ("edge1_x", "edge1_y", "edge2_x", "edge2_y")


class PlanarReference(ProblemReference):
    """A ring around the origin. ``EXACT`` is the problem's module of its exact solution, with the radii of the rims."""

    EXACT: Any
    axes = ("x", "y")

    @abstractmethod
    def layout(self, scene: Any) -> Layout:
        """The particles of a scene."""

    def start(self, scene: Any) -> Start:
        layout = self.layout(scene)
        return Start(layout.position, layout.volume, dict(zip(EDGES, layout.edges.T, strict=True)))

    def displacement(self, scene: Any, X: np.ndarray, t: float) -> np.ndarray:
        return self.EXACT.displacement(scene, X, t)

    def velocity(self, scene: Any, X: np.ndarray, t: float) -> np.ndarray:
        return self.EXACT.velocity(scene, X, t)

    def deformation_gradient(self, scene: Any, X: np.ndarray, t: float) -> np.ndarray:
        return self.EXACT.deformation_gradient(scene, X, t)

    def exact_stress(self, scene: Any, X: np.ndarray, t: float) -> np.ndarray:
        xx, xy, yy = self.EXACT.stress(scene, X, t).T
        return np.stack([xx, xy, xy, yy], axis=1).reshape(-1, 2, 2)

    def misplaced(self, scene: Any, X: np.ndarray) -> np.ndarray:
        R = np.linalg.norm(X, axis=1)
        return (R < self.EXACT.INNER - SLACK) | (R > self.EXACT.OUTER + SLACK)
