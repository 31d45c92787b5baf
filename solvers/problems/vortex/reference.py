"""The vortex as another code sees it."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from solvers.estimators.standalone import ElasticBody
from solvers.problems.planar.reference import PlanarReference
from solvers.problems.reference import Texts, read_texts
from solvers.problems.vortex import exact
from solvers.problems.vortex.exact import combined, force_at_rest
from solvers.problems.vortex.scene import SIDE, VortexScene

FINE, COARSE = (8, 6), (6, 5)  # of the companion: elements across the ring, their order


class VortexReference(PlanarReference):
    """The generalized vortex."""

    EXACT = exact

    def texts(self, scene: VortexScene) -> Texts:
        lam, mu = exact.lame(scene)
        A, w = scene.amplitude, scene.angular_frequency
        return read_texts(Path(__file__).with_name("problem.md"), scene.body_force, A=A, w=w, speed=A * w,
                          E=scene.modulus, poisson=scene.poisson_ratio, lam=lam, mu=mu, density=scene.density,
                          corner=-0.5 * SIDE)

    def stress(self, scene: VortexScene, F: np.ndarray) -> np.ndarray:
        lam, mu = exact.lame(scene)
        J = np.linalg.det(F)[:, None, None]
        return lam * np.log(J) / J * np.eye(2) + mu / J * (np.einsum("pij,pkj->pik", F, F) - np.eye(2))

    def body_force(self, scene: VortexScene, X: np.ndarray, t: float) -> np.ndarray:
        R = np.linalg.norm(X, axis=1)
        return combined(X / R[:, None], *force_at_rest(scene, R, t).T)

    def along(self, quantity: str, X: np.ndarray, x: np.ndarray, values: np.ndarray) -> np.ndarray:
        """Along e_Theta of the particle at rest for u, along e_theta of where it is for v and a, and sigma_rt."""
        place = X if quantity == "x" else x
        e = place / np.linalg.norm(place, axis=1)[:, None]
        across = np.stack([-e[:, 1], e[:, 0]], axis=1)
        return np.einsum("pi,pij,pj->p", e, values, across) if values.ndim == 3 else np.sum(values * across, axis=1)

    def grid_corner(self, scene: VortexScene) -> float:
        return -0.5 * SIDE

    def companion(self, scene: VortexScene, fine: bool) -> ElasticBody:
        # here: the page of text and the table of a problem must not wait for Taichi
        from solvers.problems.vortex.estimators.companion_mesh import VortexCompanionBody

        return VortexCompanionBody(scene, *(FINE if fine else COARSE))


REFERENCE = VortexReference()
