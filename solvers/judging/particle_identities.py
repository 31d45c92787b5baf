"""Which material points the rows of files are: by material position, displacement or id."""

import contextlib
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from solvers.judging.particle_data_types import ProblemMismatch, RawTable
from solvers.problems import PROBLEMS
from solvers.scene.scene import Scene
from solvers.scene.validation import SceneError
from solvers.translatable_message import Message, join_messages
from solvers.untrusted.quoting import FileError

SURE = 0.5  # of a cell: particles farther from their start at the time 0 do not match
LARGEST_ID = 2.0**53  # beyond, ids are not exact
MOST_TRIED = 400  # cells of candidate grids


def whole_ids(file: str, columns: Mapping[str, np.ndarray]) -> np.ndarray | None:
    """Returns the number (n,) of each row's particle by its id, or else by its count of rows; None without either."""
    ids = columns.get("id", columns.get("row"))
    if ids is not None and not ((np.abs(ids) < LARGEST_ID).all() and (ids == np.round(ids)).all()):
        raise FileError(file, "has ids that are no whole numbers; give 0, 1, 2 and so on")
    return None if ids is None else ids.astype(int)


@np.errstate(all="ignore")  # files may have any numbers
def first_id(files: Sequence[RawTable], scene: Scene) -> int:
    """Returns from what on the ids in the files of one grid count, 0 or 1: from 1 where the last is the number of all
    particles, or, where that is missing, where the first positions fit better so."""
    listed = [(raw, number) for raw in files if (number := whole_ids(raw.file, raw.columns)) is not None]
    points = PROBLEMS[scene.problem].reference.start(scene).material_position
    last = max((int(number.max()) for _, number in listed), default=-1)
    if not 0 < last <= len(points) or min(int(number.min()) for _, number in listed) < 1:
        return 0
    raw, number = listed[0]
    x = raw.columns.get("x", np.empty((0, 0)))
    if last == len(points) or x.shape[-1] < points.shape[1]:
        return int(last == len(points))
    off = [np.sum((x[:, :points.shape[1]] - points[number - first]) ** 2) for first in (0, 1)]
    return int(off[1] < 0.25 * off[0])


@np.errstate(all="ignore")
def material_positions(raw: RawTable, scene: Scene, X: np.ndarray | None,
                       first: int) -> tuple[np.ndarray, np.ndarray]:
    """Returns material position (n, D) in m, the file's ``X`` or that of its ids, which begin with ``first``, and
    number (n,) of each row. Where X comes from displacements, ids that fit it are more exact."""
    reference, number = PROBLEMS[scene.problem].reference, whole_ids(raw.file, raw.columns)
    points = reference.start(scene).material_position
    fits = number is not None and number.min() >= first and number.max() < len(points) + first
    if X is not None and raw.from_displacement and number is not None and fits:
        off = np.sum((points[number - first] - X) ** 2, axis=1)
        X = points[number - first] if np.sqrt(np.mean(off)) <= SURE * scene.spacing else X
    if X is not None:
        n = len(X)
        if (wrong := reference.is_outside(scene, X)).any():
            low, high = X.min(axis=0), X.max(axis=0)
            reach = ", ".join(f"{a:.4g} to {b:.4g} m" for a, b in zip(low, high, strict=True))
            sides = zip(reference.axes, points.min(axis=0), points.max(axis=0), strict=True)
            begin = join_messages(" and ", (Message("{axis} from {a:.3g} to {b:.3g} m", axis.upper(), a, b)
                                            for axis, a, b in sides))
            reason = Message("has {wrong:,} of {n:,} material positions outside the {problem} (they reach from "
                             "{reach}): its origin may be shifted", int(wrong.sum()), n, Message(scene.problem), reach)
            raise ProblemMismatch(raw.file, reason, Message("particles begin at {begin}", begin))
        return X, np.arange(n) if number is None else number
    assert number is not None
    fitting = _fitting_cells(scene, number - int(number.min() == 1))
    if fits and not fitting:
        return points[number - first], number
    reason = Message("has ids from {first} to {last}, and {cells} cells with {ppc:g} particles each way have 0 "
                     "to {most}", number.min(), number.max(), scene.cells, scene.ppc, len(points) - 1)
    if fitting:
        raise FileError(raw.file, "{reason}; give the right --cells and --ppc (so many are those of {fitting} "
                        "cells), or material positions", reason, fitting)
    raise ProblemMismatch(raw.file, reason, Message(
        "give those of `mpm-lab problem`, the right --cells and --ppc, or material positions"))


def _fitting_cells(scene: Scene, number: np.ndarray) -> int:
    """Returns another number of cells with which the scene has exactly the particles ``number``; 0 if none has."""
    count = int(number.max()) + 1
    if count == scene.particles or len(np.unique(number)) != count:
        return 0
    for cells in range(scene.FEWEST_CELLS, MOST_TRIED + 1):
        with contextlib.suppress(SceneError):
            if (other := replace(scene, cells=cells)).particles == count:
                return other.cells
    return 0
