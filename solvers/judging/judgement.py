"""Judgement of particles: everything known about their errors, as an object and as JSON."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from solvers.judging import error_norms
from solvers.judging.error_norms import QUANTITIES, Errors, TwoMeshCompanion, WorstParticle
from solvers.judging.findings import outliers
from solvers.judging.findings.all_findings import find_in_run
from solvers.judging.findings.finding import Finding
from solvers.judging.findings.findings_input import FindingsInput, detect_precision, sample_numbers
from solvers.judging.findings.outliers import FrameOutliers
from solvers.judging.findings.time_series_fitting import rms
from solvers.judging.moment_joining import join_moments
from solvers.judging.particle_data_types import SingleGridRun
from solvers.judging.particle_readers import Particles, as_list, check_one_table_each, read_all
from solvers.judging.particle_scene_matching import SAME, check_origin, match_files, select_plane
from solvers.judging.quantity_names import PLANES
from solvers.scene.scene import Scene
from solvers.scene.validation import SceneError
from solvers.solver.error_series import finite_or_none
from solvers.solver.rounding import largest_rounding_error
from solvers.study.convergence_order import ConvergenceOrder, fit_order
from solvers.translatable_message import Message

if TYPE_CHECKING:
    from solvers.judging.reference_runs import ReferenceRun

SCHEMA = "mpm-lab/judge/1"
Progress = Callable[[float, str], None]


@dataclass(frozen=True)
class SingleGridJudgement:
    """Judgement of one grid's particles, computed on first use. Errors are by quantity, in the order of the frames;
    ``ours`` are runs of our own methods on the grid."""

    scene: Scene
    grid: SingleGridRun
    companions: TwoMeshCompanion
    ours: list[ReferenceRun] = field(default_factory=list)

    @functools.cached_property
    def true_errors(self) -> list[Errors]:
        """Values minus the exact solution; empty where that is unknown."""
        frames = self.grid.frames if self.scene.solution_known else ()
        return [error_norms.true_errors(self.scene, frame) for frame in frames]

    @functools.cached_property
    def companion_errors(self) -> list[Errors]:
        """Values minus the companion's, a reference solution."""
        return [self.companions.errors(frame) for frame in self.grid.frames]

    @functools.cached_property
    def _findings(self) -> tuple[list[Finding], FrameOutliers | None]:
        errors = functools.partial(error_norms.true_errors, self.scene) if self.true_errors else self.companions.errors
        return find_in_run(FindingsInput(self.scene, self.grid.frames, self.best_known_errors, errors,
                                         self.grid.step or self.scene.time_step))

    @property
    def checks(self) -> list[Finding]:
        """Findings of all comparisons beside the errors, with their tolerances."""
        return self._findings[0]

    @property
    def position_outliers(self) -> FrameOutliers | None:
        """Frame in which most particles are not where their neighbours are, with these particles; or None."""
        return self._findings[1]

    @property
    def best_known_errors(self) -> list[Errors]:
        """Errors against the best reference: the exact solution, or the companion."""
        return self.true_errors or self.companion_errors

    @property
    def norms(self) -> dict[str, np.ndarray]:
        return error_norms.norm_series(self.best_known_errors)

    def check_coordinate_origin(self) -> None:
        """Raises FileError for particles that are shifted as a whole, by more than a cell."""
        for frame, error in zip(self.grid.frames, self.best_known_errors, strict=True):
            check_origin(frame, error["x"], self.scene)

    def largest_rounding_error(self, quantity: str) -> float:
        """Returns the largest RMS error of x, v or sigma, in SI, that rounding alone may make: in the run's steps, and
        of the numbers in the files."""
        name = {"x": "position", "v": "velocity", "sigma": "stress"}[quantity]
        stored = [values for frame in self.grid.frames if (values := getattr(frame, name)) is not None]
        written = 0.0
        if stored:
            numbers = sample_numbers(stored)
            written = rms(detect_precision(numbers).rounding(numbers)) * stored[0][0].size ** 0.5
        steps = self.grid.times[-1] / (self.grid.step or self.scene.time_step)
        return max(written, float(largest_rounding_error(self.scene, quantity, steps)))

    def worst(self, quantity: str) -> WorstParticle | None:
        return error_norms.largest_error(self.grid.frames, self.best_known_errors, quantity)

    def to_dict(self) -> dict:
        times, frames = self.grid.times, self.grid.frames
        estimates = error_norms.norm_series(self.companion_errors)
        true = error_norms.norm_series(self.true_errors) if self.true_errors else None
        doubts = [self.companions.mesh_difference(frame) for frame in frames]
        estimate = {"companion": error_norms.summarise_norms(times, estimates), "norms": error_norms.as_json(estimates),
                    "own_error": {q: finite_or_none(float(np.max([doubt[q] for doubt in doubts]))) for q in QUANTITIES},
                    "index": None if true is None else error_norms.effectivity(estimates, true, self.scene),
                    "distance": None if true is None else error_norms.distances(self.companion_errors,
                                                                                self.true_errors)}
        return {"cells": self.grid.cells, "h": self.scene.spacing, "files": list(dict.fromkeys(f.file for f in frames)),
                "particles": len(frames[-1].number), "times": times.tolist(), "notes": self.notes(),
                "not_read": list(self.grid.not_read),
                "checks": [one.to_judge_dict() for one in self.checks],
                "error": None if true is None else error_norms.summarise_norms(times, true),
                "norms": None if true is None else error_norms.as_json(true), "estimate": estimate,
                "worst": {q: None if (found := self.worst(q)) is None else found.to_dict() for q in QUANTITIES},
                "neighbour_gap": None if self.position_outliers is None else self.position_outliers.to_dict(self.scene),
                "crossings_at_least": error_norms.count_crossings(self.scene, frames),
                "ours": [run.to_dict() for run in self.ours]}

    def notes(self) -> list[str]:
        """Returns sentences about the files."""
        missing = [q for q in QUANTITIES if any(q not in e for e in self.best_known_errors)]
        wrong = [one.says for one in self.checks if one.is_contradiction and one.name != BY_PLACE]
        return [*self.grid.notes, *(Message("no {q} was read (or not at every time), so it is not judged", NAMES[q])
                                    for q in missing), *wrong]


BY_PLACE = outliers.NAMES["x"]  # which has a sentence of its own
NAMES = {"x": Message("position"), "v": Message("velocity"), "sigma": Message("stress (nor F)")}


@dataclass(frozen=True)
class Judgement:
    """Judgement of all files, coarse grids first."""

    scene: Scene
    grids: list[SingleGridJudgement]

    def common_times(self) -> list[float]:
        """Returns the times that all grids have, in s."""
        first, *others = (g.grid.times for g in self.grids)
        near = SAME * self.scene.period
        return [float(t) for t in first if all(np.abs(other - t).min() <= near for other in others)]

    def largest_common_norm(self, judged: SingleGridJudgement, quantity: str) -> float:
        """Returns a quantity's largest RMS error on a grid, over grids' common times in s after 0; NaN if none."""
        common, near = np.array([t for t in self.common_times() if t > 0]), SAME * self.scene.period
        at = [k for k, t in enumerate(judged.grid.times) if (np.abs(common - t) <= near).any()]
        values = judged.norms[quantity][at]
        return float(values.max()) if len(values) and np.isfinite(values).all() else float("nan")

    @functools.cached_property
    def orders(self) -> dict[str, ConvergenceOrder | None]:
        """Orders in h, by quantity, of the largest RMS errors over the common times; None where these are unknown."""
        h = [g.scene.spacing for g in self.grids]
        return {q: fit_order(h, [self.largest_common_norm(g, q) for g in self.grids], self.scene.size_of(q),
                             [g.largest_rounding_error(q) for g in self.grids]) for q in QUANTITIES}

    def to_dict(self) -> dict:
        orders = None if len(self.grids) < 2 else {q: fit and asdict(fit) for q, fit in self.orders.items()}
        return {"schema": SCHEMA, "problem": self.scene.problem, "scene": self.scene.to_dict(),
                "against": "truth" if self.scene.solution_known else "companion",
                "grids": [g.to_dict() for g in self.grids], "common_times": self.common_times(), "order": orders}


def judge(scene: Scene, files: Particles | Sequence[Particles], *, cells: Sequence[int] = (),
          times: Sequence[float] = (), plane: str = PLANES[0], compare: bool = False,
          on_progress: Progress = lambda part, what: None) -> Judgement:
    """Judges the particles of any code that ran a scene's problem: how large their errors are, where, and their order.

    ``scene`` is the problem and its parameters; methods, estimators, effects and remedies do not matter here. Our own
    files contain their scene, which replaces every input that has its default here.

    ``files`` is a path (text, .npz or one of VTK's), a mapping from names to arrays, or several of these, of one grid
    or more. Arrays are (P,), (P, D) or (P, D, D) of one time ``t``, or (T, P, ...) of T times (T,), in SI units: ``x``
    and ``id`` or ``X``, and ``v``, ``F``, ``sigma`` if known; ``cells`` is the number of grid cells.

    Where files contain none, ``cells`` are those of the grid, one number for all files or one for each (default: the
    scene's), and ``times`` has the time of each file in s. ``plane`` says which directions of three, xy, xz or yz, are
    those of a plane problem. With ``compare`` our own methods run on the same grids for
    comparison; ``on_progress`` is called now and then with the part done (0 to 1) and the name of the present stage.

    The result's ``to_dict()`` is the object of ``mpm-lab judge``'s report.json. Raises :class:`FileError` for files, or
    arrays, that cannot be judged, :class:`~solvers.judging.particle_data_types.ProblemMismatch` for those of another
    problem, :class:`SceneError` where ``cells`` or ``times`` do not fit the files, or a companion is lost.
    """
    sources = as_list(files)
    for name, given, counts in (("cells", cells, {1, len(sources)}), ("time", times, {len(sources)})):
        if given and len(given) not in counts:
            raise SceneError(name, " ".join(map(str, given)), "is {given} numbers for {sources} files; give one for "
                             "each", len(given), len(sources))
    tables = read_all(sources)
    check_one_table_each(sources, tables, times or cells[1:])
    tables, cells, times = join_moments(tables, cells or [scene.cells], times)
    if plane != PLANES[0]:
        tables = [select_plane(raw, plane) for raw in tables]
    scene, found = match_files(tables, scene, cells, times)
    companions = TwoMeshCompanion(scene, tuple(sorted({frame.time for grid in found for frame in grid.frames})))
    judged: list[SingleGridJudgement] = []
    for k, grid in enumerate(found):
        one = SingleGridJudgement(replace(scene, cells=grid.cells), grid, companions)
        on_progress(k / len(found), f"{grid.cells} cells: companion")
        one.check_coordinate_origin()
        assert one.companion_errors  # worked out here, where it may fail and is waited for
        if compare:
            one.ours.extend(_run_methods(one, lambda part, what: on_progress((len(judged) + part) / len(found), what)))
        judged.append(one)
    return Judgement(scene, judged)


def _run_methods(one: SingleGridJudgement, on_progress: Progress) -> Iterator[ReferenceRun]:
    """Yields runs of our own methods on the grid of a judgement, at the same times."""
    from solvers.judging.reference_runs import reference_scenes, run_reference  # here, so that only this needs Taichi

    scenes = reference_scenes(one.scene)
    for n, scene in enumerate(scenes):
        def tell(part: float, n: int = n, method: str = scene.method) -> None:
            on_progress((n + part) / len(scenes), f"{one.grid.cells} cells: our {method}")

        yield run_reference(scene, one.grid.times.tolist(), None if one.true_errors else one.companions, tell)
