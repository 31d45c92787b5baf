"""The bar as another code sees it."""

from __future__ import annotations

import numpy as np

from solvers.estimators.spectral import Elements
from solvers.estimators.standalone import ElasticBody
from solvers.problems.bar import exact
from solvers.problems.bar.scene import BarScene
from solvers.problems.reference import ProblemReference, Start, Texts

SLACK = 1e-6  # m, by which a material point may lie beyond an end: single precision rounds
FINE, COARSE = 16, 12  # elements of the companion, of order ORDER
ORDER = 6

TWO_TONES = (r"$$b(X,t) = 3\omega^2 A \sin(2\pi X)\sin(\omega t) + \frac{3}{2}\omega^2 A \sin(4\pi X)\sin(1.7\,\omega "
             r"t)"
             r"$$")
FORCES = {"material": r"$$b(X,t) = 3\omega^2 A \sin(2\pi X)\sin(\omega t)$$", "two-tone": TWO_TONES,
          "none": "There is none: $b = 0$."}
WHERE = ("It belongs to material points: a particle that began at $X$ feels $b(X,t)$ wherever it is now. A code that "
         "has the force only in space may invert $x = X + u(X,t)$.")


class BarReference(ProblemReference):
    """The vibrating bar."""

    def start(self, scene: BarScene) -> Start:
        X = (np.arange(scene.particles) + 0.5) * (scene.spacing / scene.ppc)
        return Start(X[:, None], np.full(len(X), scene.spacing / scene.ppc))

    def texts(self, scene: BarScene) -> Texts:
        return self._of_patch(scene) if scene.is_patch else self._of_vibration(scene)

    def _of_patch(self, scene: BarScene) -> Texts:
        F, v = f"{scene.stretch:.15g}", f"{scene.initial_velocity:.15g}"
        stress = f"{scene.modulus * (scene.stretch - 1):.15g}"
        return Texts(
            body=f"A bar of cross-section 1 m² and of the length 1 m, to which it has been stretched by $F_0 = {F}$: "
                 f"without stress it would be $1/F_0 = {1 / scene.stretch:.15g}$ m long. Particles stand evenly, and "
                 "$X$ is where one begins, in the bar as it is at $t = 0$. In two or three dimensions: a row of cells "
                 "between walls without friction, with Poisson's ratio 0.",
            material=rf"Linear in the stretch: $\sigma = E (F - 1)$ with $E = {scene.modulus:.15g}$ Pa, where $F$ "
                     "counts from the bar without stress, and the nominal and the Cauchy stress are the same, for the "
                     f"cross-section stays as it is; density {scene.density:.15g} kg/m³ without stress, so that it is "
                     f"{scene.density / scene.stretch:.15g} kg/m³ as the bar begins.",
            force=FORCES["none"],
            boundary="The bar is one period of an infinite one, and moves through its grid on and on: the grid must be "
                     "periodic. Positions may be wrapped or not.",
            start=f"Evenly stretched, $F = {F}$, with the stress $\\sigma = {stress}$ Pa, and moving with $v = {v}$ "
                  "m/s everywhere.",
            exact=f"Nothing happens: $u(X,t) = {v}\\,t$ in metres, $v = {v}$ m/s, $F = {F}$ and $\\sigma = {stress}$ "
                  "Pa for ever. Whatever the judge finds beyond round-off is the method's.",
            table="The points of the table lie along the bar, both ends among them.")

    def _of_vibration(self, scene: BarScene) -> Texts:
        A, w = f"{scene.motion_amplitude:.15g}", f"{scene.angular_frequency:.15g}"
        motion = rf"$$u(X,t) = {A}\,\sin(2\pi X)\sin(\omega t)$$"
        known = (f"{motion} in metres; velocity and acceleration are its derivatives in time, $F = 1 + u_X$, "
                 r"$\sigma = E(F - 1)$.")
        force = "none" if scene.body_force == "none" else "two-tone" if scene.body_force == "two-tone" else "material"
        size = "" if force == "none" else rf" with $A = {scene.amplitude:.15g}$ m and $\omega = {w}$ 1/s, in m/s²"
        return Texts(
            body="A bar of length 1 m and cross-section 1 m², in one dimension. A code of two or three dimensions "
                 "takes a row of cells between walls without friction, with Poisson's ratio 0.",
            material=rf"Linear in the stretch: $\sigma = E (F - 1)$ with $E = {scene.modulus:.15g}$ Pa, the nominal "
                     rf"and the "
                     f"Cauchy stress alike, for the cross-section stays as it is; density {scene.density:.15g} kg/m³. "
                     f"A rate "
                     r"form $\dot\sigma = E\,\partial v/\partial x$ gives $E \ln F$, which is another material: the "
                     r"difference is $E (F-1)^2/2$ and is judged as an error.",
            force=FORCES[force] + size + "." * (force != "none") + (f" {WHERE}" if force != "none" else ""),
            boundary="The bar is one period of an infinite one. Since the motion is odd about both ends, walls that "
                     "hold $u = 0$ at $X = 0$ and $X = 1$ m do the same; and since $u_X = 0$ at $X = -1/4$ and $X = "
                     "3/4$ m, so do free ends there, where particles with $X < 0$ are to be judged a metre further on "
                     "(the force of two tones has no such ends).",
            start=rf"At rest in shape ($F = 1$), moving with $v = {scene.amplitude * scene.angular_frequency:.15g}\,"
                  r"\sin(2\pi X)$ m/s." if force != "none" else
                  rf"At rest in shape ($F = 1$), moving with $v = "
                  rf"{scene.motion_amplitude * scene.angular_frequency:.15g}"
                  r"\,\sin(2\pi X)$ m/s.",
            exact=known + rf" $\omega = {w}$ 1/s." if scene.solution_known else
            "None is built in for the force of two tones.",
            table="The points of the table lie along the bar, both ends among them.")

    def table_points(self, scene: BarScene, count: int) -> np.ndarray:
        return np.linspace(0, 1, count)[:, None]

    def displacement(self, scene: BarScene, X: np.ndarray, t: float) -> np.ndarray:
        return exact.displacement(scene, X, t)

    def velocity(self, scene: BarScene, X: np.ndarray, t: float) -> np.ndarray:
        return exact.velocity(scene, X, t)

    def deformation_gradient(self, scene: BarScene, X: np.ndarray, t: float) -> np.ndarray:
        return exact.deformation_gradient(scene, X, t)[:, :, None]

    def stress(self, scene: BarScene, F: np.ndarray) -> np.ndarray:
        return scene.modulus * (F - 1)

    def body_force(self, scene: BarScene, X: np.ndarray, t: float) -> np.ndarray:
        return exact.body_force(scene, X, t)

    def along(self, quantity: str, X: np.ndarray, x: np.ndarray, values: np.ndarray) -> np.ndarray:
        return values.reshape(len(values))

    def misplaced(self, scene: BarScene, X: np.ndarray) -> np.ndarray:
        return (X[:, 0] < -SLACK) | (X[:, 0] > 1 + SLACK)

    def initial_deformation_gradient(self, scene: BarScene, X: np.ndarray) -> np.ndarray:
        return np.full((len(X), 1, 1), scene.initial_stretch)

    def unwrapped(self, scene: BarScene, X: np.ndarray, x: np.ndarray, t: np.ndarray) -> np.ndarray:
        """A code with a periodic grid may have moved a particle by the length of the bar, which no exact one moves but
        by the drift of a patch test."""
        drift = scene.initial_velocity * t[:, None] if scene.is_patch else 0.0
        turns = np.round(x - X - drift)
        return np.where(np.isfinite(turns) & (turns != 0), x - turns, x)

    def companion(self, scene: BarScene, fine: bool) -> ElasticBody:
        return BarCompanionBody(scene, FINE if fine else COARSE)


class BarCompanionBody(ElasticBody):
    """Elements around the period, as the companion's that runs beside the particles; here of a fixed number.

    A bar that begins stretched by F counts X from there: its density is rho/F, and its stress E F (1 + u_X) - E.
    """

    def __init__(self, scene: BarScene, count: int):
        self._scene, self._elements = scene, Elements(0.0, 1.0, count, ORDER)
        self._X = self._elements.nodes
        self._stiffness = self._elements.derivative.T @ (self._elements.weights[:, None] * self._elements.derivative)
        mass = self._elements.assembled_weights
        mass[0] = mass[-1] = mass[0] + mass[-1]  # the last node is the image of the first
        self._inverse_mass = 1 / (scene.density / scene.initial_stretch * mass)
        self.velocity = exact.velocity(scene, self._X, 0.0)[:, None]
        whole = np.eye(len(self._X))
        self.frequency = float(np.sqrt(np.abs(np.linalg.eigvals(
            np.stack([self._inverse_mass * self._pull(row) for row in whole], axis=1))).max()))

    def _pull(self, u: np.ndarray) -> np.ndarray:
        of_node = self._elements.of_node
        modulus = self._scene.modulus * self._scene.initial_stretch
        pull = modulus * np.bincount(of_node.ravel(), (u[of_node] @ self._stiffness).ravel())
        pull[0] = pull[-1] = pull[0] + pull[-1]
        return pull

    def accelerations(self, u: np.ndarray, t: float) -> np.ndarray:
        return (exact.body_force(self._scene, self._X, t) - self._inverse_mass * self._pull(u[:, 0]))[:, None]

    def read(self, u: np.ndarray, X: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        element, values, slopes = self._elements.locate(X[:, 0])
        local = u[self._elements.of_node[element], 0]
        return (np.einsum("pi,pi->p", values, local)[:, None],
                np.einsum("pi,pi->p", slopes, local)[:, None, None])


REFERENCE = BarReference()
