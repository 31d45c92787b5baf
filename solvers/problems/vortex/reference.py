"""The vortex as another code sees it."""

from __future__ import annotations

import numpy as np

from solvers.estimators.standalone import ElasticBody
from solvers.problems.planar.layout import Layout, particle_layout
from solvers.problems.planar.reference import PlanarReference
from solvers.problems.reference import Texts
from solvers.problems.vortex import exact
from solvers.problems.vortex.exact import force_at_rest, on_axis, turned
from solvers.problems.vortex.scene import SIDE, VortexScene

FINE, COARSE = (8, 6), (6, 5)  # of the companion: elements across the ring, their order

TURN = (r"$$\alpha(R,t) = A \sin(\omega t)\,h(R),\quad h(R) = 1 - 32\,(R-1)^2 + 256\,(R-1)^4$$ "
        r"($R$ in metres; $h$ and $h'$ vanish at both rims)")
FORCE = (r"$$b = \left(-R\,\alpha_t^2 + \frac{\mu}{\rho} R\,\alpha_R^2\right) e_r + \left(R\,\alpha_{tt} - "
         r"\frac{\mu}{\rho}\,(3\,\alpha_R + R\,\alpha_{RR})\right) e_\theta$$")
SECOND = r"$$\frac{1}{2}\omega^2 A\,R\,h(R) \sin(1.7\,\omega t)\,e_\theta$$"
WHERE = (r"$e_r$ and $e_\theta$ are the polar directions at the angle $\Theta + \alpha$, where $\Theta$ is the angle "
         r"at which the particle began: $e_r = (\cos(\Theta + \alpha), \sin(\Theta + \alpha))$ and $e_\theta$ is that "
         "turned by 90 degrees to the left. The force belongs to material points: a particle that began at $X$ feels "
         "$b(X,t)$ wherever it is now. A code that has the force only in space may invert $x = Q(\\alpha) X$: the "
         "radius stays.")
STAGGERED = (r" The acceleration is not zero at $t = 0$: a code whose velocities belong to the middle of its steps "
             r"takes the exact $v(X, -\Delta t/2)$, or is first-order in its step.")
SOURCE = ("Sources: Brannon, Kamojjala and Sadeghirad, Establishing credibility of particle methods through "
          "verification testing (Particles 2011); Kamojjala, Brannon, Sadeghirad and Guilkey, Engineering with "
          "Computers 31 (2015) 199-213.")


class VortexReference(PlanarReference):
    """The generalized vortex."""

    EXACT = exact

    def layout(self, scene: VortexScene) -> Layout:
        return particle_layout(scene)

    def texts(self, scene: VortexScene) -> Texts:
        lam, mu = exact.lame(scene)
        A, w = f"{scene.amplitude:.15g}", f"{scene.angular_frequency:.15g}"
        numbers = rf"$A = {A}$ rad and $\omega = {w}$ 1/s"
        force = {"material": f"{FORCE} with {numbers}, $\\mu$ as above, in m/s². {WHERE}",
                 "two-tone": f"The sum of {FORCE} and of {SECOND} with {numbers}, $\\mu$ as above, in m/s². {WHERE}",
                 "none": "There is none: $b = 0$."}[scene.body_force]
        if scene.body_force != "none":
            force += f" The angle is {TURN}."
        return Texts(
            body="A full ring with the inner radius 0.75 m and the outer radius 1.25 m, its centre at the origin, of "
                 "thickness 1 m, in plane strain. Our grid is a square, 3 m wide, with the origin in its middle, so "
                 f"that nodes lie at ({-SIDE / 2:g} m, {-SIDE / 2:g} m) + (i, j) h.",
            material=r"Neo-Hookean: $\sigma = \frac{\lambda \ln J}{J} I + \frac{\mu}{J}(F F^T - I)$, $P = \mu(F - "
                     r"F^{-T}) + \lambda \ln J\,F^{-T}$, "
                     rf"$E = {scene.modulus:.15g}$ Pa and Poisson's ratio $\nu = {scene.poisson_ratio:.15g}$: "
                     rf"$\lambda = {lam:.15g}$ Pa, $\mu = {mu:.15g}$ Pa; density {scene.density:.15g} kg/m³.",
            force=force,
            boundary="Both rims are free, and nothing is held.",
            start=rf"At rest in shape ($F = I$), each circle turning about the origin with $v = "
                  rf"{scene.amplitude * scene.angular_frequency:.15g}\,R\,h(R)\,e_\Theta$ m/s, $h$ as in {TURN}."
                  + STAGGERED * scene.solution_known,
            exact=r"Every circle turns as a whole: $$x = Q(\alpha)\,X$$ where $Q$ turns by the angle "
                  rf"{TURN}, {numbers}. "
                  r"So $v = R\,\alpha_t\,e_\theta$, $F = Q\,(I + R\,\alpha_R\,e_\Theta \otimes e_R)$, $J = 1$, "
                  r"$\sigma_{rr} = 0$, $\sigma_{r\theta} = \mu R\,\alpha_R$ and $\sigma_{\theta\theta} = \mu (R\,"
                  r"\alpha_R)^2$. $\lambda$ drops out of the solution, but not out of a code's errors. " + SOURCE
            if scene.solution_known else "None is built in for this body force.",
            table="The points of the table lie on the $x$ axis from $R = 0.75$ m to $R = 1.25$ m; at a material point "
                  "elsewhere the force is that of the same radius, turned by the point's angle $\\Theta$.")

    def table_points(self, scene: VortexScene, count: int) -> np.ndarray:
        return on_axis(np.linspace(exact.INNER, exact.OUTER, count))

    def stress(self, scene: VortexScene, F: np.ndarray) -> np.ndarray:
        lam, mu = exact.lame(scene)
        J = np.linalg.det(F)[:, None, None]
        return lam * np.log(J) / J * np.eye(2) + mu / J * (np.einsum("pij,pkj->pik", F, F) - np.eye(2))

    def body_force(self, scene: VortexScene, X: np.ndarray, t: float) -> np.ndarray:
        R = np.linalg.norm(X, axis=1)
        return turned(X / R[:, None], force_at_rest(scene, R, t))

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
        from solvers.problems.vortex.estimators.companion_standalone import VortexCompanionBody

        return VortexCompanionBody(scene, *(FINE if fine else COARSE))


REFERENCE = VortexReference()
