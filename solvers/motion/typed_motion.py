"""Motion typed by a user, and its conditions: it must be possible for a square between planes, or a bar."""

import functools
from typing import Any, NamedTuple

import numpy as np

from solvers.motion.exact_solution import ExactSolution
from solvers.motion.exact_solution_1d import ExactSolution1D
from solvers.motion.formula import Formula, FormulaError, parse_formula
from solvers.motion.laws.elastic_material import ElasticMaterial
from solvers.motion.separable_field import NotPeriodicError, separate

NAMES = {1: ("X", "t", "w", "A"), 2: ("X", "Y", "t", "w", "A")}  # along a line, and in the plane
LINE, INSTANTS = 20, 32  # points a side and times of a period at which the motion is checked
LINE_POINTS = 400  # points of a line
MOST_QUARTERS = 160  # of the base period, among which the period is searched
MOTION_TOLERANCE = 1e-9  # of the largest displacement, by which a motion may miss what it must be
FORCE_POINTS = 40  # of the points, at which it must be possible to separate the body force
LEAST_J = 0.05  # of det F: below, the body is next to folding over
SLOPE_TOLERANCE = 1e-7  # of a slope, by which it may miss what it must be at an end
MOST_MOVE = 0.25  # m, by which a bar's particles may move: where a period later one comes, another began


class TypedMotion(NamedTuple):
    """Motion typed by a user: text as in links, and components in m as formulas of X, t, w, A, and in the plane Y."""

    text: str
    components: tuple[Formula, ...]

    def displacement(self, scene: Any, X: Any, Y: Any, t: Any) -> tuple[Any, ...]:
        """Returns u_x, u_y (of a bar, u) in m at X, Y in m, t in s; w is ``scene.base_frequency`` in 1/s."""
        values = {"X": X, "Y": Y, "t": t, "w": scene.base_frequency, "A": scene.amplitude}
        return tuple(formula(values) for formula in self.components)


@functools.lru_cache(maxsize=64)
def parse_motion(text: str, dimensions: int = 2) -> TypedMotion:
    """Parses "u_x, u_y" or "u_x" in two dimensions, or "u" in one, each a formula; raises FormulaError."""
    parts = _split_at_commas(text)
    if len(parts) > dimensions:
        raise FormulaError("has more than one component; give u" if dimensions == 1 else
                           "has more than two components; give u_x, u_y")
    texts, formulas = zip(*(parse_formula(part, NAMES[dimensions]) for part in (*parts, "0")[:dimensions]), strict=True)
    return TypedMotion(",".join(texts).removesuffix(",0"), formulas)


def _split_at_commas(text: str) -> list[str]:
    """Splits a text at commas outside brackets."""
    parts, depth = [""], 0
    for letter in text:
        depth += (letter == "(") - (letter == ")")
        if letter == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += letter
    return parts


class MotionParameters2D(NamedTuple):
    """Inputs of a plane scene that determine its motion and body force: w in 1/s, A and ``SIDE`` in m, ``density`` in
    kg/m^3; and the conditions of a body in a square between symmetry planes."""

    base_frequency: float
    amplitude: float
    material: ElasticMaterial
    density: float
    SIDE: float

    @staticmethod
    def solution(text: str) -> ExactSolution:
        """Returns the exact solution of a motion typed as ``text``; raises FormulaError."""
        return ExactSolution(parse_motion(text).displacement)

    @property
    def points(self) -> np.ndarray:
        """Points (P, 2) in m at which the motion is checked."""
        line = np.linspace(0, self.SIDE, LINE + 1)
        return np.stack(np.meshgrid(line, line), axis=-1).reshape(-1, 2)

    def check(self, u: np.ndarray, F: np.ndarray) -> None:
        """Raises FormulaError if u (P, 2) in m or F (P, 2, 2) at :attr:`points` moves or shears the sides."""
        for axis, X in enumerate(self.points.T):
            there = (np.abs(X) < 1e-12) | (np.abs(X - self.SIDE) < 1e-12)
            if np.abs(u[there, axis]).max() > MOTION_TOLERANCE * self.SIDE:
                raise FormulaError("moves across the sides {axis} = 0 or 1: u_{component} must be zero there",
                                   "XY"[axis], "xy"[axis])
            if np.abs(F[there, 1 - axis, axis]).max() > SLOPE_TOLERANCE:
                raise FormulaError("shears the sides {axis} = 0 or 1, which are planes of symmetry: d "
                                   "u_{component}/d{axis} must be zero there", "XY"[axis], "yx"[axis])


class MotionParameters1D(NamedTuple):
    """Inputs of a bar, a period of an infinite one, that determine its motion: w in 1/s, A in m, wave speed in m/s."""

    base_frequency: float
    amplitude: float
    wave_speed: float
    SIDE: float = 1.0

    @staticmethod
    def solution(text: str) -> ExactSolution1D:
        """Returns the exact solution of a motion typed as ``text``; raises FormulaError."""
        return ExactSolution1D(parse_motion(text, 1).displacement)

    @property
    def points(self) -> np.ndarray:
        """Points (P, 1) in m at which the motion is checked."""
        return np.linspace(0, self.SIDE, LINE_POINTS + 1)[:, None]

    def check(self, u: np.ndarray, F: np.ndarray) -> None:
        """Raises FormulaError if u (P, 1) in m or F (P, 1, 1) is not periodic, or u is above 0.25 m."""
        if np.abs(u[-1] - u[0]).max() > MOTION_TOLERANCE * self.SIDE or np.abs(F[-1] - F[0]).max() > SLOPE_TOLERANCE:
            raise FormulaError("is not periodic: the bar is one period of an infinite bar, so u and du/dX must be "
                               "equal at X = 0 and X = 1")
        if np.abs(u).max() > MOST_MOVE:
            raise FormulaError("moves particles by more than {most} m; give a smaller one", MOST_MOVE)


@functools.lru_cache(maxsize=64)  # of scenes that differ in cells, method or step alone
@np.errstate(all="ignore")
def find_period(text: str, scene: MotionParameters2D | MotionParameters1D) -> float:
    """Returns the shortest period in s of a typed motion among quarters of 2 pi/w and of a second. Raises FormulaError
    where it is not finite, zero at t = 0, periodic and possible for the body, or inverts material."""
    exact, X, base_period = scene.solution(text), scene.points, 2 * np.pi / scene.base_frequency
    longest = MOST_QUARTERS / 4 * max(base_period, 1.0)
    some = np.stack([exact.displacement(scene, X, t) for t in np.linspace(0, base_period, INSTANTS)])
    size = np.abs(some).max() if np.isfinite(some).all() else np.nan
    if not np.isfinite(size):
        raise FormulaError("is not finite everywhere")
    if size == 0:
        raise FormulaError("does not move; give a displacement that changes with t")
    if np.abs(exact.displacement(scene, X, 0.0)).max() > MOTION_TOLERANCE * size:
        raise FormulaError("is not zero at t = 0, where the body is undeformed")
    period = _period(exact, scene, X, base_period, MOTION_TOLERANCE * size)
    if period is None:
        raise FormulaError("has no period among quarters of {base_period:.6g} s and of 1 s up to {most:.4g} s; give "
                           "times as multiples of w*t", base_period, longest)
    _check_body(exact, scene, X, period)
    force = getattr(exact, "force_terms", exact.body_force)
    try:
        separate(lambda X, t: force(scene, X, t), X[::len(X) // FORCE_POINTS], period)
    except NotPeriodicError:
        raise FormulaError("changes too fast with t for its period of {period:.4g} s; give slower functions",
                           period) from None
    return period


def _period(exact: Any, scene: Any, X: np.ndarray, base_period: float, tolerance: float) -> float | None:
    """Returns the shortest period in s of a motion that fits at points ``X`` within a ``tolerance`` in m, or None."""
    candidates = sorted({k / 4 * base for k in range(1, MOST_QUARTERS + 1) for base in (base_period, 1.0)})
    some = X[:: max(1, len(X) // 40)] + 0.0123 * scene.SIDE  # not only where everything is zero
    at = np.array([0.0, 0.1234, 0.3771, 0.5309, 0.8113]) * base_period
    before = [exact.displacement(scene, some, t) for t in at]
    for period in candidates:
        if all(np.abs(exact.displacement(scene, some, t + period) - u).max() <= tolerance
               for t, u in zip(at, before, strict=True)):
            return period
    return None


def _check_body(exact: Any, scene: Any, X: np.ndarray, period: float) -> None:
    """Raises FormulaError where a motion at points ``X`` (P, D) violates the body's conditions in a period in s."""
    strain, D = 0.0, X.shape[1]
    for t in (np.arange(INSTANTS) + 0.37) / INSTANTS * period:
        F = exact.deformation_gradient(scene, X, t).reshape(-1, D, D)
        if not np.isfinite(F).all():
            raise FormulaError("is not finite everywhere over a period")
        scene.check(exact.displacement(scene, X, t), F)
        if np.linalg.det(F).min() < LEAST_J:
            raise FormulaError("folds the body over, or nearly so: det F falls below {J}; give a smaller one", LEAST_J)
        strain = max(strain, np.abs(F - np.eye(D)).max())
    if strain < MOTION_TOLERANCE:
        raise FormulaError("moves the body without deforming it; give a displacement that changes with X")
