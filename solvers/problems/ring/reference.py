"""The ring as another code sees it."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from solvers.estimators.standalone import ElasticBody
from solvers.problems.planar.reference import SLACK, PlanarReference
from solvers.problems.reference import Texts, read_texts
from solvers.problems.ring import exact
from solvers.problems.ring.scene import RingScene

FINE, COARSE = (2, 4, 5), (2, 3, 4)  # of the companion: elements across the ring and around it, their order


class RingReference(PlanarReference):
    """The expanding ring."""

    EXACT = exact

    def texts(self, scene: RingScene) -> Texts:
        A, w = scene.amplitude, scene.angular_frequency
        return read_texts(Path(__file__).with_name("problem.md"), scene.body_force, A=A, w=w, speed=A * w,
                          E=scene.modulus, density=scene.density, C1=exact.C1, C2=exact.C2, C3=exact.C3)

    def stress(self, scene: RingScene, F: np.ndarray) -> np.ndarray:
        per_J = 0.5 * scene.modulus / np.linalg.det(F)
        return per_J[:, None, None] * (np.einsum("pij,pkj->pik", F, F) - np.eye(2))

    def body_force(self, scene: RingScene, X: np.ndarray, t: float) -> np.ndarray:
        R = np.linalg.norm(X, axis=1)
        return X * (exact.body_force(scene, R, t) / R)[:, None]

    def along(self, quantity: str, X: np.ndarray, x: np.ndarray, values: np.ndarray) -> np.ndarray:
        """Along e_R of the particle at rest."""
        e = X / np.linalg.norm(X, axis=1)[:, None]
        return np.einsum("pi,pij,pj->p", e, values, e) if values.ndim == 3 else np.sum(values * e, axis=1)

    def misplaced(self, scene: RingScene, X: np.ndarray) -> np.ndarray:
        return super().misplaced(scene, X) | (X < -SLACK).any(axis=1)

    def companion(self, scene: RingScene, fine: bool) -> ElasticBody:
        # here: the page of text and the table of a problem must not wait for Taichi
        from solvers.problems.ring.estimators.companion_mesh import RingCompanionBody

        return RingCompanionBody(scene, *(FINE if fine else COARSE))


REFERENCE = RingReference()
