"""Matching of files to grids of particles: their problem and scene, material points, and times."""

import contextlib
import itertools
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from solvers.estimators.standalone_companion import accurate_time_step
from solvers.judging import particle_data_types
from solvers.judging.particle_data_types import (
    Frame,
    ProblemMismatch,
    RawTable,
    SingleGridRun,
    identity_hint,
    list_names,
    row_times,
    unread_columns,
)
from solvers.judging.particle_identities import SURE, first_id, material_positions
from solvers.judging.quantity_names import LETTERS, TENSORS, VECTORS, describe_columns
from solvers.judging.scene_metadata import HINT, resolve_scene, scene_of_metadata
from solvers.problems import PROBLEMS
from solvers.scene.scene import Scene
from solvers.scene.validation import SceneError
from solvers.translatable_message import Message
from solvers.untrusted.quoting import FileError, quote

SAME = 1e-9  # of a period, within which times are the same
FLAT = 1e-6  # of the longest reach of all positions: a direction in which they reach no farther is none
MOST_STEPS = {1: 400_000, 2: 60_000}  # of the companion, by directions: a minute or two; 680 periods of the bar
LARGEST = 1e100  # of what a particle may have; beyond, squares are no numbers
COUNTS = (Message("no"), Message("one"), Message("two"), Message("three"))
RIGID = 10.0  # times the rest of the error: from there on a shift is that of an origin, and no error of a method


def match_files(files: Sequence[RawTable], asked: Scene, cells: Sequence[int],
                times: Sequence[float]) -> tuple[Scene, list[SingleGridRun]]:
    """Returns the scene that files are judged with, and their runs; arguments as in :func:`match_grids`.

    Raises :class:`ProblemMismatch` where the particles are not those of the scene, or the file is of another problem
    (its ``problems`` are those that the particles fit), :class:`FileError` where no scene fits them.
    """
    listed = list(files)
    own, notes = _resolve_scene(listed, asked)
    try:
        found = match_grids(listed, own, cells, times)
    except ProblemMismatch as misfit:
        number = next(k for k, raw in enumerate(listed) if raw.file == misfit.file)
        raise _suggest_problems(misfit, listed[number], own, times[number:number + 1]) from None
    return own, [replace(grid, notes=(*notes, *grid.notes)) for grid in found]


def metadata_scene_or_default(raw: RawTable, asked: Scene) -> Scene:
    """Returns the scene in a file's metadata, or the one asked for where it has none."""
    return asked if raw.metadata is None else scene_of_metadata(raw.file, raw.metadata)


def _resolve_scene(files: list[RawTable], asked: Scene) -> tuple[Scene, list[str]]:
    """Returns scene and notes as :func:`resolve_scene`. Raises FileError where particles contradict metadata."""
    try:
        return resolve_scene(files, asked)
    except ProblemMismatch as misfit:
        raw = next(raw for raw in files if raw.file == misfit.file)
        if _fits_scene(raw, scene_of_metadata(raw.file, raw.metadata), ()):  # type: ignore[arg-type]  # it says one
            raise
        raise FileError(raw.file, "{reason}, and its particles are not; {hint}", misfit.reason, HINT) from None


def _suggest_problems(misfit: ProblemMismatch, raw: RawTable, asked: Scene, times: Sequence[float]) -> ProblemMismatch:
    """Returns the error with the problems that the file fits: on the usual grid or the one asked for, or, where only
    ids identify its particles, on some grid."""
    others = tuple(name for name in PROBLEMS if name != asked.problem and any(
        _fits_scene(raw, other, times) for other in _usual_scenes(name, asked.cells)))
    if not others and "X" not in raw.columns:
        others = tuple(name for name, problem in PROBLEMS.items()
                       if name != asked.problem and len(problem.reference.axes) == count_directions(raw))
    if raw.metadata is None:
        return ProblemMismatch(misfit.file, misfit.reason, misfit.allowed, others)
    return ProblemMismatch(misfit.file, Message("is a file of the {problem}, and {reason}", Message(asked.problem),
                                                misfit.reason), HINT, others)


def _usual_scenes(problem: str, cells: int) -> Iterator[Scene]:
    yield PROBLEMS[problem].scene()
    with contextlib.suppress(SceneError):
        yield PROBLEMS[problem].scene(cells=cells)


def _fits_scene(raw: RawTable, asked: Scene, times: Sequence[float]) -> bool:
    """Returns whether a file's particles can be those of a scene."""
    with contextlib.suppress(FileError, SceneError):
        return bool(match_grids([raw], asked, [asked.cells], times))
    return False


def select_plane(raw: RawTable, plane: str) -> RawTable:
    """Returns the table with the two directions of ``plane``, such as xz, where it has three."""
    axes = [LETTERS.index(letter) for letter in plane]
    if "x" not in raw.columns or raw.columns["x"].shape[1] < 3:
        raise FileError(raw.file, "has no three directions, of which --plane {plane} takes two; leave it out", plane)
    taken = {key: values[:, axes] if key in VECTORS else values[:, axes][:, :, axes]
             for key, values in raw.columns.items() if key in (*VECTORS, *TENSORS) and values.shape[1] == 3}
    return replace(raw, columns=raw.columns | taken)


def match_grids(files: Sequence[RawTable], scene: Scene, cells: Sequence[int],
                times: Sequence[float]) -> list[SingleGridRun]:
    """Returns the runs in the files, coarse ones first. ``cells`` is the scene's own number, or one for each file, for
    files that contain none; ``times`` in s are those of the files in order, or empty where the files contain them."""
    tables: dict[int, list[tuple[RawTable, float | None]]] = {}
    for k, raw in enumerate(files):
        asked = (cells or [scene.cells])[k if len(cells) > 1 else 0]
        if raw.cells not in (None, asked) and asked != type(scene)().cells:
            raise FileError(raw.file, "states {cells} cells, but --cells is {asked}; give the value of the run, or "
                            "leave it out", raw.cells, asked)
        tables.setdefault(asked if raw.cells is None else raw.cells, []).append((raw, times[k] if times else None))
    return [_match_grid(count, tables[count], scene) for count in sorted(tables)]


def _match_grid(count: int, tables: Sequence[tuple[RawTable, float | None]], scene: Scene) -> SingleGridRun:
    """Returns the run on a grid of ``count`` cells from its files, each with its time in s from a flag, or None."""
    files, frames, notes = [raw for raw, _ in tables], list[Frame](), list[str]()
    try:
        own = replace(scene, cells=count)
    except SceneError as error:
        raise FileError(files[0].file, "belongs to a grid of {count} cells, which cannot be: {error}", quote(count),
                        error) from None
    if (first := first_id(files, own)) > 0:
        notes.append(Message("the ids seem to be counted from 1, and were read so"))
    for raw, given in tables:
        found, said = _match_frames(raw, own, first, given)
        frames += found
        notes += said
    step = next((raw.step for raw in reversed(files) if raw.step is not None), None)
    return SingleGridRun(count, _sort_frames_by_time(frames, scene), tuple(dict.fromkeys(notes)), step,
                         unread_columns(files))


def _match_frames(raw: RawTable, scene: Scene, first: int, given: float | None) -> tuple[list[Frame], list[str]]:
    """Returns a file's particles as one frame per time, and notes; ids begin with ``first``, and ``given`` is a time in
    s from a flag."""
    reference, columns = PROBLEMS[scene.problem].reference, raw.columns
    D = len(reference.axes)
    if "x" not in columns:
        raise FileError(raw.file, "has no positions ({d} or position); its columns are {name}",
                        describe_columns("x", D), list_names(raw.names))
    if not {"id", "row", "X"} & columns.keys():
        raise FileError(raw.file, "does not identify its particles: give id, from 0 in the order of `mpm-lab problem`, "
                        "the material position ({d}) or the displacement{hint}", describe_columns("X", D),
                        identity_hint(raw.not_read))
    times = row_times(raw, given)
    check_length(raw.file, scene, float(times.max()))
    whole: dict[str, np.ndarray] = {key: _drop_directions(raw, key, scene, D)
                                    for key in ("x", "X", "v", "F", "sigma") if key in columns}
    whole.update({key: columns[key] for key in ("mass", "volume") if key in columns})
    for key, values in whole.items():
        _check_finite(raw, key, values, times)
    _check_directions(raw, scene, D)
    notes, x = list[str](), whole["x"]
    X, number = material_positions(raw, scene, whole.get("X"), first)
    moved = reference.unwrap_positions(scene, X, x, times)
    if (turned := int((moved != x).any(axis=1).sum())) > 0:
        notes.append(Message("{turned:,} positions were moved back by a period of the grid", turned))
    found = []
    for at in particle_data_types.group_rows_by_time(times):
        part = {key: values[at] for key, values in whole.items()}
        who = number[at] if {"id", "row"} & columns.keys() else np.arange(len(times[at]))
        frame = Frame(raw.file, float(times[at][0]), who, X[at], moved[at], part.get("v"), part.get("F"),
                      part.get("sigma"), part.get("mass"), part.get("volume"))
        _check_unique_particles(frame)
        if "X" not in columns and frame.time == 0:
            off = np.sum((frame.position - frame.material_position) ** 2, axis=1)
            if (far := float(np.sqrt(np.mean(off)))) > SURE * scene.spacing:
                reason = Message("has particles at t = 0 that are {far:.3g} m off the initial positions of the "
                                 "{problem}", far, Message(scene.problem))
                raise ProblemMismatch(frame.file, reason, Message(
                    "give ids in the order of `mpm-lab problem`, the right --cells and --ppc, or material positions"))
        found.append(frame)
    return found, notes


def check_length(file: str, scene: Scene, time: float) -> None:
    """Raises FileError for a ``time`` in s to which the companion (reference solution) would take too many steps."""
    a_step = accurate_time_step(PROBLEMS[scene.problem].reference.companion(scene, True))
    most = MOST_STEPS[scene.DIMENSIONS]
    if not time <= most * a_step:
        raise FileError(file, "has the time {time:.6g} s, to which the companion that it is compared with takes "
                        "{steps:.3g} steps; at most {most:,} are allowed, so give times up to {longest:.4g} s", time,
                        time / a_step, most, most * a_step)


def _drop_directions(raw: RawTable, key: str, scene: Scene, D: int) -> np.ndarray:
    """Returns a quantity as (n, D) or (n, D, D), in the problem's D directions; others in the file are left out."""
    values = raw.columns[key]
    size = values.shape[1]
    if size < D:
        reason = Message("has {key} in {size}, and the {problem} has {counts}", key, _direction_count_text(size),
                         Message(scene.problem), COUNTS[D])
        raise ProblemMismatch(raw.file, reason, Message("give {key}", describe_columns(key, D)))
    return values[:, :D] if values.ndim == 2 else values[:, :D, :D]


def _check_directions(raw: RawTable, scene: Scene, D: int) -> None:
    """Raises FileError for positions that extend in more directions than the problem has, or in fewer."""
    found = count_directions(raw)
    if found is not None and found != D and (found > D or len(raw.columns["x"]) > D):
        more = Message("{found}, and the {problem} has {n}", _direction_count_text(found), Message(scene.problem),
                       COUNTS[D])
        upright = found == 3 and D == 2 and np.ptp(raw.columns["x"][:, 1]) == 0
        wanted = Message("give --plane xz, if that is its plane") if upright else Message(
            "give {d} and nothing beyond" if found > D else "give {d} of particles that are not all on one line",
            d=describe_columns("x", D))
        raise ProblemMismatch(raw.file, Message("has positions in {more}", more), wanted)


def count_directions(raw: RawTable) -> int | None:
    """Returns the number of directions in which a file's positions extend, 1 to 3; None where that is unknown."""
    x = raw.columns.get("x", np.empty((0, 1)))
    reach = np.ptp(x, axis=0) if len(x) > 1 else np.zeros(1)
    return 1 + int(np.flatnonzero(reach > FLAT * reach.max())[-1]) if 0 < reach.max() < np.inf else None


def _direction_count_text(count: int) -> str:
    return Message("{count} direction{plural}", COUNTS[count], "s" * (count != 1))


def _check_finite(raw: RawTable, key: str, values: np.ndarray, times: np.ndarray) -> None:
    bad = ~(np.abs(values.reshape(len(values), -1)) < LARGEST).all(axis=1)
    if bad.any():
        row = int(np.argmax(bad))
        who = Message("particle {columns:g}", raw.columns["id"][row]) if "id" in raw.columns else \
            Message("row {row}", row + 1)
        what = Message("beyond {most:g}", LARGEST) if np.isfinite(values[bad]).all() else Message("no number")
        raise FileError(raw.file, "has {key} that is {what} in {bad:,} of {all_rows:,} rows, first {who} at t = "
                        "{times:g} s; leave times out at which the run had gone bad", key, what, int(bad.sum()),
                        len(bad), who, times[row])


def _check_unique_particles(frame: Frame) -> None:
    number, counts = np.unique(frame.number, return_counts=True)
    if counts.max() > 1:
        raise FileError(frame.file, "has particle {number} {counts} times at t = {time:g} s; give each once at each "
                        "time", number[np.argmax(counts)], counts.max(), frame.time)
    _, first, counts = np.unique(frame.material_position, axis=0, return_index=True, return_counts=True)
    if counts.max() > 1:
        place = ", ".join(f"{c:.6g}" for c in frame.material_position[first[np.argmax(counts)]])
        raise FileError(frame.file, "has {counts} particles with the material position {place} at t = {time:g} s; give "
                        "each its own", counts.max(), place, frame.time)


def _sort_frames_by_time(frames: list[Frame], scene: Scene) -> tuple[Frame, ...]:
    frames = sorted(frames, key=lambda frame: frame.time)
    for one, other in itertools.pairwise(frames):
        if other.time - one.time <= SAME * scene.period:
            raise FileError(other.file, "has the time {time:g} s, which {file} has too, on one grid; give each time of "
                            "a grid once, and --cells with one number for each file of several grids", other.time,
                            quote(one.file))
    return tuple(frames)


def check_origin(frame: Frame, error: np.ndarray, scene: Scene) -> None:
    """Raises FileError for particles shifted together: ``error`` (P, D) of x in m is nearly uniform and over a cell."""
    mean = error.mean(axis=0)
    rest = float(np.sqrt(np.mean(np.sum((error - mean) ** 2, axis=1))))
    if np.linalg.norm(mean) > max(scene.spacing, RIGID * rest):
        told = ", ".join(f"{c:.4g}" for c in mean)
        raise FileError(frame.file, "has all positions shifted by {told} m at t = {time:g} s: its origin is another; "
                        "give positions from the same origin as the material positions", told, frame.time)
