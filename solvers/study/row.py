"""One row: everything that a study knows about one scene, and how it is measured.

Keys of a row::

    schema, key, problem, asked (the inputs as given), scene (all inputs, defaults filled in; null if refused), h,
    status ("ok", "unstable", "failed", "refused"), reason, t, steps, particles, particle_steps,
    error, estimate, index, distance, not_valid (the last four keyed by estimator), grid_crossings, energy, effects,
    bytes, seconds, rate, arch, threads, plan, host, version

``seconds`` holds ``repeats`` (the bare method, run after run), ``min`` of them, ``full`` (the shortest of the runs that
gave the errors), ``compile``, ``setup``, ``estimators`` (each one's part of ``full``) and ``effects`` (each
alone, if asked).
"""

from __future__ import annotations

import platform
import statistics
from collections.abc import Sequence
from dataclasses import replace

from solvers.effects import EFFECTS
from solvers.result import Result
from solvers.rules import SceneError
from solvers.scene import Scene
from solvers.study.grid import Task

SCHEMA = "mpm-lab/row/1"
OK, UNSTABLE, FAILED, REFUSED = "ok", "unstable", "failed", "refused"
WARM_UP_STEPS = 256
TIMED_SECONDS = 0.05  # that the timed runs of a scene take together at least,
MOST_TIMES = 10  # unless that needs more than so many times the runs asked for
#: Effects that can be timed alone, each with one that it needs.
PRICED = {name: effect.needs[:1] for name, effect in EFFECTS.items() if effect.timed_alone}
BLANK = dict.fromkeys(("scene", "h", "status", "reason", "t", "steps", "particles", "particle_steps"))


def measure(task: Task) -> dict:
    """The row of a task. Whatever goes wrong in its scene is a row too."""
    try:
        scene = task.scene()
    except SceneError as error:
        return refused(task, error)
    try:
        return _measured(task, scene)
    except Exception as error:
        return failed(task, f"{type(error).__name__}: {error}")


def _measured(task: Task, scene: Scene) -> dict:
    from solvers.run import run  # here: a row can be read, kept and drawn without Taichi

    seconds, timed = time_bare(scene, task.repeats)
    least = min(seconds)
    results = [run(scene) for _ in range(task.repeats)]
    full = results[0]
    values = full.to_dict()
    effects = price_effects(scene, task.repeats) if task.price_effects else {}
    names = [name for name in scene.active_estimators if name not in full.not_valid]
    row = {**_identity(task), "scene": values["scene"], "h": scene.spacing}
    row |= {name: values[name] for name in ("status", "reason", "t", "steps", "particles")}
    row |= {"particle_steps": full.steps * full.particles, "error": values["error"]}
    row |= {"estimate": {name: full.estimates(name) for name in names},
            "index": {name: full.index(name) for name in names},
            "distance": {name: full.distance(name) for name in names}}
    row |= {name: values[name] for name in ("not_valid", "grid_crossings", "energy", "effects", "bytes")}
    row |= {"seconds": {"repeats": seconds, "min": least, "full": min(result.seconds.run for result in results),
                        "compile": full.seconds.compile, "setup": full.seconds.setup,
                        "estimators": _estimator_seconds(results), "effects": effects}}
    rate = 1e-6 * timed.particles * timed.steps / least if least > 0 else None
    return row | {"rate": rate, "arch": timed.arch, "threads": timed.threads, "plan": timed.plan,
                  "host": platform.node(), "version": task.version}


def bare(scene: Scene) -> Scene:
    """The scene with nothing but the method: no truth, no estimate, no other effect."""
    return replace(scene, effects=(), estimators=())


def time_bare(scene: Scene, repeats: int) -> tuple[list[float], Result]:
    """Seconds of the bare run, ``repeats`` times: compiled and warmed up first. The shortest is the one to believe."""
    return _timed(bare(scene), repeats)


def price_effects(scene: Scene, repeats: int) -> dict[str, float]:
    """Seconds that each effect of the scene adds to the bare run when it is switched on alone.

    One that needs another is compared with that one alone. An estimator's price is in the result.
    """
    wanted = [name for name in PRICED if scene.has(name)]
    sets = {(): None, **{(*PRICED[name], name): None for name in wanted}}
    least = {effects: min(_timed(replace(bare(scene), effects=effects), repeats)[0]) for effects in sets}
    return {name: least[(*PRICED[name], name)] - least[PRICED[name]] for name in wanted}


def _timed(scene: Scene, repeats: int) -> tuple[list[float], Result]:
    """Seconds of the runs of a warmed-up scene: ``repeats``, and more of a short one, until together they have taken
    long enough to time; and the last run."""
    from solvers.run import run

    short = min(scene.end_time, WARM_UP_STEPS * scene.time_step)
    run(replace(scene, t_end=short, periods=None, sample_every=None))
    seconds: list[float] = []
    while len(seconds) < repeats or (sum(seconds) < TIMED_SECONDS and len(seconds) < MOST_TIMES * repeats):
        result = run(scene)
        seconds.append(result.seconds.run)
    return seconds, result


def _estimator_seconds(results: Sequence[Result]) -> dict[str, float]:
    """Each estimator's part of the fastest run, by the median of the shares found."""
    least = min(result.seconds.run for result in results)
    return {name: least * statistics.median(result.seconds.estimators[name] / result.seconds.run for result in results)
            for name in results[0].seconds.estimators}


def refused(task: Task, error: SceneError) -> dict:
    """The row of a combination that no scene can have."""
    return {**_identity(task), "status": REFUSED, "reason": str(error), "version": task.version}


def failed(task: Task, reason: str) -> dict:
    """The row of a run that was lost."""
    refusal = task.refusal()
    scene = None if refusal else task.scene().to_dict()
    return {**_identity(task), "scene": scene, "status": FAILED, "reason": " ".join(reason.split()),
            "version": task.version}


def _identity(task: Task) -> dict:
    return {"schema": SCHEMA, "key": task.key, "problem": task.problem, "asked": task.inputs, **BLANK}
