"""Whose particles a file has: those of the problem that it is to be judged as, or of which other."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Sequence
from dataclasses import replace

from solvers.judging.frames import Grid, Misfit, Raw
from solvers.judging.placing import directions, grids
from solvers.judging.said import HINT, scene, settled
from solvers.outside.file_error import FileError
from solvers.problems import PROBLEMS
from solvers.scene.rules import SceneError
from solvers.scene.scene import Scene


def placed(files: Sequence[Raw], asked: Scene, cells: Sequence[int],
           times: Sequence[float]) -> tuple[Scene, list[Grid]]:
    """The scene that files are judged with, and their runs (``placing.grids``).

    Raises
    ------
    Misfit
        Where the particles are not those of the scene, or the file says another problem: its ``problems`` are those
        that the particles fit.
    FileError
        Where they can be judged with no scene.
    """
    listed = list(files)
    own, notes = _settled(listed, asked)
    try:
        found = grids(listed, own, cells, times)
    except Misfit as misfit:
        number = next(k for k, raw in enumerate(listed) if raw.file == misfit.file)
        raise _told(misfit, listed[number], own, times[number:number + 1]) from None
    return own, [replace(grid, notes=(*notes, *grid.notes)) for grid in found]


def own_scene(raw: Raw, asked: Scene) -> Scene:
    """The scene that a file says that it is of, or the one asked for where it says none."""
    return asked if raw.said is None else scene(raw.file, raw.said)


def _settled(files: list[Raw], asked: Scene) -> tuple[Scene, list[str]]:
    """What the files say, where the particles bear it out."""
    try:
        return settled(files, asked)
    except Misfit as misfit:
        raw = next(raw for raw in files if raw.file == misfit.file)
        if _fits(raw, scene(raw.file, raw.said), ()):  # type: ignore[arg-type]  # it says one
            raise
        raise FileError(raw.file, f"{misfit.reason}, and its particles are not; {HINT}") from None


def _told(misfit: Misfit, raw: Raw, asked: Scene, times: Sequence[float]) -> Misfit:
    """The same with the problems that the file fits: on the usual grid or the one asked for, or, where it knows its
    particles by ids alone, on some grid."""
    others = tuple(name for name in PROBLEMS if name != asked.problem and any(
        _fits(raw, other, times) for other in _usual(name, asked.cells)))
    if not others and "X" not in raw.columns:
        others = tuple(name for name, problem in PROBLEMS.items()
                       if name != asked.problem and len(problem.reference.axes) == directions(raw))
    if raw.said is None:
        return Misfit(misfit.file, misfit.reason, misfit.allowed, others)
    return Misfit(misfit.file, f"says that it is of the {asked.problem}, and {misfit.reason}", HINT, others)


def _usual(problem: str, cells: int) -> Iterator[Scene]:
    yield PROBLEMS[problem].scene()
    with contextlib.suppress(SceneError):
        yield PROBLEMS[problem].scene(cells=cells)


def _fits(raw: Raw, asked: Scene, times: Sequence[float]) -> bool:
    """Whether a file's particles can be those of a scene, whatever else is wrong with it."""
    with contextlib.suppress(FileError, SceneError):
        return bool(grids([raw], asked, [asked.cells], times))
    return False
