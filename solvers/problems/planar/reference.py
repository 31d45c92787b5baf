"""What a round body in the plane is for other codes, whatever moves it."""

from __future__ import annotations

from typing import Any

import numpy as np

from solvers.problems.planar.layout import particle_layout
from solvers.problems.reference import ProblemReference, Start

SLACK = 1e-6  # m, by which a material point may lie beyond a rim: single precision rounds
EDGES = ("edge1_x", "edge1_y", "edge2_x", "edge2_y")


class PlanarReference(ProblemReference):
    """A ring around the origin; ``EXACT`` has the radii of its rims."""

    axes = ("x", "y")

    def start(self, scene: Any) -> Start:
        layout = particle_layout(scene)
        return Start(layout.position, layout.volume, dict(zip(EDGES, layout.edges.T, strict=True)))

    def table_points(self, scene: Any, count: int) -> np.ndarray:
        R = np.linspace(self.EXACT.INNER, self.EXACT.OUTER, count)
        return np.stack([R, np.zeros_like(R)], axis=1)

    def exact_stress(self, scene: Any, X: np.ndarray, t: float) -> np.ndarray:
        xx, xy, yy = self.EXACT.stress(scene, X, t).T
        return np.stack([xx, xy, xy, yy], axis=1).reshape(-1, 2, 2)

    def misplaced(self, scene: Any, X: np.ndarray) -> np.ndarray:
        R = np.linalg.norm(X, axis=1)
        return (R < self.EXACT.INNER - SLACK) | (R > self.EXACT.OUTER + SLACK)
