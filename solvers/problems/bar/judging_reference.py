"""Reference of the bar for other codes."""

from pathlib import Path

import numpy as np

from solvers.estimators.spectral_elements import Elements
from solvers.estimators.standalone_companion import ElasticBody
from solvers.problems.bar import exact_solution
from solvers.problems.bar.scene import BarScene
from solvers.problems.judging_reference import InitialParticles, JudgingReference, ProblemDescription, read_texts

FOLDER = Path(__file__).parent
POSITION_TOLERANCE = 1e-6  # m, by which a material point may lie beyond an end: single precision rounds
FINE, COARSE = 16, 12  # elements of the companion, of order ORDER
ELEMENT_ORDER = 6


class BarJudgingReference(JudgingReference):
    """Reference of the vibrating bar and its patch test for other codes: start, texts, exact fields and companion."""

    EXACT = exact_solution

    def start(self, scene: BarScene) -> InitialParticles:
        X = (np.arange(scene.particles) + 0.5) * (scene.spacing / scene.ppc)
        return InitialParticles(X[:, None], np.full(len(X), scene.spacing / scene.ppc))

    def texts(self, scene: BarScene) -> ProblemDescription:
        E, density, w = scene.modulus, scene.density, scene.angular_frequency
        if scene.is_patch:
            F = scene.stretch
            return read_texts(FOLDER / "patch.md", "", E=E, density=density, F=F, v=scene.initial_velocity,
                              length=1 / F, stretched_density=density / F, stress=E * (F - 1))
        typed = scene.displacement
        A, w = (scene.amplitude, scene.base_frequency) if scene.motion_formula else (scene.motion_amplitude, w)
        return read_texts(FOLDER / "vibration.md", "typed" if typed else scene.body_force, E=E, density=density, A=A,
                          w=w, speed=A * w, formula=typed)

    def table_points(self, scene: BarScene, count: int) -> np.ndarray:
        return np.linspace(0, 1, count)[:, None]

    def stress(self, scene: BarScene, F: np.ndarray) -> np.ndarray:
        return scene.modulus * (F - 1)

    def body_force(self, scene: BarScene, X: np.ndarray, t: float) -> np.ndarray:
        return exact_solution.body_force(scene, X, t)

    def is_outside(self, scene: BarScene, X: np.ndarray) -> np.ndarray:
        return (X[:, 0] < -POSITION_TOLERANCE) | (X[:, 0] > 1 + POSITION_TOLERANCE)

    def initial_deformation_gradient(self, scene: BarScene, X: np.ndarray) -> np.ndarray:
        return np.full((len(X), 1, 1), scene.initial_stretch)

    def unwrap_positions(self, scene: BarScene, X: np.ndarray, x: np.ndarray, t: np.ndarray) -> np.ndarray:
        """Returns positions (T, P) in m without jumps: a periodic code may move particles by the length of the bar, the
        exact motion moves none that far beyond a patch test's drift."""
        drift = scene.initial_velocity * t[:, None] if scene.is_patch else 0.0
        turns = np.round(x - X - drift)
        return np.where(np.isfinite(turns) & (turns != 0), x - turns, x)

    def companion(self, scene: BarScene, fine: bool) -> ElasticBody:
        waves = scene.highest_harmonic
        return BarCompanionBody(scene, max(FINE, 4 * waves) if fine else max(COARSE, 3 * waves))


class BarCompanionBody(ElasticBody):
    """Elastic body of ``count`` spectral elements around the period, for a companion that is solved without a run.

    A bar that begins stretched by F counts X from there: its density is rho/F, and its stress E F (1 + u_X) - E.
    """

    def __init__(self, scene: BarScene, count: int):
        self._scene, self._elements = scene, Elements(0.0, 1.0, count, ELEMENT_ORDER)
        self._X = self._elements.node_coordinates
        self._stiffness = self._elements.derivative.T @ (self._elements.weights[:, None] * self._elements.derivative)
        mass = self._elements.assembled_weights
        mass[0] = mass[-1] = mass[0] + mass[-1]  # the last node is the image of the first
        self._inverse_mass = 1 / (scene.density / scene.initial_stretch * mass)
        self.velocity = exact_solution.velocity(scene, self._X, 0.0)[:, None]
        whole = np.eye(len(self._X))
        self.frequency = float(np.sqrt(np.abs(np.linalg.eigvals(
            np.stack([self._inverse_mass * self._internal_forces(row) for row in whole], axis=1))).max()))

    def _internal_forces(self, u: np.ndarray) -> np.ndarray:
        of_node = self._elements.node_of_point
        modulus = self._scene.modulus * self._scene.initial_stretch
        pull = modulus * np.bincount(of_node.ravel(), (u[of_node] @ self._stiffness).ravel())
        pull[0] = pull[-1] = pull[0] + pull[-1]
        return pull

    def accelerations(self, u: np.ndarray, t: float) -> np.ndarray:
        pull = self._inverse_mass * self._internal_forces(u[:, 0])
        return (exact_solution.body_force(self._scene, self._X, t) - pull)[:, None]

    def values_and_gradients(self, u: np.ndarray, X: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        element, values, slopes = self._elements.evaluate_basis(X[:, 0])
        local = u[self._elements.node_of_point[element], 0]
        return (np.einsum("pi,pi->p", values, local)[:, None], np.einsum("pi,pi->p", slopes, local)[:, None, None])


REFERENCE = BarJudgingReference()
