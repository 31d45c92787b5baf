"""BoxScene: base class of plane problems on a square between symmetry planes, each defined by its displacement."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass

import numpy as np

from solvers.estimators.spectral_elements import Elements
from solvers.motion.laws.elastic_material import LAWS, NEO_HOOKEAN
from solvers.motion.separable_field import SeparableField, separate
from solvers.problems.planar.estimators.companion_patch import CARTESIAN, CompanionPatch
from solvers.problems.planar.scene import GHOSTS, PlanarScene, motion_table
from solvers.scene.displacement_moments import MODES, DisplacementMoments
from solvers.scene.estimator_limits import Limit
from solvers.scene.estimator_registry import HALF_REASON, MOVING_WEIGHTS, REMEDIES_REASON
from solvers.scene.field_options import option
from solvers.scene.stabilisations import COUPLED, FILTER, FROZEN
from solvers.scene.validation import require_number
from solvers.translatable_message import Message

LINE, INSTANTS = 24, 16  # points a side and times of a period at which the motion is evaluated
NEWTON_STEPS, NEWTON_END = 20, 1e-9  # for the material point at a node; tolerance in m, with quadratic convergence
FINE_ORDER = 7  # order of the companion's elements beside another code, on the finer of two meshes
#: Of the companion: from how many cells on, elements a side, and their order; the last are for motions of short waves.
COMPANION_ELEMENTS = ((0, 3, 5), (25, 4, 5), (65, 4, 6), (math.inf, 6, 6), (math.inf, 8, 6), (math.inf, 10, 6))
STILL, FAR = 0.05, 1.4  # cells that particles move: their place in a cell hardly changes, or often
TEST_POINTS = 7  # an element, at which a mesh is held against the displacement
MAX_UNRESOLVED = 3e-4  # of the displacement: RMS that a mesh may leave out


@dataclass(frozen=True)
class BoxScene(PlanarScene):
    """Scene on the unit square between four symmetry planes. Subclasses define ``displacement_at`` and more."""

    method: str = option("cpdi", "Shape functions of the particles", choices=("ugimp", "cpgimp", "cpdi", "mpm"))
    cells: int = option(32, "Cells of the grid along a side; h = 1 m / cells")
    ppc: int = option(2, "Particles per cell and direction")
    modulus: float = option(1e7, "Young's modulus E", "Pa")
    poisson_ratio: float = option(0.3, "Poisson's ratio")
    law: str = option(NEO_HOOKEAN, "Law of the material", choices=tuple(LAWS))
    density: float = option(1000.0, "Density", "kg/m3")
    body_force: str = option("material", "Body force: at material points, or none; only the first has a built-in "
                             "solution", choices=("material", "none"))
    linearity_preserving: bool = option(False, "Not offered here: only off is accepted")
    plan: str = option("auto", "How the step is spread over the threads; auto takes the faster one for the number of "
                       "particles", choices=("auto", "serial", "parallel"))

    layout = "box"
    SIDE, INNER, OUTER, ANGLE = 1.0, 0.0, 1.0, 0.5 * math.pi
    PLANES = (True, True)
    ESCAPE_SENTENCE = Message("left the square (it is a cell or more beyond a plane)")
    ESTIMATORS = ("transport", "recovered", "companion", "two-grid")
    LIMITS = (
        MOVING_WEIGHTS,
        # Measured: its estimates are 1e-10 to 1e-5 of the errors.
        Limit("transport", "method", allowed=("mpm", "ugimp", "cpgimp"), why="the terms of transport nearly vanish for "
              "CPDI, whose domains tile the square, so that its estimate is almost zero; take recovered or companion"),
        # Recovered: fits lose waves as short as four of them. On 120 squares: x .77 to .94 below, .95 to 1.05 beyond.
        Limit("recovered", "cells", least=28, where={"ppc": 1}, why="recovered fits single particles per cell over "
              "seven cells, which blurs the motion itself on so few; give {least} cells or more particles per cell"),
        Limit("recovered", "cells", least=12, why="recovered's fits over four cells blur the motion itself on so few; "
              "give {least} cells or more"),
        # Two-grid: Richardson's argument needs an error that falls like h^2. Measured on 70 squares: x .93 to 1.1
        # within these limits, .66 to .88 where particles move a part of a cell.
        Limit("two-grid", "remedies", allowed=(FILTER,), why=REMEDIES_REASON),
        Limit("two-grid", "method", allowed=("cpdi", "cpgimp", "ugimp"), why="hats have a quadrature error that "
              "depends on the position of a particle in its cell and does not fall with the cell size; take CPDI"),
        Limit("two-grid", "ppc", least=2, why="one particle per cell is too coarse a quadrature: its error depends on "
              "the position in the cell; give two or more"),
        Limit("two-grid", "cells", least=12, impossible=True, why=HALF_REASON),
        Limit("two-grid", "cells", least=28, why=HALF_REASON),
        Limit("two-grid", "motion_amplitude", most=STILL, of="spacing", where={"method": "ugimp"}, why="boxes that do "
              "not follow the material leave an error that does not fall with the cell size; take CPDI"),
        Limit("two-grid", lambda scene: STILL < scene.motion_amplitude / scene.spacing < FAR, allowed=(False,),
              why=Message("particles that move between {still:g} and {far:g} cells are in different parts of their "
                          "cells on the two grids, so the errors are not comparable; take another amplitude or number "
                          "of cells", STILL, FAR)))
    REMEDIES = (FILTER, COUPLED, FROZEN)
    FEWEST_CELLS = 8
    DEFAULT_PERIODS = 1.0
    SAMPLES_A_PERIOD = 50
    NOT_LINEARITY_PRESERVING = Message("is not offered here; leave it off")
    MENDS = Message("the others correct")
    MOST_AMPLITUDE = math.inf

    @staticmethod
    def lattice_counts(cells: int, ppc: int) -> tuple[int, int]:
        return cells * ppc, cells * ppc

    @classmethod
    def draw_point(cls, chance: np.random.Generator) -> tuple[float, float]:
        return chance.uniform(0, cls.SIDE), chance.uniform(0, cls.SIDE)

    @property
    def row(self) -> int:
        return self.cells + 1 + 2 * GHOSTS

    @property
    def farthest(self) -> float:
        return self.SIDE + self.spacing

    @functools.cached_property
    def wave_angle_per_metre(self) -> float:
        """Largest speed of waves along x or y in the material frame, anywhere in the motion, over that at rest."""
        rate = 1.0
        for t in (np.arange(INSTANTS) + 0.5) / INSTANTS * self.period:
            F = self.EXACT.deformation_gradient(self, self._evaluation_points, t)
            back = np.linalg.inv(F)
            rate = max(rate, *(self.material.max_frequency_factor(F.reshape(-1, 4).T, (F[:, :, k] ** 2).sum(axis=1),
                                                                  (back[:, k] ** 2).sum(axis=1)) for k in (0, 1)))
        return rate

    def warnings(self) -> list[str]:
        if self.law == NEO_HOOKEAN or self.least_stiffness > 0:
            return super().warnings()
        return [*super().warnings(), Message("law {law}: not elliptic along the whole exact motion: waves in some "
                                             "direction have a stiffness of {least:.2g} mu, and shorter waves grow "
                                             "faster; choose a smaller amplitude, or neo-hookean", self.law,
                                             self.least_stiffness)]

    @functools.cached_property
    def least_stiffness(self) -> float:
        """Smallest stiffness of waves in any direction, anywhere along the exact motion, over the shear modulus."""
        F = (self.EXACT.deformation_gradient(self, self._evaluation_points,
                                             t) for t in np.arange(LINE) / LINE * self.period)
        return min(self.material.least_wave_stiffness(one.reshape(-1, 4).T) for one in F)

    def node_acceleration_field(self) -> SeparableField:
        """Returns the exact acceleration in m/s^2 of the material at the nodes (row^2, row by row), for any time."""
        line = (np.arange(self.row) - self.origin) * self.spacing
        return separate(lambda x, t: self.EXACT.acceleration(self, x if self.frozen else self._invert_motion(x, t), t),
                        np.stack(np.meshgrid(line, line), axis=-1).reshape(-1, 2), self.period)

    def _invert_motion(self, x: np.ndarray, t: np.ndarray) -> np.ndarray:
        """Returns the material points X (n, 2) in m that the exact motion brings to x (n, 2) at times t (n,), in s."""
        X = x.copy()
        for _ in range(NEWTON_STEPS):
            F = self.EXACT.deformation_gradient(self, X, t)
            step = np.linalg.solve(F, (self.EXACT.position(self, X, t) - x)[..., None])[..., 0]
            X -= step
            if np.abs(step).max() < NEWTON_END:
                break
        return X

    @functools.cached_property
    def _largest_and_rms(self) -> dict[str, tuple[float, float]]:
        """Largest size and RMS of "x" (u), "v", "sigma" and "a", in SI units, over the body and a period."""
        return {name: (float(np.sqrt(squares.max())), float(np.sqrt(squares.mean())))
                for name, squares in self.exact_squares(self._evaluation_points, INSTANTS).items()}

    @property
    def _evaluation_points(self) -> np.ndarray:
        """Material points (n, 2) in m, throughout the body, at which the exact motion is evaluated."""
        line = np.linspace(0, self.SIDE, LINE + 1)
        return np.stack(np.meshgrid(line, line), axis=-1).reshape(-1, 2)

    @property
    def motion_amplitude(self) -> float:
        """Largest displacement of the exact solution, in m."""
        return self.size_of("x")

    def size_of(self, quantity: str) -> float:
        return self._largest_and_rms[quantity][0]

    def rms_of(self, quantity: str) -> float:
        return self._largest_and_rms[quantity][1]

    def companion_body(self, fine: bool | None) -> CompanionPatch:
        """Returns the companion's body, with as many elements as the motion needs, of higher order if ``fine``."""
        usual = max(k for k, (fewest_cells, *_) in enumerate(COMPANION_ELEMENTS) if fewest_cells <= self.cells)
        for _, count, own_order in COMPANION_ELEMENTS[usual:]:
            line = Elements(0.0, self.SIDE, count, FINE_ORDER if fine else own_order)
            if self._unresolved_part(line) <= MAX_UNRESOLVED:
                break
        return CompanionPatch(self, (line, line), CARTESIAN,
                              lambda X: np.any([np.abs(X - end) < 1e-12 * self.SIDE for end in (0.0, self.SIDE)],
                                               axis=0))

    def _unresolved_part(self, line: Elements) -> float:
        """Returns the part of the exact displacement that elements like ``line`` in x and y omit: a ratio of RMS over
        body and period."""
        between = (np.arange(TEST_POINTS * line.count) + 0.5) / (TEST_POINTS * line.count) * self.SIDE
        element, values, _ = line.evaluate_basis(between)
        basis = np.zeros((len(between), len(line.node_coordinates)))
        np.put_along_axis(basis, line.node_of_point[element], values, axis=1)
        at_nodes, there = (np.stack(np.meshgrid(x, x, indexing="ij"), axis=-1).reshape(-1, 2)
                           for x in (line.node_coordinates, between))
        missed = squares = 0.0
        for t in (np.arange(INSTANTS) + 0.5) / INSTANTS * self.period:
            u = self.EXACT.displacement(self, at_nodes, t).reshape(len(line.node_coordinates),
                                                                   len(line.node_coordinates), 2)
            exact = self.EXACT.displacement(self, there, t)
            missed += float(((np.einsum("ai,bj,ijc->abc", basis, basis, u).reshape(-1, 2) - exact) ** 2).sum())
            squares += float((exact**2).sum())
        return math.sqrt(missed / squares)

    def momentum_balance_moments(self, times: np.ndarray) -> DisplacementMoments:
        """Returns the exact motion's moments with its own modes at the ``times`` (T,) in s."""
        if not self.solution_known:
            return DisplacementMoments(np.zeros((len(times), MODES)), np.zeros(len(times)), np.eye(MODES),
                                       self.particles, np.zeros(len(times), bool))
        motion, gram = motion_table(self), mode_gram_matrix(self)
        T = np.stack([motion.time_functions(float(t)) for t in times])
        few = min(MODES, motion.rank)
        sums, inverse = np.zeros((len(times), MODES)), np.zeros((MODES, MODES))
        sums[:, :few] = T @ gram[:, :few]
        inverse[:few, :few] = np.linalg.pinv(gram[:few, :few], hermitian=True)
        return DisplacementMoments(sums, np.einsum("tk,kl,tl->t", T, gram, T), inverse, self.particles,
                                   np.ones(len(times), bool))

    def _check_amplitude(self) -> None:
        require_number("amplitude", self.amplitude, 1e-12, self.MOST_AMPLITUDE)


@functools.lru_cache(maxsize=2)
def mode_gram_matrix(scene: BoxScene) -> np.ndarray:
    """Returns sum_p u_k . u_l (r, r), over particles p, of the displacements u_k of the exact motion's r modes."""
    u = motion_table(scene).modes[:, :, :2]
    return np.einsum("pkc,plc->kl", u, u)
