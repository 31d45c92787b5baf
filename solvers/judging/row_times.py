"""Of what time each row of a file is."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from typing import Any

import numpy as np

from solvers.judging.frames import Raw
from solvers.outside.file_error import FileError


def times_of(raw: Raw, given: float | None) -> np.ndarray:
    """The time of each row, from the column, the file or the flag, which must not contradict each other."""
    n = len(next(iter(raw.columns.values())))
    column = raw.columns.get("t")
    said: list[tuple[str, Any]] = [("its column t", column)] if column is not None else []
    said += [("the file itself", raw.time)] if raw.time is not None else []
    said += [("--time", given)] if given is not None else []
    if not said:
        raise FileError(raw.file, "says no time; give a column t, or # t = ... in a .csv, t in a .npz, TimeValue in "
                                  "VTK's formats, or the flag --time with one time for each file")
    first = np.broadcast_to(np.asarray(said[0][1], float), (n,))
    for name, value in said[1:]:
        if not np.all(np.abs(first - np.asarray(value)) <= 1e-9 * np.maximum(np.abs(first), 1e-300)):
            raise FileError(raw.file, f"has times that do not match: {said[0][0]} says {first[0]:g} s and {name} says "
                                      f"{float(np.ravel(value)[0]):g} s; give one of the two")
    if not np.isfinite(first).all() or (first < 0).any():
        bad = first[~(np.isfinite(first) & (first >= 0))][0]
        raise FileError(raw.file, f"has the time {bad:g}; give seconds from 0 on")
    return first


def by_times(times: np.ndarray) -> Iterator[Any]:
    """Which rows are of each time, in their order: views of the rows where these are in order of time, as usual."""
    order = None if (np.diff(times) >= 0).all() else np.argsort(times, kind="stable")
    _, first = np.unique(times if order is None else times[order], return_index=True)
    for start, end in itertools.pairwise([*first.tolist(), len(times)]):
        yield slice(start, end) if order is None else order[start:end]
