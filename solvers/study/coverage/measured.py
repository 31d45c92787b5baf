"""One drawn run as a row: what it was, what every estimator said of it, refused or not, and numbers on three grids.

Keys of a row::

    schema, key, problem, seed, number, solvers, status, reason, seconds, scene, moved (largest displacement, in cells)
    estimators: {name: {refused, index, end}}            refused: "", "before" or "after" the run, "impossible"; ratios
                                                         by quantity, over the run and at its end, 1 is perfect
    goals: {kind: {true_error, rounding, estimated_error, grids}}       as of a run; grids: the number on h, 2h and 4h

What is refused before a run is computed all the same, where it can be, to know how often the refusal was needless; what
it says decides nothing.
"""

from __future__ import annotations

import functools
import time
from collections.abc import Callable
from dataclasses import fields
from typing import Any

from solvers.running.goals import DISPLACEMENT, ENERGY, STRESS
from solvers.running.result import Result
from solvers.scene.scene import Scene
from solvers.solver import norms
from solvers.solver.norms import finite
from solvers.solver.rounding import rounding
from solvers.solver.soundness import BROKEN, OK
from solvers.study.coverage.draws import GRIDS, Draw, coarser
from solvers.study.forms import NUMBER, NUMBER_OR_NONE, Each, mismatch
from solvers.study.row import FAILED, fingerprint, identity_fault

SCHEMA = "mpm-lab/coverage-row/1"
QUANTITIES = ("x", "v", "sigma")
IMPOSSIBLE, BEFORE, AFTER = "impossible", "before", "after"  # how an estimator was refused
KEPT = ("true_error", "rounding", "estimated_error")  # of a goal
STATUSES = (OK, *BROKEN, FAILED)
IDENTITY = {"key": str, "problem": str, "seed": int, "number": int, "status": str, "reason": (str, type(None))}
MEASURED = {"scene": dict, "moved": NUMBER, "seconds": NUMBER,
            "estimators": Each({"refused": str, "index": Each(NUMBER_OR_NONE), "end": Each(NUMBER_OR_NONE)}),
            "goals": Each({"true_error": NUMBER_OR_NONE, "rounding": NUMBER_OR_NONE,
                           "estimated_error": Each(NUMBER_OR_NONE), "grids": list})}


def measure_draw(draw: dict, answer: Callable[[dict], None]) -> None:
    """What a worker process does (``solvers.workers``)."""
    answer(measure(Draw(**draw)))


def measure(draw: Draw) -> dict:
    """The row of a draw, with the keys above; whatever goes wrong is a row too, and never an exception."""
    try:
        return _measured(draw)
    except Exception as error:
        return failed(draw, f"{type(error).__name__}: {error}")


def failed(draw: Draw, reason: str) -> dict:
    """The row of a run that was lost."""
    return {**_identity(draw), "status": FAILED, "reason": " ".join(reason.split())}


def _measured(draw: Draw) -> dict:
    from solvers.running.run import run  # here: a row can be read, kept and drawn without Taichi

    begun, scene = time.perf_counter(), draw.scene()
    goals = {DISPLACEMENT: draw.point(), STRESS: STRESS, ENERGY: ENERGY}
    result = run(heard(scene), mid_run=False, goals=list(goals.values()))
    others = [run(coarser(scene, 2**k), mid_run=False, goals=list(goals.values())) for k in range(1, GRIDS)] \
        if result.status == OK else []
    numbers = {kind: [one.goals[name]["value"] for one in (result, *others)] for kind, name in goals.items()}
    return {**_identity(draw), "status": result.status, "reason": result.reason, "scene": scene.to_dict(),
            "moved": scene.motion_amplitude / scene.spacing,
            "estimators": {name: {"refused": refused(name, scene, result), **_ratios(result, name)}
                           for name in scene.estimators},
            "goals": {kind: {"grids": numbers[kind], **{key: result.goals[name][key] for key in KEPT}}
                      for kind, name in goals.items()},
            "seconds": time.perf_counter() - begun}


def refused(name: str, scene: Scene, result: Result) -> str:
    """How an estimator was refused in the ``result`` of what a scene has become when it is :func:`heard`; "" where it
    was not."""
    if name not in result.scene.active_estimators:
        return IMPOSSIBLE
    return BEFORE if name in scene.not_valid else AFTER if name in result.not_valid else ""


def _ratios(result: Result, estimator: str) -> dict[str, dict[str, float | None]]:
    """Estimated over true error, summed over the run and at its end."""
    found: dict[str, dict[str, float | None]] = {"index": {}, "end": {}}
    for q in QUANTITIES:
        true, said = result.series[f"error_{q}"], result.series.get(f"{estimator}/estimate_{q}")
        if said is None:
            found["index"][q] = found["end"][q] = None
            continue
        least = float(rounding(result.scene, q, result.steps))
        found["index"][q] = norms.error_index(said, true, least)
        found["end"][q] = finite(float(said[-1] / true[-1])) if true[-1] > least else None
    return found


@functools.cache
def _hearing(kind: type[Scene]) -> type[Scene]:
    """A kind of scene whose estimators run although they are refused, if they can; that they are is known to it as
    before."""
    def active(scene: Scene) -> tuple[str, ...]:
        reasons = {name: rule(scene) for name, rule in kind.IMPOSSIBLE.items()}
        return tuple(name for name in scene.choices("estimators") if not reasons.get(name))
    return type(kind.__name__, (kind,), {"active_estimators": property(active)})


def heard(scene: Scene) -> Scene:
    """The same scene, whose estimators run although they are refused, if they can."""
    return _hearing(type(scene))(**{one.name: getattr(scene, one.name) for one in fields(scene)})


def _identity(draw: Draw) -> dict:
    return {"schema": SCHEMA, "key": draw.key, **draw.to_dict(), "solvers": fingerprint()}


def fault(row: Any) -> str | None:
    """What is wrong with a kept row, in words; None where it is whole."""
    if found := identity_fault(row, IDENTITY, STATUSES):
        return found
    return None if row["status"] == FAILED else mismatch(row, MEASURED)
