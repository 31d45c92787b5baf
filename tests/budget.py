"""Random trials of the error budgets, and what they say as tables.

``uv run python -m tests.budget`` writes ``assets/budget.md`` of the bar and ``assets/budget-plane.md`` of ring and
vortex: 30 scenes each, of each of which three causes are taken away, with what the budget foretold beside what came. Of
the bar also how the miss goes with what the causes cancel in 600 scenes, from which
``solvers.solver.budget_shares.MOST_CANCELLED`` was chosen; in the plane who made the error of each method.
"""

import math
import random
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import islice, pairwise
from typing import Any

import numpy as np

from solvers.problems.bar.scene import BarScene
from solvers.problems.bar.solver import BarSolver
from solvers.problems.planar.budget.cause_errors import LOCAL_CAUSES
from solvers.problems.planar.budget.on_demand_budget import CauseTrackingRun
from solvers.problems.ring import RingScene
from solvers.problems.ring_estimator_limits import RESONANCE
from solvers.problems.vortex import VortexScene
from solvers.running.budget_cause_removal import run_budget
from solvers.running.run import build
from solvers.scene.error_causes import CAUSES, FIELDS, NOTHING
from solvers.scene.scene import Scene
from solvers.scene.stabilisations import FROZEN, PIECES
from solvers.scene.validation import SceneError
from solvers.solver import budget_shares
from solvers.solver.budget_shares import MOST_CANCELLED, ROUND_OFF
from solvers.study.markdown_tables import markdown_table
from tests.support.paths import ROOT

SEED = 26
MOST_STEPS, MOST_WORK = 4000, 60_000  # of the bar, and particle-steps in the plane: a second or two
GOOD = 0.15  # of the error before: a miss up to which a prediction counts as right
EDGES = (0, 1.25, 1.5, 2, MOST_CANCELLED, 10, math.inf)
EFFECTS = ("truth", "budget")
#: Of whom the table of shares is; the rest of a scene is that of a quarter of a period of the ring.
SHARES = [RingScene(method=method, layout=layout, amplitude=amplitude, periods=0.25, estimators=(), effects=())
          for amplitude in (1e-3, 0.05) for layout in ("polar", "cartesian")
          for method in RingScene.choices("method")]
FINER = [replace(scene, cells=cells) for cells in (12, 24, 48) for scene in SHARES
         if scene.layout == "polar"]


def drawn(seed: int, kind: type[Scene], method: str | None = None,
          remedies: Sequence[str] = BarScene.REMEDIES) -> Iterator[Any]:
    """Valid scenes without end, the same for the same seed: every method or one, every switch that a budget covers; of
    the bar with these ``remedies`` at most."""
    chance = random.Random(seed)
    while True:
        try:
            scene = _bar(chance, method, remedies) if kind is BarScene else _plane(chance, kind, method)
        except SceneError:
            continue
        if scene.steps <= MOST_STEPS if kind is BarScene else scene.steps * scene.particles <= MOST_WORK:
            yield scene


def _bar(chance: random.Random, method: str | None, remedies: Sequence[str]) -> BarScene:
    inputs: dict = {
        "method": method or chance.choice(BarScene.choices("method")), "cells": round(10 ** chance.uniform(1.0, 1.9)),
        "ppc": chance.randint(1, 6), "cfl": 10 ** chance.uniform(-1.7, -0.5),
        "amplitude": 10 ** chance.uniform(-3.6, -1.3), "periods": 10 ** chance.uniform(-1.0, 0.3),
        "body_force": chance.choice(("material", "material", "node", "none")),
        "linearity_preserving": chance.random() < 0.25, "velocity": chance.choice(BarScene.choices("velocity")),
        "remedies": tuple(name for name in remedies if chance.random() < 0.15)}
    if chance.random() < 0.1:
        particles = chance.randint(inputs["cells"], 6 * inputs["cells"])
        inputs |= {"motion": "patch", "ppc": particles / inputs["cells"], "body_force": "none",
                   "amplitude": BarScene.amplitude, "stretch": chance.uniform(0.9, 1.1)}
    return BarScene(**inputs, estimators=(), effects=EFFECTS)


def _plane(chance: random.Random, kind: type[Any], method: str | None) -> Any:
    ring = kind is RingScene
    return kind(
        method=method or chance.choice(kind.choices("method")), estimators=(), effects=(),
        cells=round(10 ** (chance.uniform(0.9, 1.4) if ring else chance.uniform(1.1, 1.4))),
        ppc=chance.randint(1, 4), cfl=10 ** chance.uniform(-1.7, -0.5),
        amplitude=(0.8 * RESONANCE if ring else 1.0) * 10 ** chance.uniform(-2.0, 0.0),
        periods=10 ** (chance.uniform(-1.0, 0.3) if ring else chance.uniform(-1.3, -0.3)),
        layout=chance.choice(("polar", "polar", "cartesian")),
        velocity="particle" if chance.random() < 0.2 else "grid",
        remedies=(FROZEN,) if chance.random() < 0.15 else ())


@dataclass(frozen=True)
class Trial:
    """A cause taken away: RMS errors over particles and samples, of x, v and F, before, as foretold and as they came,
    and of the difference of the last two, particle by particle, over the first. ``cancelled`` is the sum of the causes'
    RMS over that of the error."""

    scene: Any
    cause: str
    before: tuple[float, ...]
    foretold: tuple[float, ...]
    came: tuple[float, ...]
    miss: tuple[float, ...]
    cancelled: tuple[float, ...]


def causes_of(scene: Any) -> tuple[str, ...]:
    """The three causes that are taken away from a scene in turn."""
    return ("crossings", "coarse_grid", "body_force" if scene.body_force == "node" else "time_step")


def errors(scene: Any, take_away: str = NOTHING) -> list[np.ndarray] | None:
    """Of x, v and F the errors by cause at every sample (T, causes, P, ...); None where the run goes bad."""
    kept = (_of_bar if scene.problem == "bar" else _in_plane)(scene, take_away)
    return kept and [np.stack(of_field) for of_field in zip(*kept, strict=True)]


def _of_bar(scene: BarScene, take_away: str) -> list[np.ndarray] | None:
    solver, kept = BarSolver(replace(scene, take_away=take_away)), []
    while solver.step < scene.steps and solver.sound:
        solver.advance(min(scene.sample_interval, scene.steps - solver.step))
        kept.append(np.moveaxis(solver._arrays.cause_errors, 2, 1)[..., None].copy())
    return kept if solver.sound else None


def _in_plane(scene: Any, take_away: str) -> list[list[np.ndarray]] | None:
    run, kept = CauseTrackingRun(build(scene), take_away), []
    for step in range(1, scene.steps + 1):
        if not run.step():
            return None
        if step % scene.sample_interval == 0 or step == scene.steps:
            kept.append([np.insert(values, list(CAUSES).index("body_force"), 0.0, axis=0)
                         for values in run.causes.fields().values()])
    return kept


def trials(scene: Any) -> list[Trial]:
    """Of each of three causes what comes when it is taken away; nothing where a run goes bad."""
    by_cause = errors(scene)
    if by_cause is None:
        return []
    found = []
    before = _rms([values.sum(1) for values in by_cause])
    parts = sum(_rms([values[:, c] for values in by_cause]) for c in range(len(CAUSES)))
    for cause in causes_of(scene):
        again = errors(scene, cause)
        if again is not None:
            left = [values.sum(1) for values in again]
            foretold = [values.sum(1) - values[:, list(CAUSES).index(cause)] for values in by_cause]
            miss = _rms([one - other for one, other in zip(left, foretold, strict=True)])
            with np.errstate(invalid="ignore"):  # forces of pieces make no error of a patch test at all
                found.append(Trial(scene, cause, *(tuple(values) for values in (
                    before, _rms(foretold), _rms(left), miss / before, parts / before))))
    return found


def _rms(values: Sequence[np.ndarray]) -> np.ndarray:
    """Of each field (T, P, ...), over samples and particles."""
    return np.array([np.sqrt(np.sum(one**2) / one.shape[0] / one.shape[1]) for one in values])


def words(scene: Any) -> str:
    """What tells a scene from others."""
    per = f"{scene.ppc:.3g} a cell" if scene.problem == "bar" else f"{scene.ppc} per cell and direction"
    said = [scene.method, f"{scene.cells} cells", per, f"cfl {scene.courant_number:.2g}",
            f"{scene.end_time / scene.period:.2g} periods"]
    moved = f"A {scene.amplitude:.2g}"
    if scene.problem != "bar":
        said = [scene.problem, *said, moved, scene.layout]
    else:
        said += [f"stretch {scene.stretch:.3g}" if scene.is_patch else f"{moved} m"]
        said += ["LP"] * scene.linearity_preserving
        said += [f"force {scene.body_force}"] * (scene.body_force != "material")
    return ", ".join([*said, *[f"velocity {scene.velocity}"] * (scene.velocity != "grid"), *scene.remedies])


def usable(trial: Trial) -> bool:
    """Whether the budget counts as valid in it (``solvers.solver.budget_shares.why_not_valid``)."""
    return max(trial.cancelled) <= MOST_CANCELLED and trial.before[0] > ROUND_OFF


def causal(count: int, kind: type[Scene]) -> list[Trial]:
    """Trials of so many scenes without remedies but frozen weights, in all of which the budget is valid."""
    found: list[Trial] = []
    scenes = drawn(SEED, kind, remedies=(FROZEN,))
    while len(found) < 3 * count:
        of_one = trials(next(scenes))
        found += of_one if len(of_one) == 3 and all(map(usable, of_one)) else []
    return found


def causal_table(found: Sequence[Trial]) -> str:
    """A line a trial."""
    heads = ["scene", "without", *(f"{field}: {what}" for field in FIELDS
                                   for what in ("before", "predicted", "observed", "deviation"))]
    return markdown_table(heads, [[words(trial.scene), CAUSES[trial.cause], *(
        format(values[k], form) for k in range(len(FIELDS))
        for values, form in ((trial.before, ".2e"), (trial.foretold, ".2e"), (trial.came, ".2e"),
                             (trial.miss, ".3f")))] for trial in found], heads[:2])


def calibration_table(found: Sequence[Trial]) -> str:
    """How the miss goes with what cancels, each field for itself."""
    pairs = [(c, m) for trial in found if trial.before[0] > ROUND_OFF
             for c, m in zip(trial.cancelled, trial.miss, strict=True) if np.isfinite(c + m)]
    lines = []
    for low, high in pairwise(EDGES):
        misses = np.array([m for c, m in pairs if low <= c < high])
        if len(misses):
            lines.append([f"{low:g} to {high:g}", str(len(misses)), *(f"{np.quantile(misses, q):.3f}"
                          for q in (0.5, 0.9, 0.99, 1)), f"{100 * np.mean(misses <= GOOD):.1f} %"])
    return markdown_table(["cancellation", "cases", "median deviation", "90 %", "99 %", "largest", f"up to {GOOD}"],
                          lines)


def shares_table(scenes: Sequence[RingScene]) -> str:
    """Who made the error, a line a scene."""
    heads = ["cells", "A", "lattice", "method", "RMS error of x",
             *(f"{field}: {CAUSES[cause]}" for field in FIELDS for cause in LOCAL_CAUSES)]
    rows = []
    for scene in scenes:
        found = run_budget(scene)
        shares = found.to_dict()["budget"]
        error = budget_shares.rms_error_over_run(found.result.series, "x")
        numbers = [f"{error:.2e}", *(f"{shares[field][cause]:.3f}" for field in FIELDS for cause in LOCAL_CAUSES)] \
            if shares["not_valid"] is None else ["goes bad", *["–"] * len(FIELDS) * len(LOCAL_CAUSES)]
        rows.append([f"{scene.cells}", f"{scene.amplitude:g}", scene.layout, scene.method, *numbers])
    return markdown_table(heads, rows, heads[2:4])


def texts() -> tuple[str, str]:
    """What ``assets/budget.md`` and ``assets/budget-plane.md`` hold: ``tests/budget.md``, with the numbers."""
    bar, plane = (ROOT / "tests" / "budget.md").read_text(encoding="utf-8").split("{{}}\n")
    without = tuple(name for name in BarScene.REMEDIES if name != PIECES)
    many = [trial for scenes in (drawn(SEED, BarScene, remedies=without), drawn(SEED + 1, BarScene))
            for scene in islice(scenes, 300) for trial in trials(scene)]
    return (bar.format(**_numbers(causal(30, BarScene)), many=len(many), most=f"{MOST_CANCELLED:g}",
                       calibration=calibration_table(many)),
            plane.format(**_numbers([trial for kind in (RingScene, VortexScene) for trial in causal(15, kind)]),
                         shares=shares_table(SHARES), finer=shares_table(FINER)))


def _numbers(found: Sequence[Trial]) -> dict[str, Any]:
    """Of trials in which a cause was taken away, three of each scene."""
    return {"trials": len(found), "scenes": len(found) // len(LOCAL_CAUSES), "seed": SEED, "near": GOOD,
            "good": sum(max(trial.miss) <= GOOD for trial in found), "table": causal_table(found)}


if __name__ == "__main__":
    for name, text in zip(("budget", "budget-plane"), texts(), strict=True):
        (ROOT / "assets" / f"{name}.md").write_text(text, encoding="utf-8")
