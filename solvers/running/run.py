"""Function run(scene) -> Result, the only way to run a scene without a page."""

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from solvers.problems import PROBLEMS
from solvers.running.cures import candidate_cures
from solvers.running.quantities_of_interest import evaluate_goal, mask_refused, parse_goals
from solvers.running.repeated_step_timing import estimator_shares
from solvers.running.result import Result
from solvers.scene.kernel_options import kernel_key
from solvers.scene.scene import Scene
from solvers.scene.step_bound import gershgorin_to_linear_factor
from solvers.scene.validation import SceneError, require_choice
from solvers.solver import samples
from solvers.solver.base import Solver
from solvers.solver.particle_snapshot import Snapshot, WallTimes
from solvers.solver.soundness import earliest_finding, findings
from solvers.solver.verdict_basis import large_errors

SMALL_MOTION = 0.5  # of the amplitude: a picture of less shows little
SLICE_SECONDS = 0.1  # a kernel launch cannot be interrupted: keep it short enough for progress and Ctrl-C
MOST_IDLE_SOLVERS, MOST_IDLE_BYTES = 4, 16 * 2**20  # that are kept for later runs, and of each

_idle_solvers: dict[tuple, Solver] | None = None  # of finished runs, by kernel key, the oldest first; None: not kept


def build(scene: Scene) -> Solver:
    """Returns a new solver for a scene, with its particles in place and no step taken. Raises :class:`SceneError` where
    the scene names a GPU that does not exist."""
    return PROBLEMS[scene.problem].solver(scene)


def reuse_solvers() -> None:
    """Lets later runs of this process restart solvers of earlier ones, which saves most of the time before the first
    step: for worker processes, which run many similar scenes. Results are the same, to the bit."""
    global _idle_solvers
    if _idle_solvers is None:
        _idle_solvers = {}


def _take_solver(scene: Scene) -> Solver:
    """Returns a solver for a scene, no step taken: an idle one restarted, or a new one."""
    solver = _idle_solvers.pop(kernel_key(scene), None) if _idle_solvers else None
    return solver if solver is not None and solver.restart(scene) else build(scene)


def _give_back_solver(solver: Solver) -> None:
    """Keeps the solver of a finished run for the next one with the same kernels, if it is small and not on a GPU."""
    if _idle_solvers is not None and solver.plan != "gpu" and solver.bytes <= MOST_IDLE_BYTES:
        _idle_solvers[kernel_key(solver.scene)] = solver
        if len(_idle_solvers) > MOST_IDLE_SOLVERS:
            del _idle_solvers[next(iter(_idle_solvers))]


def as_scene(given: Scene | type[Scene] | str) -> Scene:
    """Returns a scene as it is, and for a scene class or a problem's name the scene with all defaults. Raises
    :class:`SceneError` for anything else."""
    if isinstance(given, str):
        require_choice("problem", given, tuple(PROBLEMS))
        return PROBLEMS[given].scene()
    if isinstance(given, type) and issubclass(given, Scene):
        return given()
    if not isinstance(given, Scene):
        raise SceneError("scene", given, f"is none; give a scene, as in run(BarScene(cells=40)), or the name of a "
                                         f"problem: {', '.join(PROBLEMS)}")
    return given


def run(scene: Scene | type[Scene] | str, on_progress: Callable[[float], None] | None = None, prices: bool = False,
        mid_run: bool = True, on_sample: Callable[[Snapshot], None] | None = None, goals: Sequence[str] = ()) -> Result:
    """Runs a scene to its end, or until it becomes unstable, which is a result and never an exception.

    ``scene`` is one such as ``BarScene(cells=40)``; or a scene class or a problem's name, for the defaults. With
    ``prices`` the estimators' shares of the time (``Result.seconds.estimators``) are measured half way, which takes a
    few tenths of a second; with ``mid_run`` particles are also stored at :func:`picture_step`, where a picture of the
    end would show nothing. ``goals`` are quantities of interest at the end, with their estimated errors
    (``Result.goals``): "kinetic-energy", "mean-stress", "displacement@0.25", in the plane "displacement@0.5,0".

    ``on_progress`` is called several times a second with the part done, 0 to 1; ``on_sample`` with the particles
    whenever their norms are sampled, from start to end, and each call interrupts the run.

    The result has errors, estimates, status and times; its ``to_dict()`` is the object of ``mpm-lab run --json``. What
    may help a broken run is named untried (:func:`solvers.running.cure_trials.try_cures` tries it).
    Raises :class:`SceneError` for anything but a scene, for a GPU that does not exist, and for an invalid goal.
    """
    scene = as_scene(scene)
    wanted = parse_goals(scene, goals)
    solver = _take_solver(scene)
    begun = time.perf_counter()
    solver.compile()
    compiled = time.perf_counter() - begun
    rows = [solver.measure()]
    if on_sample:
        on_sample(solver.snapshot())
    shares: dict[str, float] = {}
    ran, slice_steps = 0.0, 64
    shown_at = picture_step(scene) if mid_run else scene.steps
    kept: Snapshot | None = None
    while solver.step < scene.steps and solver.sound:
        stop = shown_at if solver.step < shown_at else scene.steps
        steps = min(slice_steps, stop - solver.step, solver.longest_advance)
        if on_sample:
            steps = min(steps, scene.sample_interval - solver.step % scene.sample_interval)
        begun = time.perf_counter()
        rows.append(solver.advance(steps))
        took = time.perf_counter() - begun
        ran += took
        if on_sample and solver.sound and (solver.step % scene.sample_interval == 0 or solver.step == scene.steps):
            on_sample(solver.snapshot())
        if solver.step == shown_at < scene.steps and solver.sound:
            kept = solver.snapshot()
        slice_steps = max(1, int(min(2.0, SLICE_SECONDS / took) * steps)) if took > 0 else 2 * slice_steps
        if prices and 2 * solver.step >= scene.steps:
            shares, prices = estimator_shares(solver), False
        if on_progress:
            on_progress(solver.step / scene.steps)
    last = solver.measure()  # also the last check for an unstable run: the kernel's own may be steps ago
    if solver.step % scene.sample_interval:
        rows.append(last)
    else:
        rows[-1][-1:, samples.LOOKS] = last[:, samples.LOOKS]  # that sample may have been one without these columns
    final = solver.snapshot()
    series = samples.read_rows(np.concatenate(rows), scene, len(final.position), gershgorin_to_linear_factor(scene))
    not_valid = solver.not_valid()
    finding = earliest_finding(findings(scene, series), not_valid)
    if finding and finding.particle is None and final.error is not None:
        finding = replace(finding, particle=int(np.argmax(np.nan_to_num(final.error[:, 0]))))
    status, explanation, broken_at = solver.status(finding, large_errors(scene, series, not_valid))
    seconds = WallTimes(solver.setup_seconds, compiled, ran, {name: part * ran for name, part in shares.items()})
    fields = solver.fields() if wanted else None
    reached = {goal.name: evaluate_goal(goal, fields, scene, solver.step) for goal in wanted} if fields else {}
    rule = finding.rule if finding and solver.sound else ""
    cures = () if broken_at is None else candidate_cures(scene, rule, broken_at)
    result = Result(scene=scene, status=status, explanation=explanation, broken_at=broken_at, time=solver.time,
                    steps=solver.step, series=series, final=final, mid_run=kept if solver.sound else None,
                    bytes=solver.bytes, not_valid=not_valid, seconds=seconds, arch=solver.arch,
                    threads=solver.threads, plan=solver.plan, goals=mask_refused(reached, not_valid), advice=cures)
    _give_back_solver(solver)
    return result


def picture_step(scene: Scene) -> int:
    """Returns the step at which a picture shows most: the last, unless the exact motion, A sin(w t), is small there, as
    after whole periods; then the step of its last extreme."""
    turns = scene.end_time / (0.5 * scene.period)
    largest = math.floor(turns - 0.5) + 0.5  # in half periods
    if not scene.swings or abs(math.sin(math.pi * turns)) >= SMALL_MOTION or largest < 0:
        return scene.steps
    return min(scene.steps, max(1, round(largest * 0.5 * scene.period / scene.time_step)))
