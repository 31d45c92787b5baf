"""A run as a recording: particles, errors and all norms at several instants, as tracks."""

import base64
import itertools
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import as_completed
from contextlib import closing
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from app import shareable_state
from app.export.player_display_data import missing_value_texts, stage_notes
from app.export.recording_compression import NUMBER, PLACE, SIGNED, SIZE, Track, pack_tracks
from app.frame.budget_chart_data import estimated_error_note
from app.frame.colour_scale import LEAST_REACH, LEAST_TOP
from app.frame.error_view_captions import why_no_field
from app.frame.planar_stage import PlanarStage
from app.frame.stage import marking_stride
from app.language.translation import ENGLISH, tr, use_language
from app.problems.views import VIEWS
from solvers.running.run import build
from solvers.scene.error_causes import CAUSES, FIELDS, cause_labels
from solvers.scene.kernel_options import kernel_key
from solvers.scene.scene import Scene
from solvers.scene.step_bound import gershgorin_to_linear_factor
from solvers.solver import budget_shares, samples
from solvers.solver.base import Solver
from solvers.solver.error_series import RATIOS
from solvers.solver.particle_snapshot import Snapshot
from solvers.solver.rounding import largest_rounding_error
from solvers.solver.soundness import earliest_finding, findings
from solvers.solver.verdict_basis import LargeRelativeError, large_errors, merge_large_errors
from solvers.workers.worker_pool import WorkerPool, one_of_each_first

CURVE_POINTS = 41  # of the exact field
FARTHEST = 2.0  # metres: clip for particles of a broken run


@dataclass(frozen=True)
class RecordingRequest:
    """Request to record a run: at ``frame_count`` instants at most ``particles``, errors of ``quantities`` (keys)."""

    scene: str  # as a state's text
    frame_count: int
    particles: int
    quantities: tuple[str, ...]
    difference: bool = False  # whether estimate minus truth is recorded for each particle
    domains: bool = False  # whether particles' domains are recorded, if the stage can outline them
    language: str = ENGLISH  # of its texts


def record_scenes(wanted: Sequence[RecordingRequest], processes: int,
                  on_progress: Callable[[int], None]) -> list[dict[str, Any]]:
    """Returns the recording (:func:`record_scene`) of each request, made in so many parallel ``processes``;
    ``on_progress`` receives the number done. Raises :class:`~solvers.workers.worker_process.ProcessDied`."""
    with closing(WorkerPool(f"{__name__}:record_in_worker", processes)) as pool:
        # One of each kind of run first, so that processes compile different kernels.
        asked = {one: pool.submit(asdict(one), kind=_request_kernel_key(one))
                 for one in one_of_each_first(wanted, _request_kernel_key)}
        for done, recording in enumerate(as_completed(asked.values()), 1):
            recording.result()
            on_progress(done)
        return [asked[one].result() for one in wanted]


def _request_kernel_key(wanted: RecordingRequest) -> tuple:
    """Returns the key of the kernels that a request's run needs: equal keys share compiled kernels."""
    return kernel_key(shareable_state.parse_state(wanted.scene).scene)


def record_in_worker(question: Mapping[str, Any], answer: Callable[[dict], None]) -> None:
    """Records one run in a worker process: ``question`` has the fields of a request, ``answer`` sends the recording."""
    values = dict(question)
    values["quantities"] = tuple(values["quantities"])
    answer(record_scene(RecordingRequest(**values)))


def record_scene(wanted: RecordingRequest) -> dict[str, Any]:
    """Runs a request's scene; returns the recording as a JSON object: ``head`` describes the run, ``texts`` are in the
    request's language, ``tracks`` is the layout of ``data``, the packed arrays in base64."""
    with use_language(wanted.language):
        return _run_and_record(wanted)


def _run_and_record(wanted: RecordingRequest) -> dict[str, Any]:
    scene = shareable_state.parse_state(wanted.scene).scene
    solver = build(scene)
    solver.compile()
    rows, own, shots = [solver.measure()], list[np.ndarray](), list[dict[str, Snapshot]]()
    for step in np.unique(np.rint(np.linspace(0, scene.steps, wanted.frame_count)).astype(int)):
        while solver.step < step and solver.sound:
            rows.append(solver.advance(min(int(step) - solver.step, solver.longest_advance)))
        own.append(solver.measure())  # the picture's norms; also checks the run
        shot = solver.snapshot(wanted.difference)
        shots.append({key: replace(shot, plotted=solver.plotted(key)) for key in wanted.quantities}
                     if scene.DIMENSIONS == 1 else dict.fromkeys(wanted.quantities, shot))
        if not solver.sound:
            break
    kept = select_particles(scene.DIMENSIONS, _particle_count(shots), wanted.particles)
    marked = kept[::marking_stride(len(kept), VIEWS[scene.problem].stage.MOST_MARKED)]
    tracks = _particle_tracks(wanted, scene, kept, marked, shots)
    factor = gershgorin_to_linear_factor(scene)
    regular, pictures = (samples.read_rows(np.concatenate(some), scene, _particle_count(shots), factor)
                         for some in (rows, own))
    tracks += _norm_tracks(scene, regular, pictures)
    if scene.has("budget"):  # by field: the error, RMS over particles, and each cause's contribution
        tracks += [Track(f"budget.{field}", SIGNED, np.stack([pictures[f"budget/error_{field}"], *(
            pictures[f"budget/part_{field}_{cause}"] for cause in CAUSES)], axis=1)) for field in FIELDS]
    not_valid = solver.not_valid()
    silent = {key: [name for name in scene.active_estimators if not any(
        np.isfinite(shot[key].estimate[name][:, samples.QUANTITIES.index(key)]).any() for shot in shots)]
        for key in wanted.quantities}
    head = _recording_metadata(wanted, scene, solver, not_valid, len(kept), shots, regular, pictures)
    return {"head": {**head, **stage_notes(scene, round(_particle_count(shots) / len(marked)))},
            "texts": missing_value_texts(scene, not_valid, silent, wanted.difference),
            "tracks": [track.header for track in tracks], "data": base64.b64encode(pack_tracks(tracks)).decode()}


def _first_snapshot(shot: Mapping[str, Snapshot]) -> Snapshot:
    """Returns one of an instant's snapshots, which are by quantity and differ only in the plotted field."""
    return next(iter(shot.values()))


def _particle_count(shots: list[dict[str, Snapshot]]) -> int:
    return len(_first_snapshot(shots[0]).position)


def select_particles(dimensions: int, count: int, most: int) -> np.ndarray:
    """Returns indices of at most ``most`` of ``count`` particles: every k-th on the bar, random ones in the plane."""
    if dimensions == 1:
        return np.arange(0, count, -(-count // most))
    return np.arange(count) if count <= most else np.sort(np.random.default_rng(0).choice(count, most, replace=False))


def _particle_tracks(wanted: RecordingRequest, scene: Scene, kept: np.ndarray, marked: np.ndarray,
                     shots: list[dict[str, Snapshot]]) -> list[Track]:
    """Returns the tracks of particles: positions, errors, estimates, exact curves and lines, crossings. ``kept`` are
    indices of the particles recorded, ``marked`` of those with crossings, ``shots`` snapshots by time and quantity."""
    instants, stage = [_first_snapshot(shot) for shot in shots], VIEWS[scene.problem].stage
    along, plot = stage.plot_axis_positions(scene, instants[0].material_position[kept]), stage.PLOT
    share = (along - plot.start) / (plot.end - plot.start)
    position = np.stack([_flatten_by_component(shot.position[kept]) for shot in instants])
    farthest = FARTHEST if scene.swings else np.inf  # the player follows steady motion
    with np.errstate(invalid="ignore"):
        position = np.fmax(np.fmin(position, farthest), -farthest)
    tracks = [Track("along", NUMBER, share[None]), Track("position", PLACE, position)]
    if wanted.domains and issubclass(stage, PlanarStage):
        half = [stage.half_edge_vectors(scene, shot.deformation_gradient)[kept] for shot in instants]  # (n, 2 edges, 2)
        tracks.append(Track("edges", SIGNED, np.stack([one.transpose(1, 2, 0).ravel() for one in half])))
    for key in wanted.quantities:
        tracks += _quantity_tracks(wanted, scene, key, [shot[key] for shot in shots], kept)
    if scene.solution_known and stage.LINES:
        lines = [_flatten_by_component(stage.exact_material_lines(scene, shot.time, 1)[0, ::2]) for shot in instants]
        tracks.append(Track("line", PLACE, np.stack(lines)))
    return tracks + _crossing_tracks(scene, instants, kept, marked)


def _flatten_by_component(points: np.ndarray) -> np.ndarray:
    """Returns points (n,) or (n, D) as one row (n D,): x of all, then y of all."""
    return points.T.ravel()


def _quantity_tracks(wanted: RecordingRequest, scene: Scene, key: str, shots: list[Snapshot],
                     kept: np.ndarray) -> list[Track]:
    """Returns the tracks of the quantity ``key`` in its SI unit: sizes of true errors and estimates; on the bar signed
    deviations instead, from which these sizes follow, and the exact field on a curve."""
    column = samples.QUANTITIES.index(key)
    tracks = _field_tracks(scene, key, shots, kept) if scene.DIMENSIONS == 1 else []
    errors = [shot.error[kept, column] for shot in shots if shot.error is not None]
    if scene.DIMENSIONS > 1 and len(errors) == len(shots):
        tracks.append(Track(f"error.{key}", SIZE, np.abs(np.stack(errors))))
    for name in scene.active_estimators:
        tracks.append(Track(f"estimate.{name}.{key}", SIZE,
                            np.abs(np.stack([shot.estimate[name][kept, column] for shot in shots]))))
        if wanted.difference and all(name in shot.difference for shot in shots):
            tracks.append(Track(f"difference.{name}.{key}", SIZE,
                                np.stack([shot.difference[name][kept, column] for shot in shots])))
    return tracks


def _field_tracks(scene: Scene, key: str, shots: list[Snapshot], kept: np.ndarray) -> list[Track]:
    """Returns the tracks of the bar's field plot of the quantity ``key`` in its SI unit: the field's signed deviation
    from the exact one, how many values are unknown, and the exact field on a curve."""
    fields = np.stack([shot.plotted[kept, 1] for shot in shots if shot.plotted is not None])
    tracks = [Track(f"deviation.{key}", SIGNED, fields)]
    unknown = [[np.count_nonzero(~np.isfinite(shot.plotted[:, 0]))] for shot in shots if shot.plotted is not None]
    if np.any(unknown) and not why_no_field(scene, key):
        tracks.append(Track(f"unknown.{key}", NUMBER, np.array(unknown)))
    plot = VIEWS[scene.problem].stage.PLOT
    at = np.linspace(plot.start, plot.end, CURVE_POINTS)
    return [*tracks, Track(f"curve.{key}", PLACE, np.stack([plot.exact(scene, key, at, shot.time) for shot in shots]))]


def _crossing_tracks(scene: Scene, shots: list[Snapshot], kept: np.ndarray, marked: np.ndarray) -> list[Track]:
    """Returns two tracks (events, 1) of cell crossings by time: the particle's index in ``kept``, and the time in s. Of
    each ``marked`` particle (index) the last crossing between two instants counts."""
    numbers = np.searchsorted(kept, marked)
    found = []
    for before, shot in itertools.pairwise(shots):
        if shot.last_crossing is not None:
            steps = shot.last_crossing[marked]
            crossed = steps > before.step
            found.append(np.stack([numbers[crossed], steps[crossed] * scene.time_step], axis=1))
    events = np.concatenate(found) if found else np.empty((0, 2))
    events = events[np.argsort(events[:, 1], kind="stable")]
    return [Track("crossings.who", PLACE, events[:, :1]), Track("crossings.time", PLACE, events[:, 1:])]


def _norm_tracks(scene: Scene, regular: Mapping[str, np.ndarray], pictures: Mapping[str, np.ndarray]) -> list[Track]:
    """Returns tracks with a row per picture: time (s), crossings, margin, norms of true and estimated errors (x, v,
    sigma, a), and each estimator's index and distance over the run so far.

    ``regular`` has the columns of the run's samples, ``pictures`` of one sample per picture."""
    times = pictures["time"]
    ends = np.searchsorted(regular["time"], times + 0.5 * scene.time_step)  # numbers of samples so far
    alone = np.abs(regular["time"][ends - 1] - times) > 0.5 * scene.time_step  # no sample at the picture's time
    tracks = [Track("time", NUMBER, times.reshape(-1, 1)),
              Track("crossed", NUMBER, pictures["crossings"].reshape(-1, 1)),
              Track("margin", NUMBER, pictures["margin"].reshape(-1, 1)),
              Track("norm.true", NUMBER, _stack_quantity_series(pictures, "error_{}"))]

    def so_far(accumulate: np.ufunc, start: float, name: str, of: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
        """Returns (pictures,) the sum or maximum up to each picture of ``of(values)`` of the series ``name``."""
        together = np.append(start, accumulate.accumulate(of(regular[name])))[ends]
        return accumulate(together, np.where(alone, of(pictures[name]), start))

    def ratios(norm: str, key: str) -> np.ndarray:
        """Returns (pictures,) the sum of the series ``norm`` over that of a quantity's true error; NaN for rounding."""
        true = f"error_{key}"
        total, true_total = (so_far(np.add, 0.0, name, np.asarray) for name in (norm, true))
        worst = so_far(np.maximum, -np.inf, true, lambda values: np.where(np.isnan(values), np.inf, values))
        known = so_far(np.maximum, 0.0, true, np.isfinite) > 0
        nothing = known & ~(worst > largest_rounding_error(scene, key, times / scene.time_step))
        return np.where((true_total > 0) & ~nothing, total / true_total, np.nan)

    with np.errstate(all="ignore"):  # a run gone bad holds anything
        for estimator in scene.active_estimators:
            tracks.append(Track(f"norm.{estimator}", NUMBER,
                                _stack_quantity_series(pictures, f"{estimator}/estimate_{{}}")))
            for ratio, norm in RATIOS.items():
                table = np.stack([ratios(f"{estimator}/{norm}_{key}", key) for key in samples.QUANTITIES], axis=1)
                tracks.append(Track(f"{ratio}.{estimator}", NUMBER, np.where(np.isfinite(table), table, np.nan)))
    return tracks


def _stack_quantity_series(series: Mapping[str, np.ndarray], name: str) -> np.ndarray:
    """Returns (T, 4) the series with this name for x, v, sigma, a; "{}" in the name stands for the quantity."""
    return np.stack([series[name.format(key)] for key in samples.QUANTITIES], axis=1)


def _recording_metadata(wanted: RecordingRequest, scene: Scene, solver: Solver, not_valid: dict[str, str], shown: int,
                        shots: list[dict[str, Snapshot]], *series: Mapping[str, np.ndarray]) -> dict[str, Any]:
    """Returns a JSON object that describes a run for the player: geometry, times, verdict, validity and error budget.

    ``not_valid`` maps estimators to reasons, ``shown`` is the number of particles kept; ``series`` are all samples."""
    found = [finding for one in series if (finding := earliest_finding(findings(scene, one), not_valid))]
    large: dict[str, LargeRelativeError] = {}
    for one in series:
        large = merge_large_errors(large, large_errors(scene, one, not_valid))
    status, reason, since = solver.status(min(found, key=lambda finding: finding.time, default=None), large)
    stage = VIEWS[scene.problem].stage
    return {"problem": scene.problem, "particles": _particle_count(shots), "shown": shown, "spacing": scene.spacing,
            "first_line": stage.cell_edge_position(scene), "step": scene.time_step, "steps": solver.step,
            "period": scene.period, "end": scene.end_time, "outermost": stage.max_radius(scene), "ppc": scene.ppc,
            "tile": stage.particle_shape(scene), "known": scene.solution_known, "moves_on": not scene.swings,
            "least": {key: [share * scene.size_of(key) for share in (LEAST_TOP, LEAST_REACH)]
                      for key in wanted.quantities if not scene.swings},
            "estimators": scene.active_estimators, "not_valid": not_valid, "quantities": wanted.quantities,
            "status": status, "reason": reason or "", "since": since, "budget": None if not scene.has("budget") else {
                "shares": {field: budget_shares.shares(series[0], field) for field in FIELDS},
                "causes": {cause: tr(label)
                           for cause, label in cause_labels(budget_shares.has_crossed(series[0])).items()},
                "whose": estimated_error_note(scene), "not_valid": budget_shares.why_not_valid(series[0])}}
