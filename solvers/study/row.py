"""One row: all data of a study about one scene, their measurement, and the schema of a stored row.

Keys of a row::

    schema, key, problem, asked (the inputs as given), scene (all inputs, defaults filled in; null if refused), h,
    status ("ok", "unstable", "lost", "failed", "refused"), reason, t, steps, particles, particle_steps,
    error, estimate, index, distance, corrected, not_valid (the last five keyed by estimator),
    what effects have found (grid_crossings, energy, ...), effects, soundness, life, budget,
    bytes, seconds, rate, arch, threads, plan, host, version,
    solvers (the fingerprint of the source that measured it)

``seconds`` holds ``repeats`` (the bare method, run after run), ``min`` of them, ``full`` (the shortest of the runs that
gave the errors), ``compile``, ``setup``, ``estimators`` (each one's part of ``full``) and ``effects`` (each alone).
"""

import functools
import hashlib
import platform
import statistics
from collections.abc import Callable, Collection
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

from solvers.problems import PROBLEMS
from solvers.running.result import Result
from solvers.scene.effects import ALL, EFFECTS
from solvers.scene.scene import Scene
from solvers.scene.validation import SceneError, field_key
from solvers.solver.soundness import BROKEN, OK
from solvers.study.json_schema import NUMBER, NUMBER_OR_NONE, MapOf, describe_mismatch
from solvers.study.parameter_grid import Task

SCHEMA = "mpm-lab/row/1"
FAILED, REFUSED = "failed", "refused"  # and what a run ends with, ``solvers.solver.soundness``
WARM_UP_STEPS = 256
TIMED_SECONDS = 0.05  # that the timed runs of a scene take together at least,
MOST_TIMES = 10  # unless that needs more than so many times the runs asked for
#: Effects that can be timed alone, each with one that it needs.
PRICED = {name: effect.needs[:1] for name, effect in EFFECTS.items() if effect.timed_alone}
ANY = (object, bool)
TEXT_OR_NONE = (str, type(None))
STATUSES = (OK, *BROKEN, FAILED, REFUSED)
IDENTITY = {"key": str, "problem": str, "asked": dict, "status": str, "reason": TEXT_OR_NONE,
            "scene": (dict, type(None))}
NORMS = MapOf(MapOf(NUMBER_OR_NONE))  # of each quantity, by kind of norm
#: What the row of a run has beside that.
MEASURED = {
    "scene": dict, "h": NUMBER, "steps": int, "particles": int, "error": NORMS, "estimate": MapOf(NORMS),
    "index": NORMS, "corrected": MapOf(NORMS),
    "seconds": {"repeats": list, "min": NUMBER, "full": NUMBER, "estimators": MapOf(NUMBER), "effects": MapOf(NUMBER)},
    "rate": NUMBER_OR_NONE, "life": MapOf(NUMBER_OR_NONE)}
SCENE = {"method": str, "cells": int, "ppc": NUMBER, "amplitude": NUMBER_OR_NONE, "dt": NUMBER, "cfl": NUMBER,
         "periods": NUMBER, "estimator": list, "effects": list, "remedies": list}
BLANK = dict.fromkeys(("scene", "h", "status", "reason", "t", "steps", "particles", "particle_steps"))


def measure(task: Task, measurement: Callable[[Task, Scene], dict] | None = None) -> dict:
    """Returns the row of a task, with the keys of this module, or the result of ``measurement`` for its scene. An error
    becomes a row with status "failed" or "refused", and is never raised."""
    if refusal := task.refusal():
        return refused_row(task, refusal)
    try:
        return (measurement or _measure_scene)(task, task.scene())
    except Exception as error:
        return failed_row(task, f"{type(error).__name__}: {error}")


def _measure_scene(task: Task, scene: Scene) -> dict:
    from solvers.running.run import run  # here: a row can be read, kept and drawn without Taichi

    results = [run(scene, prices=task.repeats > 0, mid_run=False) for _ in range(max(1, task.repeats))]
    full, values = results[0], results[0].to_dict()
    seconds, timed = time_bare(scene, task.repeats) if task.repeats else ([full.seconds.run], full)
    least = min(seconds)
    effects = price_effects(scene, task.repeats) if task.price_effects else {}
    names = [name for name in scene.active_estimators if name not in full.not_valid]
    fastest = min(result.seconds.run for result in results)
    prices = {name: fastest * statistics.median(result.seconds.estimators[name] / result.seconds.run
                                                for result in results) for name in full.seconds.estimators}
    row = {**identity_columns(task), "scene": values["scene"], "h": scene.spacing}
    row |= {name: values[name] for name in ("status", "reason", "t", "steps", "particles")}
    row |= {"particle_steps": full.steps * full.particles, "error": values["error"]}
    each = {"estimate": full.estimate, "index": full.index, "distance": full.distance}
    row |= {kind: {name: values_of[name] for name in names} for kind, values_of in each.items()}
    row |= {"corrected": {name: left for name, left in full.corrected.items() if name in names}}
    found = (ALL[name].json_key for name in scene.choices("effects") if ALL[name].numbers)
    kept = ("rounding", "checked", "not_checked", "as_large_as_itself", "not_valid", *found, "soundness", "life",
            "effects", "bytes", "budget")
    row |= {name: values[name] for name in kept}
    row |= {"seconds": {"repeats": seconds, "min": least, "full": fastest, "compile": full.seconds.compile,
                        "setup": full.seconds.setup, "estimators": prices, "effects": effects}}
    rate = 1e-6 * timed.particles * timed.steps / least if least > 0 else None
    return row | {"rate": rate, "arch": timed.arch, "threads": timed.threads, "plan": timed.plan,
                  "host": platform.node(), "version": task.version}


def price_effects(scene: Scene, repeats: int) -> dict[str, float]:
    """Returns by effect the seconds that it adds to the bare run when it is on alone, the shortest of ``repeats`` runs
    each; an effect that needs another is compared with that one alone. Estimators' prices are in the result."""
    wanted = [name for name in PRICED if scene.has(name)]
    sets = {name: (*PRICED[name], name) for name in wanted}
    least = {effects: min(time_bare(scene, repeats, effects)[0]) for effects in dict.fromkeys([(), *sets.values()])}
    return {name: least[effects] - least[PRICED[name]] for name, effects in sets.items()}


def time_bare(scene: Scene, repeats: int, effects: tuple[str, ...] = ()) -> tuple[list[float], Result]:
    """Returns the seconds of each run of a warmed-up scene with these effects alone, the shortest of which is the most
    reliable, and the last run. There are ``repeats`` runs, and more of short ones, until they take 0.05 s."""
    from solvers.running.run import run

    scene = replace(scene, effects=effects, estimators=())
    short = min(scene.end_time, WARM_UP_STEPS * scene.time_step)
    run(replace(scene, t_end=short, periods=None, sample_every=None), mid_run=False)
    seconds: list[float] = []
    while len(seconds) < repeats or (sum(seconds) < TIMED_SECONDS and len(seconds) < MOST_TIMES * repeats):
        result = run(scene, mid_run=False)
        seconds.append(result.seconds.run)
    return seconds, result


def unmeasured_row(task: Task, scene: Scene) -> dict:
    """Returns a row with a scene's inputs, and None for the results, which the caller knows from elsewhere."""
    return {**BLANK, "schema": SCHEMA, "key": task.key, "problem": task.problem, "asked": task.inputs,
            "scene": scene.to_dict(), "h": scene.spacing}


def refused_row(task: Task, error: SceneError) -> dict:
    """Returns the row of an invalid combination: status "refused", with the error as its reason."""
    return {**identity_columns(task), "status": REFUSED, "reason": str(error), "version": task.version}


def failed_row(task: Task, reason: str) -> dict:
    """Returns the row of a run that failed: status "failed", with this reason."""
    scene = None if task.refusal() else task.scene().to_dict()
    return {**identity_columns(task), "scene": scene, "status": FAILED, "reason": " ".join(reason.split()),
            "version": task.version}


def identity_columns(task: Task) -> dict:
    """Returns the columns of a row that identify its task, and None for its scene and results."""
    return {"schema": SCHEMA, "key": task.key, "problem": task.problem, "asked": task.inputs, **BLANK,
            "solvers": solver_source_hash()}


@functools.cache
def solver_source_hash() -> str:
    """Returns the SHA-256 of all files of ``solvers/``: a changed solver makes stored results outdated."""
    root = Path(__file__).parents[1]
    digest = hashlib.sha256()
    for path in sorted(root.rglob("*.py")):
        digest.update(path.relative_to(root).as_posix().encode() + b"\0" + path.read_bytes() + b"\0")
    return digest.hexdigest()


def find_fault(row: Any, measured: dict = MEASURED, identity: dict = IDENTITY) -> str | None:
    """Returns what is wrong with a stored row, in words: it must match the schema ``identity``, with a known status
    and, of a scene's row, a known problem, and a run the schema ``measured``; None where it is valid."""
    if found := describe_mismatch(row, identity):
        return found
    named: dict[str, Collection[str]] = {"status": STATUSES} | ({"problem": PROBLEMS} if identity is IDENTITY else {})
    for name, known in named.items():
        if row[name] not in known:
            return f"its {name} is not one of {', '.join(known)}"
    if measured is MEASURED and row["scene"] is not None:
        inputs = {field_key(field.name): ANY for field in fields(PROBLEMS[row["problem"]].scene)} | SCENE
        if found := describe_mismatch(row["scene"], inputs, "scene"):
            return found
    return describe_mismatch(row, measured) if row["status"] in (OK, *BROKEN) else None
