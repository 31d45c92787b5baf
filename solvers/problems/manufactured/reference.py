"""A manufactured problem as another code sees it."""

from __future__ import annotations

import inspect
from pathlib import Path
from typing import Any

import numpy as np

from solvers.estimators.standalone import ElasticBody
from solvers.motion.neo_hookean import cauchy_stress
from solvers.problems.manufactured.scene import ManufacturedScene
from solvers.problems.planar.layout import particle_layout
from solvers.problems.planar.reference import EDGES, SLACK
from solvers.problems.reference import ProblemReference, Start, Texts, read_texts

GENERAL = Path(__file__).with_name("problem.md")  # texts of a problem that has none of its own
FINE = 7  # order of the companion's elements


class ManufacturedReference(ProblemReference):
    """Of a problem by the class of its scene, whose texts are in the file of the problem's name beside it."""

    axes = ("x", "y")

    def __init__(self, kind: type[ManufacturedScene]):
        self.EXACT, self._texts = kind.EXACT, Path(inspect.getfile(kind)).with_suffix(".md")
        if not self._texts.exists():
            self._texts = GENERAL

    def start(self, scene: Any) -> Start:
        layout = particle_layout(scene)
        return Start(layout.position, layout.volume, dict(zip(EDGES, layout.edges.T, strict=True)))

    def texts(self, scene: Any) -> Texts:
        bulk, mu = scene.lame_moduli
        formula = getattr(scene, "displacement", "")
        return read_texts(GENERAL if formula else self._texts, scene.body_force, formula=formula or "as in its code",
                          A=scene.amplitude, w=scene.angular_frequency, bulk=bulk, mu=mu, E=scene.modulus,
                          nu=scene.poisson_ratio, density=scene.density)

    def table_points(self, scene: Any, count: int) -> np.ndarray:
        a_side = max(2, round(count**0.5))
        line = (np.arange(a_side) + 0.5) / a_side * scene.SIDE
        return np.stack(np.meshgrid(line, line), axis=-1).reshape(-1, 2)

    def stress(self, scene: Any, F: np.ndarray) -> np.ndarray:
        xx, xy, yy = cauchy_stress(F.reshape(-1, 4).T, *scene.lame_moduli)
        return np.stack([xx, xy, xy, yy], axis=1).reshape(-1, 2, 2)

    def body_force(self, scene: Any, X: np.ndarray, t: float) -> np.ndarray:
        return np.zeros_like(X) if scene.body_force == "none" else self.EXACT.body_force(scene, X, t)

    def along(self, quantity: str, X: np.ndarray, x: np.ndarray, values: np.ndarray) -> np.ndarray:
        """Along x."""
        return values[:, 0, 0] if values.ndim == 3 else values[:, 0]

    def misplaced(self, scene: Any, X: np.ndarray) -> np.ndarray:
        return ((X < -SLACK) | (X > scene.SIDE + SLACK)).any(axis=1)

    def companion(self, scene: Any, fine: bool) -> ElasticBody:
        return scene.companion_patch(FINE if fine else None)
