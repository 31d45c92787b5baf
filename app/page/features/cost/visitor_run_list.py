"""A visitor's numbered runs, a row each: shipped ones, and those of sweeps, searches and the stage; their Pareto front,
and the cheapest and the most accurate of them."""

import functools
import math
import threading
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from app import __version__
from app.page.visit.history import NormHistory
from solvers.engine.engine_messages import FrameReport
from solvers.scene.scene import Scene
from solvers.solver.error_series import RATIOS, summary
from solvers.solver.samples import QUANTITIES
from solvers.solver.soundness import BROKEN, LOST, OK, UNSTABLE
from solvers.study import csv_and_markdown_summary as table
from solvers.study.convergence_analysis import corrected_rows, pareto
from solvers.study.parameter_grid import Task, task_of
from solvers.study.row import FAILED, unmeasured_row

MOST_RUNS = 300  # beyond, the oldest is dropped
LIVE, SHIPPED, SEARCH, SWEEP = "live", "shipped", "search", "sweep"
HERE = (SEARCH, SWEEP)  # sources whose times were measured on this machine, and alone
CHOSEN = {"method", "linearity_preserving", "cells", "ppc", "cfl"}  # fields that a search chooses
ENDS = {"periods", "t_end"}  # fields that give the end of a run, which is the same however it is given
KNOWN = {LIVE: 0, SHIPPED: 1, SEARCH: 2, SWEEP: 3}  # ranks of sources: a run keeps the row of the highest
SAME_TIME = 1.08  # longer than a run's time by up to this factor counts as the same time


@dataclass(frozen=True)
class NumberedRun:
    """Row of a run (a dict as in ``solvers.study.row``), its number from 1, its source, and the ``quantity`` ("x") of
    whose errors it tells; derived values are cached."""

    number: int
    source: str
    row: dict
    quantity: str = "x"

    @property
    def corrected_by(self) -> str:
        """Estimator whose estimate is subtracted from the result, "" for none."""
        return self.row.get("corrected_by", "")

    @property
    def mark(self) -> str:
        """Text that tells the dots of a chart apart; begins with the number of the run to load."""
        return f"{self.number} {self.corrected_by}".strip()

    @functools.cached_property
    def scene(self) -> Scene:
        return Task(self.row["problem"], self.row["asked"]).scene()

    @functools.cached_property
    def error(self) -> float | None:
        """The largest RMS error of the quantity over time, divided by the scene's size of it; None if unknown."""
        return self._relative(self.row.get("error") or {})

    @functools.cached_property
    def estimate(self) -> float | None:
        """The :attr:`error` as estimated by :attr:`estimator`; None if unknown."""
        return self._relative((self.row.get("estimate") or {}).get(self.estimator) or {})

    @property
    def estimator(self) -> str:
        """The name of the first valid estimator, or ""."""
        return next(iter(self.row.get("estimate") or {}), "")

    @property
    def error_or_estimate(self) -> float:
        """The relative error, or its estimate if no error is known, for the chart; NaN if neither is."""
        size = self.estimate if self.error is None else self.error
        return math.nan if size is None else size

    @property
    def seconds(self) -> float:
        """Seconds of the run timed alone, or of everything on the stage; NaN if unknown."""
        seconds = self.row.get("seconds") or {}
        return seconds.get("min") or seconds.get("full") or math.nan

    @property
    def timed_alone(self) -> bool:
        """Whether the run was timed by itself, here or by the authors, not on a stage with drawing and estimates."""
        return self.source != LIVE

    @property
    def method(self) -> str:
        return self.row["scene"]["method"]

    @property
    def outcome(self) -> str:
        return self.row["status"]

    @property
    def broken(self) -> bool:
        """Whether the run went unstable or was lost, so that its error is meaningless."""
        return self.outcome in BROKEN

    @property
    def drawable(self) -> bool:
        """Whether the run has a dot on the chart; a broken one has it at the edge."""
        return 0 < self.seconds < math.inf and (self.broken or (self.outcome == OK and self.error_or_estimate > 0))

    def _relative(self, norms: dict) -> float | None:
        largest = (norms.get(self.quantity) or {}).get("max")
        return None if largest is None or not math.isfinite(largest) else largest / self.scene.size_of(self.quantity)


class VisitorRunList:
    """Numbered runs of one visitor, at ``most`` so many. Thread-safe; ``version`` grows with every change, and
    ``quantity`` is the one whose errors count."""

    def __init__(self, most: int = MOST_RUNS):
        self._lock, self._most = threading.Lock(), most
        self._runs: dict[tuple, NumberedRun] = {}
        self._numbers = self.version = 0
        self.quantity = "x"

    def count_errors_of(self, quantity: str) -> None:
        """Lets the errors of another quantity ("sigma") count."""
        with self._lock:
            if quantity != self.quantity:
                self.quantity = quantity
                self._runs = {key: replace(run, quantity=quantity) for key, run in self._runs.items()}
                self.version += 1

    def add(self, row: dict, source: str) -> None:
        """Adds a row; a known run's stays, whatever was computed beside it, unless the new one ranks as high
        (``KNOWN``) and has not failed."""
        key = run_key(Task(row["problem"], row["asked"]).scene())
        with self._lock:
            before = self._runs.get(key)
            if before and (KNOWN[before.source] > KNOWN[source] or row["status"] == FAILED):
                return
            if before is None:
                self._numbers += 1
                if len(self._runs) >= self._most:
                    del self._runs[next(iter(self._runs))]
            self._runs[key] = NumberedRun(before.number if before else self._numbers, source, row, self.quantity)
            self.version += 1

    def all(self) -> list[NumberedRun]:
        """Returns all runs, in the order of their numbers."""
        with self._lock:
            return sorted(self._runs.values(), key=lambda run: run.number)

    def with_corrected(self) -> list[NumberedRun]:
        """Returns all runs, and after them their results minus the estimates of estimators timed with them."""
        runs = self.all()
        return [*runs, *(replace(run, row=row) for run in runs for row in corrected_rows([run.row]))]

    def find(self, number: int) -> NumberedRun | None:
        return next((run for run in self.all() if run.number == number), None)


def csv_bytes(runs: Sequence[NumberedRun]) -> bytes:
    """Returns the runs as a CSV file: the columns of ``mpm-lab sweep`` after number and source."""
    return table.csv_text({"run": run.number, "source": run.source, **run.row} for run in runs).encode()


class LiveRunRecorder:
    """Creates rows from the frames of one visitor's stage; a row ends with the scene, though the stage runs on."""

    def __init__(self) -> None:
        self._done = False

    def take_row(self, report: FrameReport, history: NormHistory) -> dict | None:
        """Returns the run's row once, when this frame completes it or it has stopped; None otherwise."""
        if report.fresh:
            self._done = False
        if self._done:
            return None
        scene = report.scene
        ended = report.time >= scene.end_time - 0.5 * scene.time_step
        if not (ended or report.status == UNSTABLE) or history.scene != scene or not report.step:
            return None
        self._done = True
        return live_row(report, history)


def live_row(report: FrameReport, history: NormHistory) -> dict:
    """Returns a row (``solvers.study.row``) of a run on the stage, to its scene's end, with seconds of everything."""
    scene, series = report.scene, history.series
    status = report.status
    if report.since is None or report.since > scene.end_time:
        status = OK
    elif status == UNSTABLE and report.time > scene.end_time:  # at the end of the scene it was lost only
        status = LOST
    steps = report.step if status == UNSTABLE else scene.steps
    within = series["time"] <= (steps + 0.5) * scene.time_step
    valid = [name for name in scene.active_estimators if name not in report.not_valid]
    seconds = 1e-6 * steps * report.particles / report.rate if report.rate > 0 else None
    task = task_of(scene, version=__version__)
    return {
        **unmeasured_row(task, scene), "status": status,
        "reason": None if status == OK != report.status else report.reason, "t": steps * scene.time_step,
        "steps": steps, "particles": report.particles, "particle_steps": steps * report.particles,
        "error": {q: summary(series[f"error_{q}"][within]) for q in QUANTITIES},
        "estimate": {name: {q: summary(series[f"{name}/estimate_{q}"][within]) for q in QUANTITIES} for name in valid},
        **{ratio: {name: {q: _last(series[f"{name}/{ratio}_{q}"][within]) for q in QUANTITIES} for name in valid}
           for ratio in RATIOS},
        "not_valid": dict(report.not_valid), "effects": list(scene.effects),
        "seconds": {"full": seconds}, "rate": report.rate or None, "arch": report.arch, "version": __version__}


def _last(values: np.ndarray) -> float | None:
    return float(values[-1]) if len(values) and np.isfinite(values[-1]) else None


def without_search_options(scene: Scene) -> Scene:
    """Returns the scene without the options that a search sets itself: velocity, estimators, effects, steps."""
    return replace(scene, velocity="grid", estimators=(), effects=(), dt=None, sample_every=None)


@functools.lru_cache(maxsize=1000)  # called often, for each run
def advice_key(scene: Scene) -> dict:
    """Returns the problem and fields of a scene that a search's advice depends on, by name."""
    inputs = task_of(without_search_options(scene)).inputs
    fixed = {name: value for name, value in inputs.items() if name not in CHOSEN | ENDS}
    return {"problem": scene.problem, "end": scene.end_time} | fixed


def comparable_runs(runs: Sequence[NumberedRun], scene: Scene) -> list[NumberedRun]:
    """Returns the runs of the same motion as the scene's, by any method and remedies."""
    asked = advice_key(replace(scene, remedies=()))
    return [run for run in runs if run.row["problem"] == scene.problem
            and advice_key(replace(run.scene, remedies=())) == asked]


def runs_in_chart(runs: Sequence[NumberedRun], scene: Scene) -> list[NumberedRun]:
    """Returns the runs of the scene's problem; of the shipped ones those of its motion, or, before any of it was timed,
    those of one other motion as an example."""
    of_problem = [run for run in runs if run.row["problem"] == scene.problem]
    shipped = [run for run in of_problem if run.source == SHIPPED]
    if shipped and not measured_runs(comparable_runs(of_problem, scene)):
        scene = shipped[0].scene
    numbers = {run.number for run in comparable_runs(shipped, scene)}
    return [run for run in of_problem if run.source != SHIPPED or run.number in numbers]


def run_of_scene(runs: Sequence[NumberedRun], scene: Scene) -> NumberedRun | None:
    """Returns the run that computes exactly this scene; None if there is none."""
    return next((run for run in runs if run.drawable and run_key(run.scene) == run_key(scene)), None)


@functools.lru_cache(maxsize=1000)
def run_key(scene: Scene) -> tuple[Scene, float, float]:
    """Returns what runs have in common that compute the same, whatever is estimated beside and however step and end are
    given."""
    bare = replace(scene, estimators=(), effects=(), dt=None, cfl=None, sample_every=None, periods=None, t_end=None)
    return bare, scene.time_step, scene.end_time


def measured_runs(runs: Sequence[NumberedRun]) -> list[NumberedRun]:
    """Returns the runs that have an error or an estimate, and a time that was measured alone on one machine: here, or
    before any run was measured here on the authors'."""
    here = any(run.source in HERE for run in runs)
    return [run for run in runs if run.drawable and not run.broken
            and (run.source in HERE if here else run.source == SHIPPED)]


def pareto_front(runs: Sequence[NumberedRun]) -> list[NumberedRun]:
    """Returns the runs that no other beats in both error and time, from the fastest to the slowest."""
    known = measured_runs(runs)
    return [known[k] for k in pareto([run.seconds for run in known], [run.error_or_estimate for run in known])]


def cheapest_run(runs: Sequence[NumberedRun], tolerance: float) -> NumberedRun | None:
    """Returns the fastest run with a relative error of at most ``tolerance``; None if there is none."""
    return next((run for run in pareto_front(runs) if run.error_or_estimate <= tolerance), None)


def cheaper_run(runs: Sequence[NumberedRun], own: NumberedRun) -> NumberedRun | None:
    """Returns the fastest run that is as accurate as ``own``, if it is faster or the time of ``own`` was not measured
    with theirs; None if there is none."""
    best = cheapest_run(runs, own.error_or_estimate)
    return best if best and (own not in measured_runs(runs) or best.seconds < own.seconds) else None


def more_accurate_run(runs: Sequence[NumberedRun], own: NumberedRun) -> NumberedRun | None:
    """Returns the most accurate run that takes as long as ``own``, and up to 8 % more, if it is more accurate; None if
    there is none, or if the time of ``own`` was not measured with theirs."""
    known = measured_runs(runs)
    as_fast = [run for run in known if own in known and run.seconds <= SAME_TIME * own.seconds]
    best = min(as_fast, key=lambda run: run.error_or_estimate, default=own)
    return best if best.error_or_estimate < own.error_or_estimate else None


def sweep_curves(runs: Sequence[NumberedRun]) -> list[list[NumberedRun]]:
    """Groups shipped runs and those of sweeps that differ only in their number of cells; returns each group sorted by
    cells."""
    groups: dict[tuple, list[NumberedRun]] = {}
    for run in runs:
        if run.source in (SHIPPED, SWEEP) and run.drawable and not run.broken:
            groups.setdefault(_curve_key(run.scene, run.corrected_by), []).append(run)
    return [sorted(group, key=lambda run: run.scene.cells) for group in groups.values()]


@functools.lru_cache(maxsize=1000)
def _curve_key(scene: Scene, corrected_by: str) -> tuple:
    """Returns what the runs of a curve have in common: all but their cells."""
    bare, _, end = run_key(scene)
    given = task_of(bare).inputs | {"cells": 0}
    return tuple(map(str, given.items())), end, corrected_by, scene.courant_number if scene.dt is None else scene.dt
