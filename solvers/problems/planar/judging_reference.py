"""Reference of a plane problem for other codes."""

import inspect
from pathlib import Path
from typing import Any

import numpy as np

from solvers.estimators.standalone_companion import ElasticBody
from solvers.problems.judging_reference import InitialParticles, JudgingReference, ProblemDescription, read_texts
from solvers.problems.planar.body_force import body_force_at
from solvers.problems.planar.particle_layout import particle_layout, points_on_x_axis
from solvers.problems.planar.scene import PlanarScene

GENERAL_TEXTS = Path(__file__).with_name("problem.md")  # texts of a problem that has none of its own
POSITION_TOLERANCE = 1e-6  # m, by which a material point may lie beyond a side or a rim: single precision rounds
EDGE_COLUMNS = ("edge1_x", "edge1_y", "edge2_x", "edge2_y")


class PlanarJudgingReference(JudgingReference):
    """Description for other codes of the plane problem with scene class ``kind``; texts are in a .md file beside its
    module, or general ones."""

    axes = ("x", "y")

    def __init__(self, kind: type[PlanarScene]):
        self.EXACT = kind.EXACT
        own = Path(inspect.getfile(kind)).with_suffix(".md")
        self._texts = own if own.exists() else GENERAL_TEXTS

    def start(self, scene: Any) -> InitialParticles:
        layout = particle_layout(scene)
        return InitialParticles(layout.position, layout.volume, dict(zip(EDGE_COLUMNS, layout.edges.T, strict=True)))

    def texts(self, scene: Any) -> ProblemDescription:
        (bulk, mu), A, formula = scene.lame_moduli, scene.amplitude, getattr(scene, "displacement", "")
        w = scene.base_frequency if formula else scene.angular_frequency
        return read_texts(GENERAL_TEXTS if formula else self._texts, scene.body_force, scene.law,
                          formula=formula or "as in its code", law=scene.material.law.text, A=A, w=w, speed=A * w,
                          bulk=bulk, mu=mu, E=scene.modulus, density=scene.density,
                          nu=getattr(scene, "poisson_ratio", 0.0), corner=self.grid_corner(scene))

    def table_points(self, scene: Any, count: int) -> np.ndarray:
        if scene.CIRCULAR:
            return points_on_x_axis(np.linspace(scene.INNER, scene.OUTER, count))
        a_side = max(2, round(count**0.5))
        line = (np.arange(a_side) + 0.5) / a_side * scene.SIDE
        return np.stack(np.meshgrid(line, line), axis=-1).reshape(-1, 2)

    def stress(self, scene: Any, F: np.ndarray) -> np.ndarray:
        xx, xy, yy = scene.material.cauchy_stress(F.reshape(-1, 4).T)
        return np.stack([xx, xy, xy, yy], axis=1).reshape(-1, 2, 2)

    def body_force(self, scene: Any, X: np.ndarray, t: float) -> np.ndarray:
        return body_force_at(scene, X, t)

    def is_outside(self, scene: Any, X: np.ndarray) -> np.ndarray:
        outside = (X < -POSITION_TOLERANCE).any(axis=1) & scene.PLANES[0]
        R = np.linalg.norm(X, axis=1) if scene.CIRCULAR else X.max(axis=1)
        return outside | (R < scene.INNER - POSITION_TOLERANCE) | (R > scene.OUTER + POSITION_TOLERANCE)

    def grid_corner(self, scene: Any) -> float:
        return 0.0 if scene.PLANES[0] else -0.5 * scene.SIDE

    def companion(self, scene: Any, fine: bool) -> ElasticBody:
        return scene.companion_body(fine)
