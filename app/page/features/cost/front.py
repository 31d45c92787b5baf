"""Which runs can be compared, which of them none beats, and which is the cheapest that is accurate enough."""

import functools
from collections.abc import Sequence
from dataclasses import replace

from app.page.features.cost.runs import NumberedRun
from solvers.scene.scene import Scene
from solvers.study.fit import pareto
from solvers.study.grid import task_of

CHOSEN = {"method", "linearity_preserving", "cells", "ppc", "cfl"}  # by a search, of what a run can be


def bare(scene: Scene) -> Scene:
    """The scene without what a search brings with it."""
    return replace(scene, velocity="grid", estimators=(), effects=(), dt=None, sample_every=None)


@functools.lru_cache(maxsize=1000)  # asked again and again, of each run
def question(scene: Scene) -> dict:
    """What an advice depends on, of the scene that it is asked for."""
    return {"problem": scene.problem} | {name: value for name, value in task_of(bare(scene)).inputs.items()
                                         if name not in CHOSEN}


def comparable(runs: Sequence[NumberedRun], scene: Scene) -> list[NumberedRun]:
    """Those that compute what the scene computes, by whatever method and remedies: the others' errors and times are
    answers to another question."""
    asked = question(replace(scene, remedies=()))
    return [run for run in runs if run.row["problem"] == scene.problem
            and question(replace(run.scene, remedies=())) == asked]


def staged(runs: Sequence[NumberedRun], scene: Scene) -> NumberedRun | None:
    """The one that computes the very scene, whatever else is asked of it: where it was timed alone, if so."""
    own = [run for run in runs if run.drawable and _computed(run.scene) == _computed(scene)]
    return next((run for run in own if run.alone), own[0] if own else None)


@functools.lru_cache(maxsize=1000)
def _computed(scene: Scene) -> tuple[Scene, float]:
    return replace(scene, estimators=(), effects=(), dt=None, cfl=None, sample_every=None), scene.time_step


def measured(runs: Sequence[NumberedRun]) -> list[NumberedRun]:
    """Those that have an error or an estimate, and a time that was taken alone."""
    return [run for run in runs if run.alone and run.drawable and not run.broken]


def front(runs: Sequence[NumberedRun]) -> list[NumberedRun]:
    """Those that none beats in both error and time, by time."""
    known = measured(runs)
    return [known[k] for k in pareto([run.seconds for run in known], [run.size for run in known])]


def cheapest(runs: Sequence[NumberedRun], tolerance: float) -> NumberedRun | None:
    """The cheapest with an error of ``tolerance`` times A at most."""
    return next((run for run in front(runs) if run.size <= tolerance), None)
