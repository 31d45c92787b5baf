"""Random trials of the bar's error budget, and what they say as a table.

``uv run python -m tests.budget`` writes ``assets/budget.md``: 30 scenes, of each of which three causes are taken away,
with what the budget foretold beside what came; and of 600 scenes how the miss goes with what the causes cancel, from
which ``solvers.solver.budget.MOST_CANCELLED`` was chosen.
"""

import math
import random
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import islice, pairwise
from typing import Any

import numpy as np

from solvers.problems.bar.scene import BarScene
from solvers.problems.bar.solver import BarSolver
from solvers.scene.causes import CAUSES, FIELDS
from solvers.scene.remedies import FROZEN, PIECES
from solvers.scene.rules import SceneError
from solvers.solver.budget import MOST_CANCELLED, ROUND_OFF
from solvers.study.markdown import grid
from tests.paths import ROOT

SEED = 26
MOST_STEPS = 4000
GOOD = 0.15  # of the error before: a miss up to which a prediction counts as right
EDGES = (0, 1.25, 1.5, 2, MOST_CANCELLED, 10, math.inf)
METHODS = BarScene.choices("method")
EFFECTS = ("truth", "budget")


def drawn(seed: int, method: str | None = None, remedies: Sequence[str] = BarScene.REMEDIES) -> Iterator[BarScene]:
    """Valid scenes without end, the same for the same seed: every method or one, every switch that a budget covers."""
    chance = random.Random(seed)
    while True:
        inputs: dict = {
            "method": method or chance.choice(METHODS), "cells": round(10 ** chance.uniform(1.0, 1.9)),
            "ppc": chance.randint(1, 6), "cfl": 10 ** chance.uniform(-1.7, -0.5),
            "amplitude": 10 ** chance.uniform(-3.6, -1.3), "periods": 10 ** chance.uniform(-1.0, 0.3),
            "body_force": chance.choice(("material", "material", "node", "none")),
            "linearity_preserving": chance.random() < 0.25, "velocity": chance.choice(BarScene.choices("velocity")),
            "remedies": tuple(name for name in remedies if chance.random() < 0.15)}
        if chance.random() < 0.1:
            particles = chance.randint(inputs["cells"], 6 * inputs["cells"])
            inputs |= {"motion": "patch", "ppc": particles / inputs["cells"], "body_force": "none",
                       "amplitude": BarScene.amplitude, "stretch": chance.uniform(0.9, 1.1)}
        try:
            scene = BarScene(**inputs, estimators=(), effects=EFFECTS)
        except SceneError:
            continue
        if scene.steps <= MOST_STEPS:
            yield scene


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


def causes_of(scene: BarScene) -> tuple[str, ...]:
    """The three causes that are taken away from a scene in turn."""
    return ("crossings", "coarse_grid", "body_force" if scene.body_force == "node" else "time_step")


def errors(scene: BarScene) -> np.ndarray | None:
    """Errors by cause at every sample (T, 3, P, causes); None where the run goes bad."""
    solver, kept = BarSolver(scene), []
    while solver.step < scene.steps and solver.sound:
        solver.advance(min(scene.sample_interval, scene.steps - solver.step))
        kept.append(solver._arrays.cause_errors.copy())
    return np.array(kept) if solver.sound else None


def trials(scene: BarScene) -> list[Trial]:
    """Of each of three causes what comes when it is taken away; nothing where a run goes bad."""
    by_cause = errors(scene)
    if by_cause is None:
        return []
    found = []
    before, parts = _rms(by_cause.sum(-1)), sum(_rms(by_cause[..., c]) for c in range(len(CAUSES)))
    for cause in causes_of(scene):
        again = errors(replace(scene, take_away=cause))
        if again is not None:
            left, foretold = again.sum(-1), by_cause.sum(-1) - by_cause[..., list(CAUSES).index(cause)]
            with np.errstate(invalid="ignore"):  # forces of pieces make no error of a patch test at all
                found.append(Trial(scene, cause, *(tuple(values) for values in (
                    before, _rms(foretold), _rms(left), _rms(left - foretold) / before, parts / before))))
    return found


def _rms(values: np.ndarray) -> np.ndarray:
    """(3,), over samples and particles."""
    return np.sqrt(np.mean(values**2, axis=(0, 2)))


def words(scene: BarScene) -> str:
    """What tells a scene from others."""
    said = [scene.method, f"{scene.cells} cells", f"{scene.ppc:.3g} a cell", f"cfl {scene.courant_number:.2g}",
            f"{scene.end_time / scene.period:.2g} periods",
            f"stretch {scene.stretch:.3g}" if scene.is_patch else f"A {scene.amplitude:.2g} m"]
    said += ["LP"] * scene.linearity_preserving + [f"force {scene.body_force}"] * (scene.body_force != "material")
    said += [f"velocity {scene.velocity}"] * (scene.velocity != "grid")
    return ", ".join([*said, *scene.remedies])


def usable(trial: Trial) -> bool:
    """Whether the budget counts as valid in it (``solvers.solver.budget.not_valid``)."""
    return max(trial.cancelled) <= MOST_CANCELLED and trial.before[0] > ROUND_OFF


def causal(count: int) -> list[Trial]:
    """Trials of so many scenes without remedies but frozen weights, in all of which the budget is valid."""
    found: list[Trial] = []
    scenes = drawn(SEED, remedies=(FROZEN,))
    while len(found) < 3 * count:
        of_one = trials(next(scenes))
        found += of_one if len(of_one) == 3 and all(map(usable, of_one)) else []
    return found


def causal_table(found: Sequence[Trial], words: Callable[[Any], str] = words) -> str:
    """A line a trial."""
    heads = ["scene", "without", *(f"{field}: {what}" for field in FIELDS for what in ("before", "foretold", "came",
                                                                                         "miss"))]
    return grid(heads, [[words(trial.scene), CAUSES[trial.cause], *(
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
    return grid(["cancelled", "cases", "median miss", "0.9 of them", "0.99", "largest", f"up to {GOOD}"], lines)


def document() -> str:
    """What ``assets/budget.md`` holds."""
    found = causal(30)
    good = sum(max(trial.miss) <= GOOD for trial in found)
    without = tuple(name for name in BarScene.REMEDIES if name != PIECES)
    many = [trial for scenes in (drawn(SEED, remedies=without), drawn(SEED + 1)) for scene in islice(scenes, 300)
            for trial in trials(scene)]
    return f"""# The error budget: take a cause away, and run again

Made by `uv run python -m tests.budget`. {len(found) // 3} random scenes of the bar, chosen by the seed {SEED},
and of each three causes taken away. Errors are RMS over particles and samples, of x in m, v in m/s and F; foretold
is the error less that cause's part, particle by particle; the miss is the RMS of what came less what was foretold,
over the error before. In {good} of {len(found)} trials all three fields miss by {GOOD} at most.

{causal_table(found)}

## How far a budget can be relied upon

600 random scenes, 300 of them with every remedy and 300 with every one but forces of pieces, {len(many)} trials of
three fields each. Cancelled: the sum of the causes' RMS errors over the RMS error itself. Beyond
{MOST_CANCELLED:g} a budget says that it is not valid.

{calibration_table(many)}
"""


if __name__ == "__main__":
    (ROOT / "assets" / "budget.md").write_text(document(), encoding="utf-8")
