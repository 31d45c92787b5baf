"""A motion of the plane that somebody has typed, and what it must be: a motion that a body between planes can have."""

import functools
from typing import Any, NamedTuple

import numpy as np

from solvers.motion.exact_solution import X_AXIS, Y_AXIS, ExactSolution
from solvers.motion.formula import Formula, FormulaError, parse
from solvers.motion.jets import Jet
from solvers.motion.laws.material import Material
from solvers.motion.separable_field import NotPeriodic, separate

NAMES = ("X", "Y", "t", "w", "A")
LINE, INSTANTS = 20, 32  # points a side and times of a period at which the motion is looked at
MOST_QUARTERS = 160  # of the base period, among which the period is looked for
SAME = 1e-9  # of the largest displacement, by which a motion may miss what it must be
FORCED = 40  # of the points, at which it must be possible to separate the body force
LEAST_J = 0.05  # of det F: below, the body is next to folding over


class TypedMotion(NamedTuple):
    """Its text as it is written into links, and its components, formulas of X, Y, t, w and A."""

    text: str
    components: tuple[Formula, Formula]

    def displacement(self, scene: Any, X: Any, Y: Any, t: Any) -> tuple[Any, Any]:
        """u_x and u_y in m, of any kind of number; ``w`` is ``scene.base_frequency`` and ``A`` the amplitude."""
        values = {"X": X, "Y": Y, "t": t, "w": scene.base_frequency, "A": scene.amplitude}
        u_x, u_y = (formula(values) for formula in self.components)
        return u_x, u_y

    @property
    def exact(self) -> ExactSolution:
        return ExactSolution(self.displacement)


@functools.lru_cache(maxsize=64)
def read_motion(text: str) -> TypedMotion:
    """The motion of a text, u_x and u_y with a comma between, or u_x alone.

    Raises
    ------
    FormulaError
    """
    parts = _split(text)
    if len(parts) > 2:
        raise FormulaError("has more than two components; give u_x, u_y")
    (first, one), (second, other) = (parse(part, NAMES) for part in (*parts, "0")[:2])
    return TypedMotion(first if second == "0" else f"{first},{second}", (one, other))


def _split(text: str) -> list[str]:
    """At commas outside brackets."""
    parts, depth = [""], 0
    for letter in text:
        depth += (letter == "(") - (letter == ")")
        if letter == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += letter
    return parts


class MotionInputs(NamedTuple):
    """What of a scene its motion, and the body force that makes it, are made of: w in 1/s, A, its material and SI."""

    base_frequency: float
    amplitude: float
    material: Material
    density: float
    SIDE: float


@functools.lru_cache(maxsize=64)  # of scenes that differ in cells, method or step alone
@np.errstate(all="ignore")
def find_period(text: str, scene: MotionInputs) -> float:
    """The shortest period in s among quarters of 2 pi/w and of a second, of a typed motion that a body in the unit
    square between planes can have.

    Raises
    ------
    FormulaError
        What it is not: finite, at rest in shape at t = 0, within the planes, without shear at them, periodic, not
        folded over.
    """
    motion, base_period = read_motion(text), 2 * np.pi / scene.base_frequency
    line = np.linspace(0, scene.SIDE, LINE + 1)
    X = np.stack(np.meshgrid(line, line), axis=-1).reshape(-1, 2)
    exact, longest = motion.exact, MOST_QUARTERS / 4 * max(base_period, 1.0)
    some = np.stack([exact.displacement(scene, X, t) for t in np.linspace(0, base_period, INSTANTS)])
    size = np.abs(some).max() if np.isfinite(some).all() else np.nan
    if not np.isfinite(size):
        raise FormulaError("is not finite everywhere")
    if size == 0:
        raise FormulaError("does not move; give a displacement that changes with t")
    if np.abs(exact.displacement(scene, X, 0.0)).max() > SAME * size:
        raise FormulaError("is not zero at t = 0, where the body is undeformed")
    period = _period(exact, scene, X, base_period, SAME * size)
    if period is None:
        raise FormulaError(f"has no period among quarters of {base_period:.6g} s and of 1 s up to {longest:.4g} s; "
                           "give times as multiples of w*t")
    _check_body(exact, scene, X, period)
    try:
        separate(lambda X, t: exact.body_force(scene, X, t), X[::len(X) // FORCED], period)
    except NotPeriodic:
        raise FormulaError(f"changes too fast with t for its period of {period:.4g} s; give slower functions") from None
    return period


def _period(exact: ExactSolution, scene: Any, X: np.ndarray, base_period: float, near: float) -> float | None:
    candidates = sorted({k / 4 * base for k in range(1, MOST_QUARTERS + 1) for base in (base_period, 1.0)})
    some = X[:: max(1, len(X) // 40)] + 0.0123 * scene.SIDE  # not only where everything is zero
    at = np.array([0.0, 0.1234, 0.3771, 0.5309, 0.8113]) * base_period
    before = [exact.displacement(scene, some, t) for t in at]
    for period in candidates:
        if all(np.abs(exact.displacement(scene, some, t + period) - u).max() <= near
               for t, u in zip(at, before, strict=True)):
            return period
    return None


def _check_body(exact: ExactSolution, scene: Any, X: np.ndarray, period: float) -> None:
    """What a body between planes needs, over a period."""
    side = [[np.abs(X[:, axis] - end) < 1e-12 for end in (0.0, scene.SIDE)] for axis in (X_AXIS, Y_AXIS)]
    for t in (np.arange(INSTANTS) + 0.37) / INSTANTS * period:
        jets = exact.jets(scene, X, t)
        F = np.stack([np.broadcast_to(one, len(X)) for one in jets.deformation_gradient])
        if not np.isfinite(F).all():
            raise FormulaError("is not finite everywhere over a period")
        for axis, (u, other) in enumerate((jets, jets[::-1])):
            across, along = _values(u, len(X)), np.broadcast_to(other.derivative(axis), len(X))
            there = side[axis][0] | side[axis][1]
            if np.abs(across[there]).max() > SAME * scene.SIDE:
                raise FormulaError(f"moves across the sides {'XY'[axis]} = 0 or 1: u_{'xy'[axis]} must be zero there")
            if np.abs(along[there]).max() > 1e-7:
                raise FormulaError(f"shears the sides {'XY'[axis]} = 0 or 1, which are planes of symmetry: "
                                   f"d u_{'yx'[axis]}/d{'XY'[axis]} must be zero there")
        if (F[0] * F[3] - F[1] * F[2]).min() < LEAST_J:
            raise FormulaError(f"folds the body over, or nearly so: det F falls below {LEAST_J}; give a smaller one")


def _values(u: Jet, count: int) -> np.ndarray:
    return np.broadcast_to(u.value, count)
