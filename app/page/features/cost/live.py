"""A row out of a live run, once it has come to the end of its scene."""

import numpy as np

from app import __version__
from app.page.visit.history import History
from solvers.engine.messages import FrameReport
from solvers.solver.norms import RATIOS, summary
from solvers.solver.samples import QUANTITIES
from solvers.solver.soundness import LOST, OK, UNSTABLE
from solvers.study.grid import task_of
from solvers.study.row import BLANK, SCHEMA


class LiveRows:
    """Watches the frames of one session. The stage runs on for ever; a row covers the scene's own length."""

    def __init__(self) -> None:
        self._done = False

    def follow(self, report: FrameReport, history: History) -> dict | None:
        """The run's row when this frame ends it or it has stopped, once; else None. A lost run goes to its end."""
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


def live_row(report: FrameReport, history: History) -> dict:
    """A row like those of ``solvers.study.row``, with the errors up to the end of the scene.

    Its seconds are those that the engine takes for the whole scene, with everything that it computes; the bare
    method's are not known.
    """
    scene, series = report.scene, history.series
    status = _status(report)
    steps = report.step if status == UNSTABLE else scene.steps
    within = series["time"] <= (steps + 0.5) * scene.time_step
    valid = [name for name in scene.active_estimators if name not in report.not_valid]
    seconds = 1e-6 * steps * report.particles / report.rate if report.rate > 0 else None
    task = task_of(scene, version=__version__)
    return {
        **BLANK, "schema": SCHEMA, "key": task.key, "problem": scene.problem, "asked": task.inputs,
        "scene": scene.to_dict(), "h": scene.spacing, "status": status,
        "reason": None if status == OK else report.reason, "t": steps * scene.time_step, "steps": steps,
        "particles": report.particles, "particle_steps": steps * report.particles,
        "error": {q: summary(series[f"error_{q}"][within]) for q in QUANTITIES},
        "estimate": {name: {q: summary(series[f"{name}/estimate_{q}"][within]) for q in QUANTITIES} for name in valid},
        **{ratio: {name: {q: _last(series[f"{name}/{ratio}_{q}"][within]) for q in QUANTITIES} for name in valid}
           for ratio in RATIOS},
        "not_valid": dict(report.not_valid), "effects": list(scene.effects),
        "seconds": {"full": seconds}, "rate": report.rate or None, "arch": report.arch, "version": __version__}


def _status(report: FrameReport) -> str:
    """What the run was found to be up to the end of its scene."""
    end = report.scene.end_time
    if report.since is None or report.since > end:
        return OK
    return LOST if report.status == UNSTABLE and report.time > end else report.status


def _last(values: np.ndarray) -> float | None:
    return float(values[-1]) if len(values) and np.isfinite(values[-1]) else None
