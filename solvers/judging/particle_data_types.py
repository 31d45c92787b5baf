"""Particles as rows of a file and as frames at one time, of any code, and the grids that they belong to."""

import itertools
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from solvers.translatable_message import Message, join_messages
from solvers.untrusted import quoting
from solvers.untrusted.quoting import FileError


class ProblemMismatch(FileError):
    """Error for particles unfit for a problem: ``reason``, what is ``allowed``, and names of ``problems`` they fit."""

    def __init__(self, file: str, reason: str, allowed: str, problems: tuple[str, ...] = ()):
        self.reason, self.allowed, self.problems = quoting.one_line(reason), allowed, problems
        commands = join_messages(" or ", (f"`mpm-lab judge {problem}`" for problem in problems))
        super().__init__(file, "{reason}; {fits}", reason,
                         Message("it fits {commands}", commands) if problems else allowed)


@dataclass(frozen=True)
class SceneMetadata:
    """Scene in a file's metadata: the problem, and those of its inputs that matter to a judge, by field names."""

    problem: str
    inputs: Mapping[str, Any]
    step: float | None = None  # of its run, s


@dataclass(frozen=True)
class RawTable:
    """A file as it was read: one table of n rows. ``columns`` maps quantities to (n, ...), vectors (n, d) and tensors
    (n, d, d) with the file's number of dimensions; ``cells`` is its number of grid cells, ``time`` is in s.
    ``not_read`` are the columns whose names are not known; X may be ``from_displacement``, as exact as that is."""

    file: str
    columns: dict[str, np.ndarray]
    names: tuple[str, ...]  # of everything in the file, for messages
    time: float | None = None
    cells: int | None = None
    metadata: SceneMetadata | None = None
    step: float | None = None  # of its run in s, if known
    not_read: tuple[str, ...] = ()
    from_displacement: bool = False


@dataclass(frozen=True)
class Frame:
    """P particles at a ``time`` in s: material position and position (P, D) in m, and if known velocity (P, D), F and
    Cauchy stress (P, D, D), mass in kg and volume in m^D (P,); and the ``number`` (P,) of each: its id, or its row."""

    file: str
    time: float
    number: np.ndarray
    material_position: np.ndarray
    position: np.ndarray
    velocity: np.ndarray | None = None
    deformation_gradient: np.ndarray | None = None
    stress: np.ndarray | None = None
    mass: np.ndarray | None = None
    volume: np.ndarray | None = None


@dataclass(frozen=True)
class SingleGridRun:
    """Frames of one run on a grid of ``cells``, sorted by time; ``notes`` are sentences about the files, ``not_read``
    the names of columns that are not known."""

    cells: int
    frames: tuple[Frame, ...]
    notes: tuple[str, ...] = ()
    step: float | None = None  # of the run, s
    not_read: tuple[str, ...] = ()

    @property
    def times(self) -> np.ndarray:
        return np.array([frame.time for frame in self.frames])


def unread_columns(files: Iterable[RawTable]) -> tuple[str, ...]:
    """Returns the names of the columns that are not known, of all files, each once."""
    return tuple(dict.fromkeys(name for raw in files for name in raw.not_read))


def list_names(names: Sequence[str], most: int = 12) -> str:
    """Returns names of columns with commas, for a sentence, the first ones of many."""
    listed = join_messages(", ", (quoting.quote(name, 30) for name in names[:most]))
    return Message("{listed} and {count} more", listed, len(names) - most) if len(names) > most else listed


def identity_hint(not_read: Sequence[str]) -> str:
    """Returns the end of a sentence on columns that were not read, one of which may identify particles; "" if all
    were."""
    return Message("; not read: {names}; if one of them says which particle is which, call it id",
                   list_names(not_read)) if not_read else ""


def row_times(raw: RawTable, given: float | None) -> np.ndarray:
    """Returns the time of each row (n,) in s, from the column t, the file itself or ``given`` by a flag. Raises
    FileError where these contradict each other, or there is none."""
    n = len(next(iter(raw.columns.values())))
    column = raw.columns.get("t")
    said: list[tuple[str, Any]] = [(Message("its column t"), column)] if column is not None else []
    said += [(Message("the file itself"), raw.time)] if raw.time is not None else []
    said += [("--time", given)] if given is not None else []
    if not said:
        raise FileError(raw.file, "has no time; give a column t, or # t = ... in a .csv, t in a .npz, TimeValue in "
                                  "VTK's formats, or the flag --time with one time for each file")
    first = np.broadcast_to(np.asarray(said[0][1], float), (n,))
    for name, value in said[1:]:
        if not np.all(np.abs(first - np.asarray(value)) <= 1e-9 * np.maximum(np.abs(first), 1e-300)):
            raise FileError(raw.file, "has times that do not match: {said} has {first:g} s and {name} has {value:g} s; "
                            "give one of the two", said[0][0], first[0], name, float(np.ravel(value)[0]))
    if not np.isfinite(first).all() or (first < 0).any():
        bad = first[~(np.isfinite(first) & (first >= 0))][0]
        raise FileError(raw.file, "has the time {bad:g}; give seconds from 0 on", bad)
    return first


def group_rows_by_time(times: np.ndarray) -> Iterator[Any]:
    """Yields an index of the rows of each time, in order: a slice if rows are sorted by time, as usual."""
    order = None if (np.diff(times) >= 0).all() else np.argsort(times, kind="stable")
    _, first = np.unique(times if order is None else times[order], return_index=True)
    for start, end in itertools.pairwise([*first.tolist(), len(times)]):
        yield slice(start, end) if order is None else order[start:end]
