"""How patches fit together: sides that two of them share, and straight lines on which sides are held."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from solvers.bodies.patch import CLAMPED, ENDS, FREE, ROLLER, SIDES, SMALL, Patch
from solvers.scene.validation import SceneError

Side = tuple[int, int]  # numbers, from 0, of a patch and of its side


class HeldLine(NamedTuple):
    """Line x = ``position`` (``axis`` 0) or y = ``position`` (1), in m, on which sides are of ``kind`` "clamped" or
    "roller"; the body lies where the coordinate is larger (``inside`` 1) or smaller (-1)."""

    axis: int
    position: float
    inside: int
    kind: str


def joined_sides(patches: Sequence[Patch]) -> dict[Side, Side]:
    """Returns for each side that two patches share the other patch's. Raises SceneError where patches touch in another
    way than along whole sides, overlap, or are not in one piece."""
    size = _size(patches)
    sides = [(k, side) for k in range(len(patches)) for side in range(4)]
    joined: dict[Side, Side] = {}
    for n, one in enumerate(sides):
        for other in sides[n + 1:]:
            if one[0] != other[0] and _are_joined(patches, one, other, size):
                if one in joined or other in joined:
                    raise SceneError("patch", one[0] + 1, "shares one side with two others; patches must not overlap")
                joined |= {one: other, other: one}
    for k, side in joined:
        if patches[k].sides[side] != FREE:
            raise SceneError(f"patch {k + 1} sides", patches[k].sides[side], "is a side within the body ({side}); give "
                             "free there", SIDES[side])
    _check_touching(patches, joined, size)
    _check_one_piece(len(patches), joined)
    return joined


def _size(patches: Sequence[Patch]) -> float:
    return float(np.ptp(np.concatenate([patch.corners for patch in patches]), axis=0).max())


def _are_joined(patches: Sequence[Patch], one: Side, other: Side, size: float) -> bool:
    (a, middle, b), (c, other_middle, d) = (patches[k].points_on_side(side, [0, 0.5, 1]) for k, side in (one, other))
    near = SMALL * size
    if min(max(math.dist(a, c), math.dist(b, d)), max(math.dist(a, d), math.dist(b, c))) > near:
        return False
    if math.dist(middle, other_middle) > near:
        raise SceneError("patch", one[0] + 1, "shares both ends of its side {side} with patch {other}, but not the "
                         "side; give both the same arc", SIDES[one[1]], other[0] + 1)
    return True


def _check_touching(patches: Sequence[Patch], joined: dict[Side, Side], size: float) -> None:
    """Raises SceneError where a patch has a corner within a side of another, or points in common with it."""
    line = np.linspace(0.05, 0.95, 10)
    inner = [one.ravel() for one in np.meshgrid(line, line)]
    edge = np.linspace(0, 1, 17)
    outlines = [np.concatenate([patch.points_on_side(side, edge) for side in range(4)]) for patch in patches]
    near = 0.01 * size  # by which an arc may be beyond its points
    for k, patch in enumerate(patches):
        X = np.concatenate([patch.place(*inner), np.array(patch.corners, float)])
        for n, other in enumerate(patches):
            apart = (outlines[k].min(axis=0) > outlines[n].max(axis=0) + near) | (
                outlines[n].min(axis=0) > outlines[k].max(axis=0) + near)
            if n == k or apart.any():
                continue
            at = other.locate(X)
            off_corners = np.array([min(math.dist(x, corner) for corner in other.corners) for x in X]) > SMALL * size
            within = ((at > -SMALL) & (at < 1 + SMALL)).all(axis=1) & off_corners  # NaN where there is no such point
            if within.any():
                raise SceneError("patch", k + 1, "meets patch {other} elsewhere than along whole sides; divide patches "
                                 "so that corners meet corners and none overlap", n + 1)


def _check_one_piece(count: int, joined: dict[Side, Side]) -> None:
    reached = {0}
    for _ in range(count):
        reached |= {b[0] for a, b in joined.items() if a[0] in reached}
    if len(reached) < count:
        raise SceneError("patch", min(set(range(count)) - reached) + 1, "is not joined to the others along a side; "
                         "give one body: contact of several is not computed")


def equalize_counts(patches: Sequence[Patch], joined: dict[Side, Side], wanted: np.ndarray) -> np.ndarray:
    """Returns ``wanted`` (K, 2), counts along xi and eta of each of K patches, raised so that joined sides have equal
    ones: the largest of all along one strip of patches."""
    counts = wanted.copy()
    for _ in range(2 * len(patches)):  # the longest strip has as many
        for (k, side), (n, other) in joined.items():
            counts[k, side % 2] = max(counts[k, side % 2], counts[n, other % 2])
    return counts


def held_lines(patches: Sequence[Patch], joined: dict[Side, Side]) -> tuple[HeldLine, ...]:
    """Returns the lines of clamped and roller sides, in order. Raises SceneError for such a side that is an arc or
    slanted, or on whose line the body lies on both sides or is held in different ways."""
    size = _size(patches)
    lines: dict[tuple[int, float], HeldLine] = {}
    for k, patch in enumerate(patches):
        for side, kind in enumerate(patch.sides):
            if kind != FREE:
                line = _line_of_side(patches, k, side, size)
                same = next((key for key in lines if key[0] == line.axis
                             and abs(key[1] - line.position) < SMALL * size), None)
                if same and lines[same].kind != kind:
                    raise SceneError(f"patch {k + 1} sides", kind, "lies on one line with a side of another kind; give "
                                     "all sides on a line the same kind")
                lines.setdefault(same or (line.axis, line.position), line)
    for line in lines.values():
        _check_free_sides(patches, joined, line, size)
    return tuple(lines[key] for key in sorted(lines))


def _line_of_side(patches: Sequence[Patch], k: int, side: int, size: float) -> HeldLine:
    kind, name = patches[k].sides[side], f"patch {k + 1} sides"
    a, b = (patches[k].corners[end] for end in ENDS[side])
    axis = 0 if abs(a[0] - b[0]) < SMALL * size else 1
    if SIDES[side] in patches[k].arc or abs(a[axis] - b[axis]) > SMALL * size:
        raise SceneError(name, kind, "is a side that is no straight line along x or y ({side}); only such sides can be "
                         "held, because lines of the grid must lie on them", SIDES[side])
    edge = np.linspace(0, 1, 33)
    away = np.concatenate([patch.points_on_side(n, edge) for patch in patches for n in range(4)])[:, axis] - a[axis]
    if away.min() < -1e-6 * size and away.max() > 1e-6 * size:
        raise SceneError(name, kind, "has the body on both sides of its line ({side}); a held side must be the body's "
                         "outermost", SIDES[side])
    return HeldLine(axis, float(a[axis]), 1 if away.max() > 1e-6 * size else -1, kind)


def _check_free_sides(patches: Sequence[Patch], joined: dict[Side, Side], line: HeldLine, size: float) -> None:
    for k, patch in enumerate(patches):
        for side, kind in enumerate(patch.sides):
            ends = [abs(patch.corners[end][line.axis] - line.position) < SMALL * size for end in ENDS[side]]
            if kind == FREE and (k, side) not in joined and all(ends) and SIDES[side] not in patch.arc:
                raise SceneError(f"patch {k + 1} sides", kind, "is a free side on the line of one that is held "
                                 "({side}); give all sides on a line the same kind", SIDES[side])


def clamped_corner_angles(patches: Sequence[Patch], joined: dict[Side, Side]) -> list[float]:
    """Returns the body's angles in degrees at points where a clamped side meets a free one."""
    size, angles = _size(patches), []
    outer = {(k, side): kind for k, patch in enumerate(patches) for side, kind in enumerate(patch.sides)
             if (k, side) not in joined}
    for (k, side), kind in outer.items():
        for end in ENDS[side] if kind == CLAMPED else ():
            point = patches[k].corners[end]
            at = [(n, corner) for n, patch in enumerate(patches) for corner in range(4)
                  if math.dist(patch.corners[corner], point) < SMALL * size]
            kinds = {outer.get((n, one)) for n, corner in at for one in range(4) if corner in ENDS[one]}
            if FREE in kinds and ROLLER not in kinds:
                angles.append(sum(patches[n].corner_angle(corner) for n, corner in at))
    return angles
