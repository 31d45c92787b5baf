"""Which particle each row is at each moment of a motion, and which particles are there at all of them."""

import functools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import cast

import numpy as np

from solvers.judging.findings.finding import BROKEN, HOLDS, SUSPICIOUS, Finding
from solvers.judging.findings.neighbour_comparison import NeighbourSearch
from solvers.judging.particle_data_types import identity_hint
from solvers.judging.particle_identities import whole_ids
from solvers.judging.particle_scene_matching import LARGEST
from solvers.untrusted.quoting import FileError

WHO = "each particle is there once at every moment"
SAME_PLACE = 1e-3  # of the distance of particles, about, within which reference positions are the same


@dataclass(frozen=True)
class RowsAtTime:
    """Rows of one file at one time in s, (n, ...) by quantity."""

    file: str
    time: float
    rows: dict[str, np.ndarray]


def identify_rows(moments: list[RowsAtTime], not_read: Sequence[str]) -> tuple[list[np.ndarray], bool]:
    """Returns a number for the particle of each row, (n,) at each time, from its id, or its reference position if it is
    a number, or its row; and whether it is from its row alone."""
    ids = [whole_ids(one.file, one.rows) for one in moments]
    if all(one is not None for one in ids) and any("id" in one.rows for one in moments):
        return cast(list[np.ndarray], ids), False
    if all("X" in one.rows and (np.abs(one.rows["X"]) < LARGEST).all() for one in moments):
        return _match_reference([one.rows["X"] for one in moments]), False
    counts = [len(one.rows["x"]) for one in moments]
    if len(set(counts)) > 1:
        k = next(k for k, count in enumerate(counts) if count != counts[0])
        raise FileError(moments[k].file, f"has {counts[k]:,} particles at t = {moments[k].time:g} s, and there were "
                                         f"{counts[0]:,} before; give id or X, so that it is known which they are"
                                         + identity_hint(not_read))
    return [np.arange(counts[0])] * len(moments), True


def _match_reference(X: list[np.ndarray]) -> list[np.ndarray]:
    """Returns a number for each row, (n,) at each time, from its reference position (n, D): the row of the nearest one
    at the first time, or a new number where none is there."""
    first, search = np.arange(len(X[0])), NeighbourSearch(X[0])
    numbers = [first]
    for other in X[1:]:
        if np.array_equal(other, X[0]):
            numbers.append(first)
            continue
        far, who = search.nearest(other, 1)
        there = far[:, 0] < SAME_PLACE * search.width
        numbers.append(np.where(there, who[:, 0], len(first) + np.arange(len(other))))
    return numbers


def check_identities(moments: list[RowsAtTime], who: list[np.ndarray]) -> tuple[Finding, np.ndarray]:
    """Checks for duplicate and missing particles, by their numbers ``who`` (n,) at each time; returns the finding and
    the numbers of those that always exist."""
    common = np.unique(who[0])
    for one, now in zip(moments, who, strict=True):
        number, counts = np.unique(now, return_counts=True)
        if counts.max() > 1:
            p = int(number[np.argmax(counts)])
            twice = Finding(WHO, BROKEN, float(counts.max()), 1.0, "times",
                            f"particle {p} is there {counts.max()} times at t = {one.time:.4g} s", one.time, p)
            return twice, _always_present(who)
        if not np.array_equal(number, common):
            gone, come = np.setdiff1d(common, number), np.setdiff1d(number, common)
            p = int((gone if len(gone) else come)[0])
            told = [f"{len(part):,} particle{'s' * (len(part) != 1)} {word}"
                    for part, word in ((gone, "vanished"), (come, "appeared")) if len(part)]
            return Finding(WHO, SUSPICIOUS, float(len(gone) + len(come)), 0.0, "particles",
                           f"{' and '.join(told)} at t = {one.time:.4g} s, first particle {p}: fine where something "
                           "takes them out or lets them in, and only those that are always there were looked at",
                           one.time, p), _always_present(who)
    return Finding(WHO, HOLDS), common


def _always_present(who: list[np.ndarray]) -> np.ndarray:
    return functools.reduce(np.intersect1d, who[1:], np.unique(who[0]))
