"""A patch of a body: a quadrilateral whose sides may be arcs of circles, as the image of the unit square.

The map is Coons' (Gordon & Hall, Numer. Math. 21 (1973) 109-129): with the sides S, N along xi and W, E along eta,
X = (1-eta) S + eta N + (1-xi) W + xi E minus the bilinear map of the corners. Rectangles and sectors come out exact.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from solvers.scene.validation import SceneError, require_choice

Point = tuple[float, float]
SIDES = ("south", "east", "north", "west")
ENDS = ((0, 1), (1, 2), (3, 2), (0, 3))  # corners between which each side runs, along growing xi or eta
FREE, CLAMPED, ROLLER = KINDS = ("free", "clamped", "roller")
FARTHEST = 1e6  # m, of a coordinate; also over a patch's size: beyond, rounding exceeds SMALL
SMALL = 1e-9  # of a size in m: two points that are nearer are one
MOST_ANGLE, MOST_TURN = 150, 170  # degrees: of a corner, and of an arc
STEP, TURNS = 1e-6, 30  # of differences in the unit square, and of Newton's method


@dataclass(frozen=True)
class Patch:
    """Quadrilateral: ``corners`` in m, counter-clockwise from the one at xi = eta = 0; the kinds of its ``sides`` south
    (eta = 0), east (xi = 1), north, west; ``arc`` has the centre in m of a side that is an arc, by its name."""

    corners: tuple[Point, ...]
    sides: tuple[str, ...] = (FREE,) * 4
    arc: Mapping[str, Point] = field(default_factory=dict)

    def points_on_side(self, side: int, s: Any) -> np.ndarray:
        """Returns points (N, 2) in m on side number ``side`` at ``s`` (N,), from 0 at its first end to 1."""
        a, b = (np.array(self.corners[k], float) for k in ENDS[side])
        s = np.asarray(s, float)[:, None]
        if SIDES[side] not in self.arc:
            return a + s * (b - a)
        centre = np.array(self.arc[SIDES[side]], float)
        angle = math.atan2(*(a - centre)[::-1]) + s[:, 0] * self.arc_angle(side)
        return centre + math.dist(a, centre) * np.stack([np.cos(angle), np.sin(angle)], axis=1)

    def arc_angle(self, side: int) -> float:
        """Returns the angle in rad, from -pi to pi, by which an arc turns from its first end to its second."""
        (ax, ay), (bx, by) = (np.subtract(self.corners[k], self.arc[SIDES[side]]) for k in ENDS[side])
        return math.atan2(ax * by - ay * bx, ax * bx + ay * by)

    def constrained_axes(self, side: int) -> list[int]:
        """Returns the components, 0 for x and 1 for y, that a straight side along an axis holds by its kind."""
        a, b = (self.corners[k] for k in ENDS[side])
        across = int(abs(a[0] - b[0]) > abs(a[1] - b[1]))
        return {FREE: [], CLAMPED: [0, 1], ROLLER: [across]}[self.sides[side]]

    def side_length(self, side: int) -> float:
        """Returns the length of a side in m."""
        a, b = (self.corners[k] for k in ENDS[side])
        if SIDES[side] not in self.arc:
            return math.dist(a, b)
        return math.dist(a, self.arc[SIDES[side]]) * abs(self.arc_angle(side))

    def place(self, xi: np.ndarray, eta: np.ndarray) -> np.ndarray:
        """Returns material points (N, 2) in m at coordinates (N,), from 0 to 1 within the patch."""
        south, north = self.points_on_side(0, xi), self.points_on_side(2, xi)
        east, west = self.points_on_side(1, eta), self.points_on_side(3, eta)
        c, x, y = np.array(self.corners, float), xi[:, None], eta[:, None]
        bilinear = (1 - y) * ((1 - x) * c[0] + x * c[1]) + y * ((1 - x) * c[3] + x * c[2])
        return (1 - y) * south + y * north + (1 - x) * west + x * east - bilinear

    def tangents(self, xi: np.ndarray, eta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Returns dX/dxi and dX/deta (N, 2) in m, by central differences."""
        return ((self.place(xi + STEP, eta) - self.place(xi - STEP, eta)) / (2 * STEP),
                (self.place(xi, eta + STEP) - self.place(xi, eta - STEP)) / (2 * STEP))

    def locate(self, X: np.ndarray) -> np.ndarray:
        """Returns xi and eta (N, 2) of points X (N, 2) in m by Newton's method; NaN where it does not converge."""
        at = np.full((len(X), 2), 0.5)
        for _ in range(TURNS):
            r1, r2 = self.tangents(*at.T)
            miss, area = X - self.place(*at.T), _cross(r1, r2)
            move = np.stack([_cross(miss, r2), _cross(r1, miss)], axis=1) / np.where(area > 0, area, np.inf)[:, None]
            at = np.clip(at + move, -0.5, 1.5)
        wrong = np.linalg.norm(X - self.place(*at.T), axis=1) > SMALL * self.size
        return np.where(wrong[:, None], np.nan, at)

    def contains(self, X: np.ndarray) -> np.ndarray:
        """Returns which of the points X (N, 2) in m lie in the patch or on its sides, (N,) of bool."""
        at = self.locate(X)  # NaN where there is no such point
        return np.all((at > -SMALL) & (at < 1 + SMALL), axis=1)

    @property
    def size(self) -> float:
        """Largest extent of the corners in m."""
        return float(np.ptp(np.array(self.corners, float), axis=0).max())

    def corner_angle(self, corner: int) -> float:
        """Returns the angle in degrees between the two sides at a corner."""
        xi, eta = np.array([[0, 1, 1, 0], [0, 0, 1, 1]], float)[:, corner:corner + 1]
        (r1,), (r2,) = self.tangents(xi, eta)
        at = math.degrees(math.atan2(_cross(r1, r2), r1 @ r2))
        return at if corner % 2 == 0 else 180 - at

    def validate(self, number: int) -> None:
        """Raises SceneError if the patch, with this ``number`` for the sentence, is no quadrilateral as described."""
        where = f"patch {number}"
        if not isinstance(self.corners, tuple) or len(self.corners) != 4:
            raise SceneError(f"{where} corners", self.corners, "give four points [x, y] in m, counter-clockwise")
        for corner in self.corners:
            require_point(f"{where} corners", corner)
        if np.abs(self.corners).max() > FARTHEST * self.size:
            raise SceneError(f"{where} corners", self.corners, "lie farther from the origin than {most:,.0f} times the "
                             "patch's size, where rounding shows; move the body nearer", FARTHEST)
        if not isinstance(self.sides, tuple) or len(self.sides) != 4:
            raise SceneError(f"{where} sides", self.sides, "give the kinds of four sides: south, east, north, west")
        for kind in self.sides:
            require_choice(f"{where} sides", kind, KINDS)
        if not isinstance(self.arc, Mapping):
            raise SceneError(f"{where} arc", self.arc, "give the centre of each side that is an arc, such as west = "
                                                       "[0, 0]")
        for name, centre in self.arc.items():
            require_choice(f"{where} arc", name, SIDES)
            require_point(f"{where} arc", centre)
            self._check_arc(where, SIDES.index(name))
        self._check_shape(where)

    def _check_arc(self, where: str, side: int) -> None:
        centre = self.arc[SIDES[side]]
        first, last = (math.dist(self.corners[k], centre) for k in ENDS[side])
        if abs(first - last) > 1e-6 * max(first, last) or not first:
            raise SceneError(f"{where} arc", centre, "is {first:.6g} m from one end of the side {side} and {last:.6g} "
                             "m from the other; give the centre of a circle through both", first, SIDES[side], last)
        if abs(math.degrees(self.arc_angle(side))) > MOST_TURN:
            raise SceneError(f"{where} arc", centre, "makes the side {side} turn by more than {most} degrees; divide "
                             "the patch", SIDES[side], MOST_TURN)

    def _check_shape(self, where: str) -> None:
        xi, eta = (one.ravel() for one in np.meshgrid(np.linspace(0, 1, 17), np.linspace(0, 1, 17)))
        if _cross(*self.tangents(xi, eta)).min() <= SMALL * self.size**2:
            raise SceneError(f"{where} corners", self.corners, "fold the patch over or go clockwise; give them "
                             "counter-clockwise, with sides that do not cross")
        angle = max(map(self.corner_angle, range(4)))
        if angle > MOST_ANGLE:
            raise SceneError(f"{where} corners", self.corners, "have an angle of {angle:.0f} degrees; at most {most} "
                             "are allowed", angle, MOST_ANGLE)


def require_point(name: str, value: object, unit: str = "m") -> None:
    """Raises SceneError for a ``value`` of the input ``name`` that is no pair of components in ``unit``."""
    if not isinstance(value, tuple) or len(value) != 2 or not all(
            isinstance(one, int | float) and not isinstance(one, bool) and abs(one) <= FARTHEST for one in value):
        raise SceneError(name, value, "give [x, y], two numbers in {unit} of size up to {most:g}", unit, FARTHEST)


def _cross(a: np.ndarray, b: np.ndarray) -> Any:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
