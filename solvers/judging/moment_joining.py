"""Joining of files that have parts of one moment: some of its particles, or some of their quantities."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from solvers.judging.column_names import complete_positions
from solvers.judging.particle_data_types import RawTable, group_rows_by_time, row_times


def join_moments(files: Sequence[RawTable], cells: Sequence[int],
                 times: Sequence[float]) -> tuple[list[RawTable], list[int], list[float]]:
    """Returns the files, their ``cells`` and ``times`` in s, as :func:`~solvers.judging.judgement.judge` takes them,
    with each moment of a grid in one file.

    Files of the same moment are joined if their particles have different ids, if they have different quantities of the
    same particles, or where they agree to the last bit, as the last moment of a run and the first after its restart do.
    """
    if len(files) < 2:
        return list(files), list(cells), list(times)
    every = [row_times(raw, times[k] if times else None) for k, raw in enumerate(files)]
    counts = [raw.cells or cells[k if len(cells) > 1 else 0] if cells else raw.cells for k, raw in enumerate(files)]
    moments = Counter((counts[k], _figures(t)) for k, own in enumerate(every) for t in np.unique(own))
    if max(moments.values()) == 1:
        return _move_points(files), list(cells), list(times)
    found: dict[tuple[int | None, str], list[RawTable]] = {}
    for raw, own, count in zip(files, every, counts, strict=True):
        for at in group_rows_by_time(own):
            t = float(own[at][0])
            part = replace(raw, time=t, columns={key: v[at] for key, v in raw.columns.items() if key != "t"})
            _add_part(found.setdefault((count, _figures(t)), []), part)
    parts = [(part, count) for (count, _), listed in found.items() for part in listed]
    return _move_points([part for part, _ in parts]), [count for _, count in parts if count is not None], []


def _move_points(files: Sequence[RawTable]) -> list[RawTable]:
    """Returns the files; where their positions are the same at all moments, and displacements are not, these positions
    are material ones, and the displacements move them."""
    if not all(raw.from_displacement for raw in files):
        return list(files)
    still, same = (all(np.array_equal(raw.columns[key], files[0].columns[key]) for raw in files) for key in ("x", "X"))
    if same or not still:
        return list(files)
    return [replace(raw, columns=raw.columns | {"X": raw.columns["x"], "x": 2 * raw.columns["x"] - raw.columns["X"]})
            for raw in files]


def _figures(time: float) -> str:
    """Returns a time in the ten figures that files of one moment must have in common."""
    return f"{time:.9e}"


def _add_part(parts: list[RawTable], new: RawTable) -> None:
    """Adds a part of a moment to the one of ``parts`` that it can be joined with, or as another one."""
    for k, part in enumerate(parts):
        if (columns := _join_columns(part.columns, new.columns)) is not None:
            from_displacement = complete_positions(columns) or part.from_displacement or new.from_displacement
            parts[k] = replace(part, columns=columns, cells=part.cells or new.cells, step=part.step or new.step,
                               metadata=part.metadata or new.metadata, from_displacement=from_displacement,
                               not_read=tuple(dict.fromkeys((*part.not_read, *new.not_read))))
            return
    parts.append(new)


def _join_columns(one: dict[str, np.ndarray], other: dict[str, np.ndarray]) -> dict[str, np.ndarray] | None:
    """Returns the columns of two parts of a moment together; None where they contradict each other, or nothing says
    which rows are of the same particles."""
    common = (one.keys() & other.keys()) - {"row"}
    n, m = (len(next(iter(columns.values()))) for columns in (one, other))
    if "id" in common:
        _, mine, theirs = np.intersect1d(one["id"], other["id"], return_indices=True)
    elif "X" in common and one["X"].shape[1] == other["X"].shape[1]:
        places = np.unique(np.concatenate([one["X"], other["X"]]), axis=0, return_inverse=True)[1].ravel()
        _, mine, theirs = np.intersect1d(places[:n], places[n:], return_indices=True)
    elif n == m and common & {"x", "X"}:
        mine = theirs = np.arange(n)
    else:
        return None
    if not all(np.array_equal(one[key][mine], other[key][theirs], equal_nan=True) for key in common):
        return None
    if len(mine) == n == m:
        row = np.empty(n, int)
        row[mine] = theirs
        return one | {key: values[row] for key, values in other.items() if key not in one}
    new = np.setdiff1d(np.arange(m), theirs)
    return {key: np.concatenate([one[key], other[key][new]]) for key in one if key in common}
