"""Measured runs that the Cost tab opens with, in ``shipped_runs.json``; this command measures them anew::

    uv run python -m app.page.features.cost.shipped_runs
"""

import functools
import json
import math
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from app import shareable_state
from app.page.features.cost.jobs import sweep_tasks
from app.page.visit.first_scene import first_scene
from solvers.scene.scene import Scene
from solvers.solver.samples import QUANTITIES
from solvers.solver.soundness import OK
from solvers.study.parameter_grid import task_of
from solvers.study.row import unmeasured_row

FILE = Path(__file__).with_suffix(".json")
#: Scenes of the page whose stage has a chart at once, as texts of :mod:`app.shareable_state`, beside the first ones of
#: the problems.
SCENES = ("bar;method=mpm;amplitude=0.0034;periods=0.25;estimators=recovered",)
BUILT_IN = ("bar", "square", "ring", "vortex")
TIMES = 12  # that each run is timed; the shortest counts


def read_file() -> dict[str, list[dict[str, Any]]]:
    """Returns the shipped runs by the text of the scene that they vary."""
    return json.loads(FILE.read_text(encoding="utf-8"))


@functools.cache
def shipped_rows(problem: str) -> tuple[dict, ...]:
    """Returns the rows (``solvers.study.row``) of a problem's shipped runs, without what the page does not show."""
    return tuple(_row(shareable_state.parse_state(text).scene, run)
                 for text, runs in read_file().items() for run in runs
                 if text.split(";")[0] == problem)


def _row(scene: Scene, run: dict) -> dict:
    """Returns the row of one shipped ``run`` (an object of the file) of a scene with its method and cells."""
    scene = replace(scene, method=run["method"], cells=run["cells"])
    norms = [{q: {"max": value} for q, value in run[name].items()} for name in ("error", "estimate")]
    return {**unmeasured_row(task_of(scene), scene), "status": run["status"], "reason": run.get("reason"),
            "t": scene.end_time, "steps": scene.steps, "particles": scene.particles, "error": norms[0],
            "estimate": {scene.first_estimator: norms[1]} if norms[1] else {}, "seconds": {"min": run["seconds"]}}


def scenes_to_ship() -> dict[str, Scene]:
    """Returns each scene of the page whose runs are shipped, by its text."""
    firsts = [replace(first_scene(name), estimators=first_scene(name).estimators[:1]) for name in BUILT_IN]
    texts = [*SCENES, *(shareable_state.write_state(shareable_state.State(scene)) for scene in firsts)]
    return {text: shareable_state.parse_state(text).scene for text in texts}


def measure_errors(scene: Scene) -> dict[str, Any]:
    """Runs a scene; returns the object of the file without its time: the largest RMS errors in SI, true and estimated,
    of each quantity."""
    from solvers.running.run import run  # here: the page reads the file without Taichi

    result = run(scene, mid_run=False)
    true = {q: result.error[q]["max"] for q in QUANTITIES}
    estimated = {q: result.estimate[name][q]["max"] for name in scene.active_estimators[:1] for q in QUANTITIES}
    return {"method": scene.method, "cells": scene.cells, "status": result.status,
            **({} if result.status == OK else {"reason": result.explanation}), "error": true, "estimate": estimated}


def time_bare_runs(scenes: Sequence[Scene]) -> list[float]:
    """Returns the CPU seconds of each scene's bare run on one thread: the shortest of several, taken in turn, so that
    other work on the machine does not favour one of them."""
    from solvers.running.run import build

    solvers = [build(replace(scene, effects=(), estimators=())) for scene in scenes]
    least = [math.inf] * len(solvers)
    for _ in range(TIMES):
        for k, solver in enumerate(solvers):
            solver.restart(solver.scene)
            solver.compile()
            begun = time.process_time()
            while solver.step < solver.scene.steps and solver.sound:
                solver.advance(min(solver.scene.steps - solver.step, solver.longest_advance))
            least[k] = min(least[k], time.process_time() - begun)
    return least


def main() -> None:
    """Measures all runs and writes the file, a run a line."""
    parts = []
    for text, scene in scenes_to_ship().items():
        scenes = [task.scene() for task in sweep_tasks(scene)]
        runs = [measure_errors(replace(scene, method=one.method, cells=one.cells)) for one in scenes]
        lines = [json.dumps(run | {"seconds": float(f"{seconds:.3g}")})
                 for run, seconds in zip(runs, time_bare_runs(scenes), strict=True)]
        parts.append(f"{json.dumps(text)}: [\n" + ",\n".join(lines) + "]")
    FILE.write_text("{" + ",\n".join(parts) + "}\n", encoding="utf-8")


if __name__ == "__main__":
    main()
