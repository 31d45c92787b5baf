"""Random runs of problems with an exact solution, and their measurement.

The distributions were fixed before any result was known. Sizes are uniform in their logarithm, choices are equally
likely unless a share is given. Modulus and density are fixed: errors scale with them, and no index depends on either.

Each is one row. Its keys::

    schema, key, problem, seed, number, solvers, status, reason, seconds, scene, moved (largest displacement, in cells)
    by_truth                                             the status that the true error alone would give: no estimator
    estimators: {name: {refused, index, end}}            refused: "", "before" or "after" the run, "impossible"; ratios
                                                         by quantity, over the run and at its end, 1 is perfect
    goals: {kind: {true_error, rounding, estimated_error, grids}}       as of a run; grids: the number on h, 2h and 4h

Estimators that are refused before a run are computed nevertheless, where possible, to know how often the refusal was
needless; their results decide nothing."""

import functools
import time
from collections.abc import Callable, Hashable, Mapping
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np

from solvers.problems import PROBLEMS
from solvers.running.quantities_of_interest import DISPLACEMENT, ENERGY, STRESS
from solvers.running.result import Result
from solvers.scene.estimator_limits import reason
from solvers.scene.kernel_options import kernel_key
from solvers.scene.scene import Scene
from solvers.scene.validation import SceneError
from solvers.solver import error_series, soundness
from solvers.solver.error_series import finite_or_none
from solvers.solver.rounding import largest_rounding_error
from solvers.solver.soundness import LOST, OK, UNSTABLE
from solvers.study.coverage.random_draw import RandomDraw, draw_between
from solvers.study.json_schema import NUMBER, NUMBER_OR_NONE, MapOf

QUANTITIES = ("x", "v", "sigma")
IMPOSSIBLE, BEFORE, AFTER = "impossible", "before", "after"  # how an estimator was refused
GOAL_COLUMNS = ("true_error", "rounding", "estimated_error")  # of a goal
MEASURED = {"scene": dict, "moved": NUMBER, "seconds": NUMBER, "by_truth": str,
            "estimators": MapOf({"refused": str, "index": MapOf(NUMBER_OR_NONE), "end": MapOf(NUMBER_OR_NONE)}),
            "goals": MapOf({"true_error": NUMBER_OR_NONE, "rounding": NUMBER_OR_NONE,
                            "estimated_error": MapOf(NUMBER_OR_NONE), "grids": list})}
GRIDS = 3  # h, 2h and 4h: what a grid convergence index is of
COARSEST = 2 ** (GRIDS - 1)
EFFECTS = ("truth", "estimate", "soundness", "crossings")
MOST_TRIES = 1000
SCENES, POINTS = 0, 1  # what chance is for


@dataclass(frozen=True)
class DrawRanges:
    """Ranges from which a problem's numbers are drawn; ``amplitude`` is in the unit of its scene, ``step`` relative to
    the longest stable step, ``work`` the largest number of particles times steps: a thousand runs take minutes."""

    cells: tuple[int, int]
    ppc: tuple[int, int]
    amplitude: tuple[float, float]
    periods: tuple[float, float] = (0.1, 3.0)
    step: tuple[float, float] = (0.1, 0.8)  # of the longest stable step
    work: float = 1e6


DRAW_RANGES = {"bar": DrawRanges((16, 128), (1, 6), (1e-4, 0.12)),
               "ring": DrawRanges((32, 64), (1, 3), (1e-3, 0.15), periods=(0.1, 2.0)),
               "vortex": DrawRanges((32, 64), (1, 3), (1e-2, 1.0), periods=(0.02, 1.0)),
               "square": DrawRanges((32, 64), (1, 3), (1e-3, 0.08), periods=(0.1, 1.5))}
#: Probabilities of choices that are not as likely as the others of their field.
SHARES: Mapping[str, Mapping[Any, float]] = {"velocity": {"grid": 0.8}, "linearity_preserving": {False: 0.75},
                                             "body_force": {"material": 0.7}, "layout": {"polar": 0.75}}
FORCES = {"bar": ("material", "node")}  # with exact solutions; elsewhere only that at material points


def draw_ranges_of(problem: str) -> DrawRanges:
    """Returns a problem's ranges; of an external one the square's, with amplitudes up to the hardest of its map."""
    amplitudes = PROBLEMS[problem].scene.HARD_AMPLITUDES
    return DRAW_RANGES.get(problem) or replace(DRAW_RANGES["square"], amplitude=(0.01 * amplitudes[-1], amplitudes[-1]))


class RandomRun(RandomDraw):
    """Random run of a problem."""

    SCHEMA = "mpm-lab/coverage-row/1"

    def scene(self) -> Scene:
        """Returns the run's scene on the finest of its three grids, with every estimator."""
        chance = self.random_generator(SCENES)
        for _ in range(MOST_TRIES):
            scene = _draw_scene(self.problem, chance)
            if scene is not None and scene.particles * scene.steps <= draw_ranges_of(self.problem).work:
                return scene
        raise AssertionError(f"no scene of the {self.problem} is cheap enough")

    def point_goal_name(self) -> str:
        """Returns the name of a goal, the displacement at a random material point: "displacement@0.123456"."""
        kind, chance = PROBLEMS[self.problem].scene, self.random_generator(POINTS)
        if kind.DIMENSIONS == 1:
            return f"{DISPLACEMENT}@{chance.uniform():.6f}"
        plane: Any = kind
        return f"{DISPLACEMENT}@" + ",".join(f"{coordinate:.6f}" for coordinate in plane.draw_point(chance))

    @property
    def kind(self) -> Hashable:
        """Key of the scene's compiled code without estimators, since every run has all of them."""
        return kernel_key(replace(self.scene(), estimators=()))


def coarsen(scene: Scene, times: int) -> Scene:
    """Returns a scene with cells ``times`` times as wide, steps as many times as long, and no estimators."""
    return replace(scene, cells=scene.cells // times, estimators=(), effects=("truth", "soundness"))


def _draw_scene(problem: str, chance: np.random.Generator) -> Scene | None:
    """Returns a random scene; None where the choices cannot be combined, or have no coarser grids."""
    kind, ranges = PROBLEMS[problem].scene, draw_ranges_of(problem)
    inputs: dict[str, Any] = {
        "cells": COARSEST * round(draw_between(chance, *(n / COARSEST for n in ranges.cells))),
        "ppc": int(chance.integers(ranges.ppc[0], ranges.ppc[1] + 1)),
        "amplitude": draw_between(chance, *ranges.amplitude), "periods": draw_between(chance, *ranges.periods),
        "method": _draw_choice(chance, kind.choices("method")),
        "body_force": _draw_choice(chance, FORCES.get(problem, ("material",)), "body_force"),
        "velocity": _draw_choice(chance, kind.choices("velocity"), "velocity"),
        "linearity_preserving": _draw_choice(chance, (False, True), "linearity_preserving"),
        "estimators": kind.choices("estimators"), "effects": EFFECTS}
    if layouts := kind.choices("layout") if "layout" in kind.__dataclass_fields__ else ():
        inputs["layout"] = _draw_choice(chance, layouts, "layout")
    step = draw_between(chance, *ranges.step)
    try:
        scene = kind(**inputs)
        if scene.particles * scene.steps > 10 * ranges.work:  # with the usual step: the bound is not worth asking for
            return None
        scene = replace(scene, cfl=step * scene.step_bound * scene.wave_speed / scene.spacing)
        coarsen(scene, COARSEST)
    except SceneError:
        return None
    return scene


def _draw_choice(chance: np.random.Generator, choices: tuple, field: str = "") -> Any:
    """Returns one of the choices, with the probabilities of ``field`` in ``SHARES`` or equal ones."""
    known = {one: share for one, share in SHARES.get(field, {}).items() if one in choices}
    rest = (1 - sum(known.values())) / max(1, len(choices) - len(known))
    shares = [known.get(one, rest) for one in choices]
    return choices[int(chance.choice(len(choices), p=np.array(shares) / sum(shares)))]


def measure_in_worker(draw: dict, answer: Callable[[dict], None]) -> None:
    """Calls ``answer`` with the row of :func:`measure`, in a worker process, for the fields of a :class:`RandomRun`."""
    from solvers.running.run import reuse_solvers  # here: Taichi is for workers

    reuse_solvers()
    answer(RandomRun(**draw).row(measure))


def measure(draw: RandomRun) -> dict:
    """Returns the row of a random run on three grids (keys: module docstring)."""
    from solvers.running.run import run  # here: a row can be read, kept and drawn without Taichi

    begun, scene = time.perf_counter(), draw.scene()
    goals = {DISPLACEMENT: draw.point_goal_name(), STRESS: STRESS, ENERGY: ENERGY}
    result = run(allow_refused_estimators(scene), mid_run=False, goals=list(goals.values()))
    others = [run(coarsen(scene, 2**k), mid_run=False, goals=list(goals.values())) for k in range(1, GRIDS)] \
        if status_by_truth(result) == OK else []
    numbers = {kind: [one.goals[name]["value"] for one in (result, *others)] for kind, name in goals.items()}
    return {**draw.identity_columns(), "status": result.status, "reason": result.reason, "scene": scene.to_dict(),
            "moved": scene.motion_amplitude / scene.spacing, "by_truth": status_by_truth(result),
            "estimators": {name: {"refused": refusal_kind(name, scene, result), **_ratios(result, name)}
                           for name in scene.estimators},
            "goals": {kind: {"grids": numbers[kind], **{key: result.goals[name][key] for key in GOAL_COLUMNS}}
                      for kind, name in goals.items()}, "seconds": time.perf_counter() - begun}


def status_by_truth(result: Result) -> str:
    """Returns the status of a result by its true error alone: "unstable", "lost" or "ok"; an estimate may be wrong."""
    if result.status == UNSTABLE:
        return UNSTABLE
    return LOST if any(name.startswith("error_") for name in soundness.findings(result.scene, result.series)) else OK


def refusal_kind(name: str, scene: Scene, result: Result) -> str:
    """Returns how an estimator was refused in the result of ``allow_refused_estimators(scene)``: "impossible", "before"
    or "after" the run; "" if it was not."""
    if name not in result.scene.active_estimators:
        return IMPOSSIBLE
    return BEFORE if name in scene.not_valid else AFTER if name in result.not_valid else ""


def _ratios(result: Result, estimator: str) -> dict[str, dict[str, float | None]]:
    """Returns an estimator's estimated over true error by quantity, over the run ("index") and at its end ("end")."""
    found: dict[str, dict[str, float | None]] = {"index": {}, "end": {}}
    for q in QUANTITIES:
        true, said = result.series[f"error_{q}"], result.series.get(f"{estimator}/estimate_{q}")
        if said is None:
            found["index"][q] = found["end"][q] = None
            continue
        least = float(largest_rounding_error(result.scene, q, result.steps))
        found["index"][q] = error_series.error_index(said, true, least)
        found["end"][q] = finite_or_none(float(said[-1] / true[-1])) if true[-1] > least else None
    return found


@functools.cache
def _unrefused_kind(kind: type[Scene]) -> type[Scene]:
    """Returns a subclass of a scene class whose refused estimators run, if that is possible."""
    def active(scene: Scene) -> tuple[str, ...]:
        limits = [limit for limit in kind.LIMITS if limit.impossible]
        return tuple(name for name in scene.choices("estimators") if not reason(limits, name, scene))
    return type(kind.__name__, (kind,), {"active_estimators": property(active)})


def allow_refused_estimators(scene: Scene) -> Scene:
    """Returns a copy of a scene in which estimators run although the scene refuses them, if that is possible."""
    return _unrefused_kind(type(scene))(**{one.name: getattr(scene, one.name) for one in fields(scene)})
