"""Benchmarks of solvers in this process: rates, prices, and the overhead of inactive diagnostics.

Everything runs on one thread in CPU time. The motion is gentle, so that every method's run stays sound; the time per
step does not depend on how far the particles move."""

import math
import time
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from solvers.problems import PROBLEMS
from solvers.running.repeated_step_timing import RepeatedSteps, particle_step_rate, time_interleaved, time_ratios
from solvers.running.run import build
from solvers.scene.scene import Scene
from solvers.scene.validation import SceneError
from solvers.solver.base import Solver
from solvers.solver.error_series import finite_or_none
from solvers.study.row import PRICED


def optional_part_inputs(scene: type[Scene]) -> dict[str, tuple[dict[str, Any], dict[str, Any]]]:
    """Returns the optional parts of a step by name: the inputs of this class of scenes that switch the part on, and
    those to compare with."""
    found: dict[str, tuple[dict[str, Any], dict[str, Any]]] = {
        name: ({"effects": (*needed, name)}, {"effects": needed}) for name, needed in PRICED.items()}
    found["body force"] = ({}, {"body_force": "none"})
    with suppress(SceneError):  # not offered
        scene(linearity_preserving=True)
        found["linearity preserving"] = ({"linearity_preserving": True}, {})
    return found


@dataclass(frozen=True)
class BenchmarkEffort:
    """Effort of a benchmark: numbers of cells, of turns, and seconds of a stretch of steps."""

    cells: Mapping[int, tuple[int, ...]]  # by dimension
    priced_cells: Mapping[int, int]  # for prices and for what is off
    rate_turns: int
    price_turns: int
    off_turns: int
    off_seconds: float  # longer, for a finer difference


FULL = BenchmarkEffort({1: (40, 160, 640), 2: (24, 96)}, {1: 160, 2: 48}, 5, 7, 15, 0.04)
QUICK = BenchmarkEffort({1: (40, 160), 2: (24,)}, {1: 40, 2: 24}, 3, 3, 5, 0.02)


def bare_scene(problem: str, cells: int, **inputs: Any) -> Scene:
    """Returns a scene of gentle motion with nothing optional but the given ``inputs`` (fields of the scene)."""
    kind = PROBLEMS[problem].scene
    return kind(**{"cells": cells, "effects": (), "estimators": (), "amplitude": kind.GENTLE_AMPLITUDE, **inputs})


def measure_rates(problem: str, method: str, effort: BenchmarkEffort) -> list[dict]:
    """Returns a row per size of the effort, with the rate in million particle-steps per second (None if unstable)."""
    scenes = [bare_scene(problem, cells, method=method) for cells in effort.cells[PROBLEMS[problem].scene.DIMENSIONS]]
    return [{**_scene_columns(scene), "particles": scene.particles,
             "rate": finite_or_none(particle_step_rate(build(scene), effort.rate_turns))} for scene in scenes]


def estimator_prices(problem: str, effort: BenchmarkEffort) -> list[dict]:
    """Returns a row per estimator of a problem: in ``ratio`` the time of a step with it, for all four quantities, over
    a bare step's; None with the reason in ``not_valid`` if it is not valid."""
    kind, with_it = PROBLEMS[problem].scene, dict[str, Scene]()
    for name in PROBLEMS[problem].estimators:  # of the default method, or the first for which the estimator is valid
        scenes = [_scene_to_price(problem, effort, method=method, effects=("estimate", "acceleration"),
                                  estimators=(name,)) for method in (kind.method, *kind.choices("method"))]
        with_it[name] = next((scene for scene in scenes if not scene.not_valid), scenes[0])
    without = {name: replace(scene, effects=(), estimators=()) for name, scene in with_it.items()}
    valid = [name for name, scene in with_it.items() if not scene.not_valid]
    found = time_ratios({name: (with_it[name], without[name]) for name in valid}, effort.price_turns)
    return [{**_scene_columns(scene), "name": name, "ratio": finite_or_none(found.get(name, math.nan)),
             "not_valid": scene.not_valid.get(name)} for name, scene in with_it.items()]


def effect_prices(problem: str, effort: BenchmarkEffort) -> list[dict]:
    """Returns a row per diagnostic or other optional part: in ``ratio`` the time of a step with over without it."""
    scene = _scene_to_price(problem, effort)
    pairs = {name: (replace(scene, **on), replace(scene, **off)) for name,
             (on, off) in optional_part_inputs(type(scene)).items()}
    found = time_ratios(pairs, effort.price_turns)
    return [{**_scene_columns(scene), "name": name, "ratio": finite_or_none(ratio)} for name, ratio in found.items()]


def measure_inactive_overhead(problem: str, effort: BenchmarkEffort) -> dict:
    """Returns the time of a bare step over that of a baseline whose code has no optional parts, and the uncertainty.

    Two solvers of each kind take turns. ``ratio`` is the median over the turns, ``low`` and ``high`` are the quartiles;
    ``same`` compares the two bare solvers, which run the same machine code and differ by noise alone. How the compiler
    lays code out is not in that: kernels of the same phases, compiled apart, were 1 to 3 % apart. ``call`` and
    ``call_stripped`` are the seconds that a call of either kernel costs beside its steps, more with more arguments."""
    scene = _scene_to_price(problem, effort)
    own, baseline = PROBLEMS[problem].solver, PROBLEMS[problem].baseline
    solvers = [kind(scene) for kind in (baseline, own, baseline, own)]
    stretches = [RepeatedSteps(solver, effort.off_seconds) for solver in solvers]
    steps = max(stretch.steps for stretch in stretches)
    for stretch in stretches:
        stretch.steps = steps
    calls = np.array([_empty_call_seconds(solver) for solver in solvers])
    turns = time_interleaved(stretches, effort.off_turns) - calls / steps
    over = turns[:, [1, 3]].min(axis=1) / turns[:, [0, 2]].min(axis=1)
    low, ratio, high = np.quantile(over, [0.25, 0.5, 0.75])
    return {**_scene_columns(scene), "ratio": finite_or_none(ratio), "low": finite_or_none(low),
            "high": finite_or_none(high), "same": finite_or_none(np.median(turns[:, 3] / turns[:, 1])),
            "call": min(calls[1], calls[3]), "call_stripped": min(calls[0], calls[2])}


def _empty_call_seconds(solver: Solver) -> float:
    """Returns the least CPU time in s of a call of a solver's kernel for no steps."""
    took = []
    for _ in range(50):
        begun = time.thread_time()
        solver.advance(0)
        took.append(time.thread_time() - begun)
    return min(took)


def _scene_to_price(problem: str, effort: BenchmarkEffort, **inputs: Any) -> Scene:
    return bare_scene(problem, effort.priced_cells[PROBLEMS[problem].scene.DIMENSIONS], **inputs)


def _scene_columns(scene: Scene) -> dict:
    return {"problem": scene.problem, "method": scene.method, "cells": scene.cells}
