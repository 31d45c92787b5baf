"""The ring as another code sees it."""

from __future__ import annotations

import numpy as np

from solvers.estimators.standalone import ElasticBody
from solvers.problems.planar.layout import Layout, particle_layout
from solvers.problems.planar.reference import SLACK, PlanarReference
from solvers.problems.reference import Texts
from solvers.problems.ring import exact
from solvers.problems.ring.scene import RingScene

FINE, COARSE = (2, 4, 5), (2, 3, 4)  # of the companion: elements across the ring and around it, their order

SHAPE = r"$$w(R) = C_1 R + C_2 R^2 + C_3 R^3$$"
FORCE = (r"$$b_R = -\omega^2 T w - \frac{1}{\rho}\left[\mu\left(1 + \frac{1}{F_r^2}\right) T w'' + \frac{\mu}{R}"
         r"\left(F_r - \frac{1}{F_r} - F_\theta + \frac{1}{F_\theta}\right)\right]$$ "
         r"with $T = A \sin \omega t$, $F_r = 1 + T w'$, $F_\theta = 1 + T w/R$, $\mu = E/2$")
SECOND = r"$$\frac{1}{2}\omega^2 A \cos\left(\pi\frac{R - 0.4}{0.2}\right)\sin(1.7\,\omega t)$$"
WHERE = ("The force belongs to material points: a particle that began at $X$ feels $b(X,t)$, along its first direction "
         "$e_R = X/R$, wherever it is now. A code that has the force only in space may invert $x = X + u(X,t)$.")


class RingReference(PlanarReference):
    """The expanding ring."""

    EXACT = exact

    def layout(self, scene: RingScene) -> Layout:
        return particle_layout(scene)

    def texts(self, scene: RingScene) -> Texts:
        w, A = f"{scene.angular_frequency:.15g}", f"{scene.amplitude:.15g}"
        cubic = (f"{SHAPE} with $C_1 = {exact.C1:.15g}$ 1/m, $C_2 = {exact.C2:.15g}$ 1/m², $C_3 = {exact.C3:.15g}$ "
                 "1/m³: $w(0.6) = 1$ and $w'(0.4) = w'(0.6) = 0$")
        numbers = rf"$A = {A}$ m, $\omega = {w}$ 1/s"
        force = {"material": f"Radial: {FORCE}; {numbers}, $w$ as in the exact solution, in m/s². {WHERE}",
                 "two-tone": f"Radial, the sum of {FORCE} and of {SECOND} {numbers}, $w$ as below, in m/s². {WHERE}",
                 "none": "There is none: $b = 0$."}[scene.body_force]
        return Texts(
            body="A ring with the inner radius 0.4 m and the outer radius 0.6 m, its centre at the origin, of "
                 "thickness 1 m, in plane strain (without Poisson's ratio plane stress is the same). A quarter of it, "
                 "$x, y \\ge 0$, is enough, and that is what the particles fill.",
            material=rf"Neo-Hookean with $\lambda = 0$: $\sigma = \frac{{\mu}}{{J}}(F F^T - I)$, $P = \mu(F - "
                     rf"F^{{-T}})$, "
                     rf"$\mu = E/2$, $E = {scene.modulus:.15g}$ Pa (Poisson's ratio 0); density {scene.density:.15g} "
                     rf"kg/m³.",
            force=force,
            boundary="Both surfaces are free. On the planes of symmetry nothing moves across: $u_y = 0$ on $y = 0$ and "
                     "$u_x = 0$ on $x = 0$.",
            start=rf"At rest in shape ($F = I$), moving outwards with $v = "
                  rf"{scene.amplitude * scene.angular_frequency:.15g}"
                  rf"\,w(R)\,e_R$ m/s, {cubic}.",
            exact=rf"$$u(X,t) = A \sin(\omega t)\,w(R)\,e_R$$ with {numbers}, {cubic}. Along $e_R$ and across it "
                  r"$F_r = 1 + A \sin(\omega t)\,w'$ and $F_\theta = 1 + A \sin(\omega t)\,w/R$."
            if scene.solution_known else "None is built in for this body force.",
            table="The points of the table lie on the $x$ axis from $R = 0.4$ m to $R = 0.6$ m; elsewhere the force is "
                  "that of the same radius, along $e_R$.")

    def table_points(self, scene: RingScene, count: int) -> np.ndarray:
        R = np.linspace(exact.INNER, exact.OUTER, count)
        return np.stack([R, np.zeros_like(R)], axis=1)

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
        from solvers.problems.ring.estimators.companion_standalone import RingCompanionBody

        return RingCompanionBody(scene, *(FINE if fine else COARSE))


REFERENCE = RingReference()
