"""PlanarScene: base class of plane problems, each defined by a displacement from which everything else is derived.

The displacement is a formula with the functions of ``solvers.motion.jets``: of u itself, never of x = X + u, whose
difference would cancel small motions.
"""

import functools
import math
from abc import abstractmethod
from typing import Any, ClassVar

import numpy as np

from solvers.estimators.standalone_companion import ElasticBody
from solvers.motion.exact_solution import ExactSolution, stack_components
from solvers.motion.laws.elastic_material import LAWS, NEO_HOOKEAN, ElasticMaterial
from solvers.motion.separable_field import SeparableField, separate
from solvers.problems.planar import step_bound
from solvers.problems.planar.particle_layout import particle_layout
from solvers.scene.scene import Scene
from solvers.scene.stabilisations import COUPLED
from solvers.scene.step_bound import StepBound
from solvers.scene.validation import SceneError, require_number, require_whole
from solvers.translatable_message import Message

MOST_CELLS = 10_000
GHOSTS = 2  # rows of nodes beyond a symmetry plane


class PlanarScene(Scene):
    """Definition of a run of a plane body; no dataclass, because that would turn its class variables into fields."""

    layout: str  # the lattice on which particles begin: "polar", "cartesian" or "box"
    ppc: int  # per direction
    plan: str  # how the step is spread over the threads
    law: str = NEO_HOOKEAN  # of the material

    DIMENSIONS = 2
    EXTRA_ERROR = "a_nodes"
    EXACT: ClassVar[ExactSolution]  # with the built-in force
    SIDE: ClassVar[float]  # of the grid, m
    INNER: ClassVar[float]  # radii of the rims, m
    OUTER: ClassVar[float]
    ANGLE: ClassVar[float]  # that the body fills from the x axis on, in radians
    PLANES: ClassVar[tuple[bool, bool]]  # whether symmetry planes are at the lower and at the upper ends of x and y
    CIRCULAR: ClassVar[bool] = False  # whether the motion is the same all around
    DIRECTION: ClassVar[str] = ""  # in which a circular one moves: "radial" or "angular"
    VOLUMETRIC: ClassVar[bool] = True  # whether lambda may be other than 0, which costs a logarithm a particle and step
    #: Time steps before t = 0 to which the initial velocity belongs. Symplectic Euler is the leapfrog scheme: where
    #: a(0) is not zero, a run that begins with v(0) is only first-order in the step.
    EARLIER: ClassVar[float] = 0.5
    EXTREMES: ClassVar[tuple[float, float]] = (0.0, 1.0)  # periods between which the motion takes on all its shapes
    FARTHEST_MOVE: ClassVar[float] = math.inf  # amplitudes that a particle of a sound run may be from where it began
    COARSE_BELOW: ClassVar[int] = 0  # cells, of which recovered's fits over four are too wide for the acceleration
    BEYOND_RIMS: ClassVar[bool] = False  # whether the displacement's formula is of use there, to grid nodes
    #: Of the companion of a body whose motion is the same all around: up to so many cells, elements across, order.
    COMPANION_MESHES: ClassVar[tuple[tuple[float, int, int], ...]]
    ESCAPE_SENTENCE: ClassVar[str]  # description of a particle beyond the limits, as the end of a sentence
    NOT_LINEARITY_PRESERVING: ClassVar[str]  # why, as the end of a sentence
    MENDS: ClassVar[str]  # the effects of other remedies that frozen weights do not need

    @abstractmethod
    def displacement_at(self, X: Any, Y: Any, t: Any) -> tuple[Any, Any]:
        """Returns u_x and u_y in m at material points (X, Y) in m and times t in s: numbers, arrays or jets."""

    def __init_subclass__(cls, **kwargs: Any) -> None:
        super().__init_subclass__(**kwargs)
        if "displacement_at" in vars(cls):
            cls.EXACT = ExactSolution(cls.displacement_at)

    @staticmethod
    @abstractmethod
    def lattice_counts(cells: int, ppc: int) -> tuple[int, int]:
        """Returns the numbers of particles (around, across) in a lattice whose domains are about h/ppc wide."""

    @classmethod
    @abstractmethod
    def draw_point(cls, chance: np.random.Generator) -> tuple[float, float]:
        """Returns a random material point in the body, in m."""

    @property
    @abstractmethod
    def farthest(self) -> float:
        """Largest absolute coordinate of a particle in a sound run, in m."""

    @abstractmethod
    def node_acceleration_field(self) -> SeparableField:
        """Returns, for any time, the exact acceleration at nodes in m/s^2, or on circles displacements in m to derive
        it from: see ``solvers.problems.planar.method.node_acceleration_errors``."""

    @abstractmethod
    def companion_body(self, fine: bool | None) -> ElasticBody:
        """Returns the body that the companion solves: with ``fine`` None for a run; for particles of another code on a
        fine mesh or a coarser one (True, False)."""

    def exact_squares(self, X: np.ndarray, instants: int) -> dict[str, np.ndarray]:
        """Returns the exact motion's squared sizes (instants, P) of "x" (u), "v", "sigma" and "a", in SI units, at
        material points X (P, 2), m, and ``instants`` times of a period: of vectors, and Frobenius norms of tensors."""
        exact = self.EXACT
        fields = {"x": (exact.displacement, (1, 1)), "v": (exact.velocity, (1, 1)), "sigma": (exact.stress, (1, 2, 1)),
                  "a": (exact.acceleration, (1, 1))}
        times = (np.arange(instants) + 0.5) / instants * self.period
        return {name: np.stack([field(self, X, t) ** 2 @ np.array(weights) for t in times])
                for name, (field, weights) in fields.items()}

    @property
    def solution_known(self) -> bool:
        """Whether an exact solution is built in: only with its own body force, without which the motion is unknown."""
        return self.body_force == "material"

    @property
    def spacing(self) -> float:
        """Cell size h, in m."""
        return self.SIDE / self.cells

    @property
    def row(self) -> int:
        """Number of nodes in a row of the grid, including those beyond symmetry planes."""
        return self.cells + 1

    @property
    def origin(self) -> float:
        """Index of the node at x = 0, fractional between two nodes."""
        return float(GHOSTS) if self.PLANES[0] else 0.5 * self.cells

    @property
    def active_rows(self) -> int:
        """Number of rows of nodes, from the lower end, that can have mass in a sound run."""
        return self.row

    @property
    def particles(self) -> int:
        """Number of particles; in the Cartesian layout of a ring there are nearly as many."""
        return math.prod(self.lattice_counts(self.cells, self.ppc))

    @property
    def lame_moduli(self) -> tuple[float, float]:
        """Moduli lambda and mu in Pa in plane strain, from E and Poisson's ratio, which is 0 where there is none."""
        nu = getattr(self, "poisson_ratio", 0.0)
        mu = 0.5 * self.modulus / (1 + nu)
        return 2 * mu * nu / (1 - 2 * nu), mu

    @functools.cached_property
    def material(self) -> ElasticMaterial:
        return ElasticMaterial(LAWS[self.law], *self.lame_moduli)

    @property
    def wave_speed(self) -> float:
        """Speed of pressure waves in the material at rest, in m/s."""
        bulk, mu = self.lame_moduli
        return math.sqrt((bulk + 2 * mu) / self.density)

    def critical_time_step(self) -> StepBound:
        return step_bound.critical_time_step(self)

    @property
    def is_uneven(self) -> bool:
        """Whether particles are so uneven that recovered's fits follow them, so that only x and v can be estimated.

        Measured on 14 such ring runs: sigma 1.06 to 5.6 times the error, x .97 to 1.06 while the verdict trusts it.
        """
        return self.ppc == 1 or self.velocity == "particle"

    @property
    def is_coarse(self) -> bool:
        """Whether cells are so wide that recovered's fits lose short waves of the acceleration, which it then omits."""
        return self.cells < self.COARSE_BELOW

    def warnings(self) -> list[str]:
        sentences = super().warnings()
        if "recovered" in self.active_estimators and self.is_uneven:
            sentences.append(Message("recovered does not estimate sigma and a here: with one particle per cell or the "
                                     "particle velocity, its fits follow the uneven spacing"))
        elif "recovered" in self.active_estimators and self.is_coarse:
            sentences.append(Message("recovered does not estimate a here: on so few cells its fits are as wide as the "
                                     "ring and lose a third of it or more"))
        if "two-grid" in self.active_estimators:
            sentences.append(Message("two-grid does not estimate a in the plane: its error is noise of a cell's "
                                     "length, in different places on the two grids"))
        return sentences

    def _check_combinations(self) -> None:
        require_whole("ppc", self.ppc, 1, 6)
        if self.cells > MOST_CELLS:
            raise SceneError("cells", self.cells, "give a whole number from {least} to {most:,}", self.FEWEST_CELLS,
                             MOST_CELLS)
        if self.linearity_preserving:
            raise SceneError("linearity_preserving", True, self.NOT_LINEARITY_PRESERVING)
        if self.frozen and len(self.remedies) > 1:
            raise SceneError("remedies", " ".join(self.remedies), "frozen-weights cannot be combined: {mends} errors "
                             "of particles that move through the grid; leave one of the two out", self.MENDS)
        self._check_remedies()
        if self.plan == "serial" and self.threads > 1:
            raise SceneError("threads", self.threads,
                             "the serial plan runs on one; give 1, or the plan parallel or auto")
        if self.prefers_gpu and self.plan != "auto":
            raise SceneError("plan", self.plan, "is for CPUs, and a GPU has its own plan; give auto, or --arch cpu")

    def _check_remedies(self) -> None:
        """Raises :class:`SceneError` for a stabilisation that harms the scene's method."""
        if COUPLED in self.remedies and self.method == "cpdi":
            raise SceneError("remedies", " ".join(self.remedies), "coupled-deformation makes CPDI worse, because its "
                             "domains follow the deformation; give null-space-filter or frozen-weights")

    def _check_numbers(self) -> None:
        super()._check_numbers()
        require_number("poisson_ratio", getattr(self, "poisson_ratio", 0.0), -0.9, 0.49)


@functools.lru_cache(maxsize=2)
def motion_table(scene: PlanarScene) -> SeparableField:
    """Returns u_x, u_y (m), and Grad u as xX, xY, yX, yY, of the exact motion as a function of time: (K, 6) at the
    points that represent the orbits of particles."""
    def field(X: np.ndarray, t: np.ndarray) -> np.ndarray:
        return stack_components(scene.EXACT.jets(scene, X, t).displacement_and_gradient, len(X))

    return separate(field, particle_layout(scene).orbits, scene.period)
