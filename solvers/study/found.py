"""A run that a search has made: as a row, as one would watch it, and as another search is told of it."""

import math
from dataclasses import replace

from solvers.scene.effects import EFFECTS
from solvers.scene.scene import Scene
from solvers.solver.norms import finite
from solvers.solver.soundness import OK
from solvers.study.family import ESTIMATOR, Family, Point
from solvers.study.grid import Task, task_of
from solvers.study.row import BLANK, SCHEMA


def point_row(family: Family, point: Point) -> dict:
    """A row (``solvers.study.row``) with what is known of the run: the estimate of one quantity, and the time of the
    bare run out of its steps, its particles and a rate that was measured alone. It has no true error: a search does
    without. Its task is :func:`to_watch`."""
    scene = family.member(point.cells)
    task, seconds = to_watch(scene), finite(family.seconds(point.cells))
    estimate = {ESTIMATOR: {family.quantity: {"max": point.error}}} if math.isfinite(point.error) else {}
    return {**BLANK, "schema": SCHEMA, "key": task.key, "problem": scene.problem, "asked": task.inputs,
            "scene": scene.to_dict(), "h": scene.spacing, "status": point.status,
            "reason": None if point.status == OK else point.reason, "t": scene.end_time, "steps": scene.steps,
            "particles": scene.particles, "particle_steps": scene.steps * scene.particles, "error": {},
            "estimate": estimate, "effects": list(scene.effects),
            "seconds": {} if seconds is None else {"min": seconds}}


def to_watch(scene: Scene) -> Task:
    """The task of a scene with the estimator that a search goes by, and with every effect."""
    return task_of(replace(scene, estimators=(ESTIMATOR,), effects=tuple(EFFECTS)))


def told(point: Point) -> dict:
    """A point as JSON: ``error`` (None where it went bad), ``rate`` (seconds of a particle-step, None likewise),
    ``status`` and ``reason``."""
    return {"error": finite(point.error), "rate": finite(point.seconds_per_particle_step), "status": point.status,
            "reason": point.reason}


def point_of(cells: int, known: dict) -> Point:
    """The point that was told of; without a ``rate`` it is yet to be timed."""
    rate = known.get("rate", math.nan)
    return Point(cells, math.inf if known["error"] is None else known["error"], math.inf if rate is None else rate,
                 known["status"], known["reason"])
