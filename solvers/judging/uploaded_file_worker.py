"""Preparation of a file of particles for display, in a process of its own: the page never opens the file itself.

The process sends, in this order::

    {"frames": {...}}     the file can be judged: a :class:`FileSummary`; true errors are in the table
    {"estimate": {...}}   the companion's estimate is in the table too: its norms over time
    {"verdict": {...}}    the grid's part of the judge's report
    {"refused": sentence} it cannot be judged, and nothing more follows
    {"asks": {...}}       its particles are of another problem: the ``reason``, and the ``problems`` that they fit

The table is a memory-mapped file, so that it uses memory only while a frame is displayed.
"""

import contextlib
import itertools
import sys
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np

from solvers.judging import error_norms
from solvers.judging.error_norms import Errors, TwoMeshCompanion, as_json, frame_stress, norm_series
from solvers.judging.judgement import SingleGridJudgement
from solvers.judging.particle_data_types import Frame, ProblemMismatch, SingleGridRun
from solvers.judging.particle_readers import PACKED, UPLOADED, kind_of, read_file
from solvers.judging.particle_scene_matching import match_files, metadata_scene_or_default
from solvers.problems import PROBLEMS
from solvers.scene.scene import Scene
from solvers.scene.validation import SceneError
from solvers.solver.samples import QUANTITIES
from solvers.study.parameter_grid import Task, task_of
from solvers.translatable_message import Message
from solvers.untrusted.quoting import FileError
from solvers.untrusted.size_limits import SizeLimits

#: Of a file, so that a page can show it.
LIMITS = SizeLimits(bytes=400_000_000, columns=1000, rows=2_000_000, numbers=25_000_000, times=2000,
                    otherwise=Message(", or judge it with `mpm-lab judge`"))
MEMORY = 3_000_000_000  # bytes that the process may ask for
TOO_LARGE = Message("needs more memory than a page gives it; give fewer times, or judge it with `mpm-lab judge`")


@dataclass(frozen=True)
class JudgeFileRequest:
    """Request to display a ``file`` (path) that its owner calls ``name``: the task of the scene that it is judged with,
    the path of the ``table`` to write, and the largest number of particles at a time. If its owner has ``chosen`` the
    scene, that overrides the one in the file."""

    file: str
    name: str
    task: dict
    table: str
    most: int
    chosen: bool = False


@dataclass(frozen=True)
class FileSummary:
    """Summary of the table: the scene, T times in s, at each the number of particles and of those that have ``crossed``
    a cell boundary since the time before, and the norms of the true error over time by quantity, None where unknown.
    ``missing`` are quantities that the file does not have."""

    task: dict
    times: list[float]
    counts: list[int]
    crossed: list[int]
    norms: dict[str, list[float | None]] | None
    missing: list[str]


def table_columns(dimensions: int) -> dict[str, slice]:
    """Returns the columns of each field in the table (rows, width); the last one ends at its width. ``field`` has, in
    one dimension, two per quantity: its value for a plot and its deviation from the exact one; ``crossed`` is 1 where
    the particle was in another cell at the time before. Errors and estimates have one per quantity, their sizes."""
    widths = {"position": dimensions, "displacement": dimensions, "crossed": 1, "error": len(QUANTITIES),
              "estimate": len(QUANTITIES), "difference": len(QUANTITIES),
              "field": 2 * len(QUANTITIES) if dimensions == 1 else 0}
    ends = np.cumsum([0, *widths.values()]).tolist()
    return {name: slice(start, end) for name, start, end in zip(widths, ends[:-1], ends[1:], strict=True)}


def judge_in_worker(question: dict, tell: Callable[[dict], None]) -> None:
    """Answers a :class:`JudgeFileRequest` dict: writes its table, passes summary and verdict or error to ``tell``."""
    asked = JudgeFileRequest(**question)
    if sys.platform == "linux":  # a file may unpack to a huge size: protect the machine's memory
        import resource
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    try:
        _judge_file(asked, tell)
    except ProblemMismatch as misfit:
        if misfit.problems:
            tell({"asks": {"reason": misfit.reason, "problems": list(misfit.problems)}})
        else:
            tell({"refused": Message("The file {name} {sentence}", asked.name, misfit.sentence)})
    except FileError as error:
        tell({"refused": Message("The file {name} {sentence}", asked.name, error.sentence)})
    except SceneError as error:
        tell({"refused": Message("The file {name} cannot be judged with these settings: {error}", asked.name, error)})
    except MemoryError:
        tell({"refused": Message("The file {name} {too_large}", asked.name, TOO_LARGE)})


def _judge_file(asked: JudgeFileRequest, tell: Callable[[dict], None]) -> None:
    if kind_of(asked.file).removesuffix(PACKED) not in UPLOADED:
        raise FileError(asked.name, "is of no kind that is known; give a file that ends in {kinds}",
                        ", ".join(UPLOADED))
    raw = replace(read_file(asked.file, LIMITS), file=asked.name)
    raw = replace(raw, metadata=None) if asked.chosen else raw
    scene, [grid] = match_files([raw], metadata_scene_or_default(raw, Task(**asked.task).scene()), [], [])
    del raw
    own = replace(scene, cells=grid.cells)
    most = max(own.particles, *(len(frame.number) for frame in grid.frames))
    if most > asked.most:
        raise FileError(asked.name, "belongs to {count:,} particles, too many to watch; give at most {most:,} at a "
                        "time, or judge it with `mpm-lab judge`", most, asked.most)
    judged = SingleGridJudgement(own, grid, TwoMeshCompanion(own, tuple(grid.times.tolist())))
    judged.check_coordinate_origin()  # without a known truth only the companion can check the origin
    true = judged.true_errors
    table = _ParticleTableWriter(own, grid, asked.table)
    table.write_frames()
    table.write_errors("error", true)
    counts = [len(frame.number) for frame in grid.frames]
    missing = [q for q in ("v", "sigma") if any(
        (frame.velocity if q == "v" else frame_stress(own, frame)) is None for frame in grid.frames)]
    shown = replace(own, estimators=("companion",), effects=("truth", "estimate", "crossings"), remedies=(), dt=None,
                    cfl=None, sample_every=None)
    with contextlib.suppress(SceneError):  # to its usual end, or where that is too many steps to its own
        shown = replace(shown, t_end=None, periods=None)
    tell({"frames": asdict(FileSummary(task_of(shown).to_dict(), grid.times.tolist(), counts, table.crossed,
                                       as_json(norm_series(true)) if true else None, missing))})
    if true:
        table.write_errors("difference", error_norms.differences(judged.companion_errors, true))
    table.write_errors("estimate", judged.companion_errors)
    tell({"estimate": as_json(norm_series(judged.companion_errors))})
    tell({"verdict": judged.to_dict()})


class _ParticleTableWriter:
    """Table of the rows of all frames, one frame after the other, in single precision, in the file ``path``."""

    def __init__(self, scene: Scene, grid: SingleGridRun, path: str):
        self._scene, self._grid, self._columns = scene, grid, table_columns(scene.DIMENSIONS)
        ends = np.cumsum([0, *(len(frame.number) for frame in grid.frames)]).tolist()
        self._rows = [slice(start, end) for start, end in itertools.pairwise(ends)]
        self.crossed: list[int] = []
        width = max(part.stop for part in self._columns.values())
        self._values = np.memmap(path, np.float32, "w+", shape=(ends[-1], width))
        for name in ("error", "estimate", "difference", "field"):
            self._values[:, self._columns[name]] = np.nan

    def write_frames(self) -> None:
        """Writes positions, cell crossings and the bar's plotted fields to the table on disk."""
        frames = self._grid.frames
        crossings = error_norms.cell_crossing_masks(self._scene, frames)
        for rows, frame, moved in zip(self._rows, frames, crossings, strict=True):
            self.crossed.append(int(moved.sum()))
            self._values[rows, self._columns["crossed"]] = moved[:, None]
            self._values[rows, self._columns["position"]] = frame.position
            self._values[rows, self._columns["displacement"]] = frame.position - frame.material_position
            for q, both in self._fields_and_deviations(frame).items() if self._scene.DIMENSIONS == 1 else ():
                column = self._columns["field"].start + 2 * QUANTITIES.index(q)
                self._values[rows, column:column + 2] = both

    def write_errors(self, name: str, errors: Sequence[Errors]) -> None:
        """Writes the sizes of each frame's errors to the columns ``name``: error, estimate or difference."""
        for rows, error in zip(self._rows, errors, strict=False):  # there may be none
            for q, values in error.items():
                column = self._columns[name].start + QUANTITIES.index(q)
                self._values[rows, column] = error_norms.error_magnitudes(values)
        self._values.flush()

    def _fields_and_deviations(self, frame: Frame) -> dict[str, np.ndarray]:
        """Returns by quantity the bar's field and its deviation from the exact one (P, 2), NaN if unknown."""
        scene, X, t = self._scene, frame.material_position, frame.time
        reference, found = PROBLEMS[scene.problem].reference, {}
        exact = {"x": reference.displacement(scene, X, t), "v": reference.velocity(scene, X, t),
                 "sigma": reference.exact_stress(scene, X, t)} if scene.solution_known else {}
        own = {"x": frame.position - X, "v": frame.velocity, "sigma": frame_stress(scene, frame)}
        for q, values in own.items():
            if values is not None:
                field, right = values.ravel(), exact[q].ravel() if exact else np.full(len(X), np.nan)
                carried = exact and q == "x" and not scene.swings
                drift = right if carried else 0.0  # what carries all alike is not plotted
                found[q] = np.stack([field - drift, field - right], axis=1)
        return found


def open_table(path: Path, counts: Sequence[int], dimensions: int) -> np.ndarray:
    """Opens the table (rows, width) of a file with these ``counts`` of particles at its times, for reading."""
    width = max(part.stop for part in table_columns(dimensions).values())
    return np.memmap(path, np.float32, "r", shape=(sum(counts), width))
