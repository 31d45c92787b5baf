"""A body and its run: everything that a file of a body defines, validated where it is made."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from solvers.bodies.connections import (
    ConstrainedLine,
    Side,
    boundary_corners,
    constrained_lines,
    equalize_counts,
    joined_sides,
)
from solvers.bodies.goal import Goal
from solvers.bodies.patch import CLAMPED, FREE, SIDES, SMALL, Patch, require_point
from solvers.motion import jets
from solvers.motion.formula import Formula, FormulaError, parse_formula
from solvers.motion.laws.elastic_material import LAWS, NEO_HOOKEAN, ElasticMaterial
from solvers.scene.validation import SceneError, require_choice, require_number, require_whole
from solvers.translatable_message import Message

HAT, METHODS = "mpm", ("cpdi", "ugimp", "cpgimp", "mpm")
MOST_POISSON = 0.49
LEAST, MOST = 1e-15, 1e15  # of numbers in SI units
MOST_PARTICLES, MOST_CELLS, MOST_STEPS, MOST_PATCHES, MOST_GOALS, MOST_PPC = 1_000_000, 2000, 10_000_000, 64, 20, 6
DEFAULT_CFL, MOST_CFL = 0.2, 1.0  # time step over that in which a wave crosses a cell
SAMPLES = 60  # of a run, at equal distances in time
WHOLE = 1e-6  # by which a number of cells or particles may miss a whole one
SPACE, SPACE_AND_TIME = ("X", "Y"), ("X", "Y", "t")
CORNER = 1.0  # degrees by which an angle may miss 90


@dataclass(frozen=True)
class Body:
    """Elastic body of ``patches`` in plane strain, its loads, and the MPM run; SI units, vectors as pairs (x, y).

    ``velocity`` (at t = 0, of X, Y) and ``force`` (per mass, of X, Y, t) are formulas; ``ppc`` counts particles per
    cell and direction; ``cfl`` is the time step over that in which a wave crosses a cell; ``domain`` has two opposite
    corners of the rectangle in which the body may move; ``elements_across`` counts the companions' elements over its
    narrowest patch, by default as many as a twentieth of the run's time allows.
    """

    patches: tuple[Patch, ...]
    youngs_modulus: float
    density: float
    poissons_ratio: float
    t_end: float
    domain: tuple[tuple[float, float], tuple[float, float]]
    gravity: tuple[float, float] = (0.0, 0.0)
    velocity: tuple[str, str] = ("0", "0")
    force: tuple[str, str] = ("0", "0")
    method: str = METHODS[0]
    cells_per_metre: float = 8
    ppc: int = 2
    cfl: float = DEFAULT_CFL
    elements_across: int | None = None
    goals: Mapping[str, Goal] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for name in ("youngs_modulus", "density", "t_end", "cells_per_metre"):
            require_number(name, getattr(self, name), LEAST, MOST)
        allowed = Message("give a number from 0 to {most}", MOST_POISSON)
        require_number("poissons_ratio", self.poissons_ratio, -1e-300, MOST_POISSON, allowed)
        require_choice("method", self.method, METHODS)
        require_whole("ppc", self.ppc, 1, MOST_PPC)
        require_number("cfl", self.cfl, 0, MOST_CFL)
        if self.elements_across is not None:
            require_whole("elements_across", self.elements_across, 1, 20)
        require_point("gravity", self.gravity, "m/s^2")
        self._check_patches()
        self._check_domain()
        self._check_tiling()
        self._check_formulas()
        for name, goal in self.goals.items():
            goal.validate(name, self.patches)

    @cached_property
    def joined(self) -> dict[Side, Side]:
        """For each side within the body the other patch's."""
        return joined_sides(self.patches)

    @cached_property
    def constrained_lines(self) -> tuple[ConstrainedLine, ...]:
        return constrained_lines(self.patches, self.joined)

    @property
    def material(self) -> ElasticMaterial:
        E, nu = self.youngs_modulus, self.poissons_ratio
        return ElasticMaterial(LAWS[NEO_HOOKEAN], E * nu / ((1 + nu) * (1 - 2 * nu)), 0.5 * E / (1 + nu))

    @property
    def wave_speed(self) -> float:
        """Speed of pressure waves at rest in m/s."""
        return math.sqrt((self.material.bulk + 2 * self.material.mu) / self.density)

    @property
    def spacing(self) -> float:
        """Width of a cell in m."""
        return 1 / self.cells_per_metre

    @property
    def time_step(self) -> float:
        """Longest time step in s; the run divides the time between samples into whole numbers of steps."""
        return self.cfl * self.spacing / self.wave_speed

    @cached_property
    def velocity_formulas(self) -> tuple[Formula, Formula]:
        return _parse_pair("velocity", self.velocity, SPACE)

    @cached_property
    def force_formulas(self) -> tuple[Formula, Formula]:
        return _parse_pair("force", self.force, SPACE_AND_TIME)

    @property
    def has_force(self) -> bool:
        """Whether a force beside gravity is given."""
        return self.force != ("0", "0")

    def initial_velocity(self, X: np.ndarray) -> np.ndarray:
        """Returns v (N, 2) in m/s at t = 0 at material points X (N, 2) in m."""
        return _evaluate(self.velocity_formulas, X)

    def body_force(self, X: np.ndarray, t: float) -> np.ndarray:
        """Returns gravity and force per mass (N, 2) in m/s^2 at material points X (N, 2) in m and t in s."""
        return _evaluate(self.force_formulas, X, t) + np.array(self.gravity, float)

    @cached_property
    def lattice_counts(self) -> np.ndarray:
        """Numbers of particles (K, 2) along xi and eta of each patch."""
        return equalize_counts(self.patches, self.joined, np.maximum(np.rint(self._particle_counts).astype(int), 1))

    @property
    def particles(self) -> int:
        """Number of particles."""
        return int(self.lattice_counts.prod(axis=1).sum())

    @property
    def particle_steps(self) -> float:
        """Number of particles times that of steps of the whole run."""
        return self.particles * self.t_end / self.time_step

    @property
    def _particle_counts(self) -> np.ndarray:
        """Numbers of particles (K, 2) that fit along xi and eta of each patch, whole or not."""
        return self.mean_lengths * (self.ppc * self.cells_per_metre)

    @property
    def mean_lengths(self) -> np.ndarray:
        """Mean lengths (K, 2) in m of each patch's two sides along xi and of those along eta."""
        return np.array([[0.5 * (patch.side_length(side) + patch.side_length(side + 2)) for side in (0, 1)]
                         for patch in self.patches])

    @cached_property
    def singular_corners(self) -> list[float]:
        """Angles in degrees of corners with infinite stresses: re-entrant, or of a clamped and a free side."""
        return [angle for angle, kinds in boundary_corners(self.patches, self.joined)
                if angle > 180 + CORNER or kinds == {CLAMPED, FREE}]

    @property
    def has_known_corners(self) -> bool:
        """Whether all singular corners are right angles of a clamped and a free side, where stresses grow alike."""
        return bool(self.singular_corners) and all(abs(angle - 90) < CORNER for angle in self.singular_corners)

    def warnings(self) -> list[str]:
        """Returns sentences on what makes the run or its estimate doubtful from the start."""
        said: list[str] = []
        if self.method == HAT:
            said.append(Message("hat functions break numerically where particles cross cells, within a thirtieth of "
                                "most motions; take cpdi, ugimp or cpgimp"))
        if self.singular_corners and not self.has_known_corners:
            said.append(Message("stresses are infinite at a corner of {angle:.0f} degrees: companions converge slowly "
                                "there, and only where a clamped side meets a free one at 90 degrees their error is "
                                "extrapolated away", max(self.singular_corners, key=lambda angle: abs(angle - 90))))
        if self._has_fronts():
            said.append(Message("the initial velocity strains free sides, so waves with steep fronts start there; "
                                "estimates of v and sigma are less accurate than those of x"))
        return said

    def _check_patches(self) -> None:
        if not isinstance(self.patches, tuple) or not 1 <= len(self.patches) <= MOST_PATCHES:
            raise SceneError("patch", "", "give 1 to {most} patches, each as [[patch]]", MOST_PATCHES)
        for number, patch in enumerate(self.patches, 1):
            patch.validate(number)
        for line in self.constrained_lines:
            cells = line.position * self.cells_per_metre
            if abs(cells - round(cells)) > WHOLE:
                raise SceneError("cells_per_metre", self.cells_per_metre, "puts the {kind} side at {axis} = {at:g} m "
                                 "between two lines of the grid; give a number with which it lies on one", line.kind,
                                 "xy"[line.axis], line.position)

    def _check_domain(self) -> None:
        if not isinstance(self.domain, tuple) or len(self.domain) != 2:
            raise SceneError("domain", self.domain, "give two opposite corners: [[x, y], [x, y]]")
        for corner in self.domain:
            require_point("domain", corner)
        low, high = np.array(self.domain, float)
        edge = np.linspace(0, 1, 33)
        X = np.concatenate([patch.points_on_side(side, edge) for patch in self.patches for side in range(4)])
        if (X < low - SMALL).any() or (X > high + SMALL).any():
            raise SceneError("domain", self.domain, "does not contain the body; give its lower left and upper right "
                             "corners, with room for the motion")
        if (cells := float((high - low).max()) * self.cells_per_metre) > MOST_CELLS:
            raise SceneError("domain", self.domain, "is {cells:,.0f} cells long; at most {most:,} are allowed", cells,
                             MOST_CELLS)
        if (steps := self.t_end / self.time_step) > MOST_STEPS:
            raise SceneError("t_end", self.t_end, "takes {steps:,.0f} steps; at most {most:,} are allowed", steps,
                             MOST_STEPS)

    def _check_tiling(self) -> None:
        wanted = self._particle_counts
        for number, (patch, counts) in enumerate(zip(self.patches, wanted, strict=True), 1):
            if not patch.arc and _is_rectangle(patch) and np.abs(counts - np.rint(counts)).max() > WHOLE:
                raise SceneError("cells_per_metre", self.cells_per_metre, "makes patch {number} {first:.4g} by "
                                 "{second:.4g} particles wide; give a number with which whole particles tile it",
                                 number, counts[0], counts[1])
        particles = np.prod(np.maximum(wanted, 1), axis=1).sum()
        if particles > MOST_PARTICLES:
            raise SceneError("cells_per_metre", self.cells_per_metre, "makes {particles:,.0f} particles; at most "
                             "{most:,} are allowed", particles, MOST_PARTICLES)

    def _check_formulas(self) -> None:
        grid = np.linspace(0, 1, 9)
        xi, eta = (one.ravel() for one in np.meshgrid(grid, grid))
        X = np.concatenate([patch.place(xi, eta) for patch in self.patches])
        for name, values in (("velocity", [self.initial_velocity(X)]),
                             ("force", [self.body_force(X, part * self.t_end) for part in (0.0, 0.37, 1.0)])):
            if not np.isfinite(values).all():
                raise SceneError(name, ", ".join(getattr(self, name)), "is not finite everywhere in the body")
        still = WHOLE * max(1e-300, float(np.abs(self.initial_velocity(X)).max()))
        for k, patch in enumerate(self.patches):
            for side, kind in enumerate(patch.sides):
                v = self.initial_velocity(patch.points_on_side(side, grid))[:, patch.constrained_axes(side)]
                if v.size and np.abs(v).max() > still:
                    raise SceneError("velocity", ", ".join(self.velocity), "moves the {kind} side {side} of patch "
                                     "{number}; give one that is zero there", kind, SIDES[side], k + 1)

    def _has_fronts(self) -> bool:
        sides = [patch.points_on_side(side, np.linspace(0, 1, 9)) for k, patch in enumerate(self.patches)
                 for side, kind in enumerate(patch.sides) if kind == FREE and (k, side) not in self.joined]
        if not sides:
            return False
        X, Y, _ = jets.variables(*np.concatenate(sides).T, 0.0)  # type: ignore[call-arg]
        u, v = (formula({"X": X, "Y": Y}) for formula in self.velocity_formulas)
        rates = [_slope(u, 0), _slope(v, 1), _slope(u, 1) + _slope(v, 0)]
        size = max(float(np.max(np.abs(_slope(one, k)))) for one in (u, v) for k in (0, 1))
        return max(float(np.max(np.abs(rate))) for rate in rates) > 1e-9 * max(size, 1e-300)


def _slope(value: object, axis: int) -> np.ndarray:
    return np.asarray(value.derivative(axis) if isinstance(value, jets.Jet) else 0.0)


def _is_rectangle(patch: Patch) -> bool:
    """Whether a patch without arcs is a rectangle along the axes."""
    (ax, ay), (bx, by), (cx, cy), (dx, dy) = patch.corners
    near = SMALL * patch.size
    straight = max(abs(ay - by), abs(bx - cx), abs(cy - dy), abs(dx - ax)) < near
    return straight or max(abs(ax - bx), abs(by - cy), abs(cx - dx), abs(dy - ay)) < near


def _parse_pair(name: str, texts: object, names: tuple[str, ...]) -> tuple[Formula, Formula]:
    if not isinstance(texts, tuple) or len(texts) != 2 or not all(isinstance(text, str) for text in texts):
        raise SceneError(name, texts, 'give two formulas in quotes, such as ["0", "2*X"]')
    try:
        first, second = (parse_formula(text, names)[1] for text in texts)
    except FormulaError as error:
        raise SceneError(name, ", ".join(texts), "{error}", error.args[0]) from None
    return first, second


def _evaluate(formulas: tuple[Formula, Formula], X: np.ndarray, t: float = 0.0) -> np.ndarray:
    values = {"X": X[:, 0], "Y": X[:, 1], "t": t}
    with np.errstate(all="ignore"):
        return np.stack([np.broadcast_to(np.asarray(formula(values), float), len(X)) for formula in formulas], axis=1)
