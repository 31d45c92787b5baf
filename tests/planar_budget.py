"""Random trials of the error budgets of ring and vortex, and what they say as a table.

``uv run python -m tests.planar_budget`` writes ``assets/budget-plane.md``: 30 scenes, of each of which three causes are
taken away, with what the budget foretold beside what came; and who made the error of each method.
"""

import random
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from solvers.problems import PROBLEMS
from solvers.problems.planar.budget.on_demand import BudgetRun, PlanarBudget
from solvers.problems.planar.budget.sources import MAKERS
from solvers.problems.planar.scene import PlanarScene
from solvers.problems.ring.scene import RESONANCE, RingScene
from solvers.problems.vortex.scene import VortexScene
from solvers.running.budget import run_budget
from solvers.scene.causes import CAUSES, FIELDS, NOTHING
from solvers.scene.remedies import FROZEN
from solvers.solver import budget
from solvers.study.markdown import grid
from tests.budget import GOOD, SEED, Trial, causal_table, usable
from tests.paths import ROOT

MOST_WORK = 60_000  # particle-steps: a second or two
#: Of whom the table of shares is; the rest of a scene is that of a quarter of a period of the ring.
SHARES = [RingScene(method=method, layout=layout, amplitude=amplitude, periods=0.25, estimators=(), effects=())
          for amplitude in (1e-3, 0.05) for layout in ("polar", "cartesian")
          for method in RingScene.choices("method")]
FINER = [replace(scene, cells=cells) for cells in (12, 24, 48) for scene in SHARES
         if scene.layout == "polar"]


def drawn(seed: int, kind: type[PlanarScene], method: str | None = None) -> Iterator[PlanarScene]:
    """Valid scenes without end, the same for the same seed: every method or one, every switch that a budget covers."""
    chance = random.Random(seed)
    ring = kind is RingScene
    while True:
        scene = kind(
            method=method or chance.choice(kind.choices("method")), estimators=(), effects=(),
            cells=round(10 ** (chance.uniform(0.9, 1.4) if ring else chance.uniform(1.1, 1.4))),
            ppc=chance.randint(1, 4), cfl=10 ** chance.uniform(-1.7, -0.5),
            amplitude=(0.8 * RESONANCE if ring else 1.0) * 10 ** chance.uniform(-2.0, 0.0),
            periods=10 ** (chance.uniform(-1.0, 0.3) if ring else chance.uniform(-1.3, -0.3)),
            layout=chance.choice(("polar", "polar", "cartesian")),
            velocity="particle" if chance.random() < 0.2 else "grid",
            remedies=(FROZEN,) if chance.random() < 0.15 else ())
        if scene.steps * scene.particles <= MOST_WORK:
            yield scene


def budget_of(scene: PlanarScene) -> PlanarBudget:
    found = PROBLEMS[scene.problem].budget
    assert isinstance(found, PlanarBudget)
    return found


def errors(scene: PlanarScene, take_away: str = NOTHING) -> dict[str, np.ndarray] | None:
    """Errors by cause of each field at every sample (T, C, P, ...); None where the run goes bad."""
    found = budget_of(scene)
    run, kept = BudgetRun(found.solver(scene), found, take_away), []
    for step in range(1, scene.steps + 1):
        if not run.step():
            return None
        if step % scene.sample_interval == 0 or step == scene.steps:
            kept.append({field: values.copy() for field, values in run.causes.fields().items()})
    return {field: np.stack([values[field] for values in kept]) for field in FIELDS}


def trials(scene: PlanarScene) -> list[Trial]:
    """Of each of three causes what comes when it is taken away; nothing where a run goes bad."""
    by_cause = errors(scene)
    if by_cause is None:
        return []
    found = []
    before = _rms([by_cause[field].sum(1) for field in FIELDS])
    parts = sum(_rms([by_cause[field][:, c] for field in FIELDS]) for c in range(len(MAKERS)))
    for c, cause in enumerate(MAKERS):
        again = errors(scene, cause)
        if again is not None:
            left = [again[field].sum(1) for field in FIELDS]
            foretold = [by_cause[field].sum(1) - by_cause[field][:, c] for field in FIELDS]
            miss = _rms([one - other for one, other in zip(left, foretold, strict=True)]) / before
            found.append(Trial(scene, cause, *(tuple(values) for values in (
                before, _rms(foretold), _rms(left), miss, parts / before))))
    return found


def _rms(values: Sequence[np.ndarray]) -> np.ndarray:
    """Of each field (T, P, ...), over samples and particles."""
    return np.array([np.sqrt(np.sum(one**2) / one.shape[0] / one.shape[1]) for one in values])


def causal(count: int, kind: type[PlanarScene]) -> list[Trial]:
    """Trials of so many scenes, in all of which the budget is valid."""
    found: list[Trial] = []
    scenes = drawn(SEED, kind)
    while len(found) < len(MAKERS) * count:
        of_one = trials(next(scenes))
        found += of_one if len(of_one) == len(MAKERS) and all(map(usable, of_one)) else []
    return found


def words(scene: PlanarScene) -> str:
    """What tells a scene from others."""
    said = [scene.problem, scene.method, f"{scene.cells} cells", f"{scene.ppc} per cell and direction",
            f"cfl {scene.courant_number:.2g}", f"{scene.end_time / scene.period:.2g} periods",
            f"A {scene.amplitude:.2g}", scene.layout]
    return ", ".join([*said, *["velocity particle"] * (scene.velocity == "particle"), *scene.remedies])


def shares_table(scenes: Sequence[PlanarScene]) -> str:
    """Who made the error, a line a scene."""
    heads = ["cells", "A", "lattice", "method", "RMS error of x",
             *(f"{field}: {CAUSES[cause]}" for field in FIELDS for cause in MAKERS)]
    rows = []
    for scene in scenes:
        found = run_budget(scene)
        shares = found.to_dict()["budget"]
        error = budget.rms(found.result.series, "x")
        numbers = [f"{error:.2e}", *(f"{shares[field][cause]:.3f}" for field in FIELDS for cause in MAKERS)] \
            if shares["not_valid"] is None else ["goes bad", *["–"] * len(FIELDS) * len(MAKERS)]
        rows.append([f"{scene.cells}", f"{scene.amplitude:g}", scene.layout, scene.method, *numbers])
    return grid(heads, rows, heads[2:4])


def document() -> str:
    """What ``assets/budget-plane.md`` holds."""
    found = [trial for kind in (RingScene, VortexScene) for trial in causal(15, kind)]
    good = sum(max(trial.miss) <= GOOD for trial in found)
    return f"""# The error budgets of ring and vortex

Made by `uv run python -m tests.planar_budget`.

## Who made it

A quarter of a period of the ring: shares of the mean square of the error. On the polar lattice GIMP's boxes, which stay
upright, do not tile the ring, however little it moves; on the Cartesian one they tile at rest, and the share of
crossings comes with the motion, beside the staircases of the rims, which are the coarse grid's. CPDI's domains nearly
are the pieces, and hats count every particle whole.

{shares_table(SHARES)}

On finer grids the coarse grid's part falls, and what is left of GIMP's error is the crossings', even where next to
nothing crosses: boxes that do not tile, for which it does not fall as CPDI's does.

{shares_table(FINER)}

## Take a cause away, and run again

{len(found) // len(MAKERS)} random scenes, half of them the vortex, chosen by the seed {SEED},
and of each three causes taken away. Errors are RMS over particles and samples, of x in m, v in m/s and F; foretold
is the error less that cause's part, particle by particle; the miss is the RMS of what came less what was foretold,
over the error before. In {good} of {len(found)} trials all three fields miss by {GOOD} at most.

{causal_table(found, words)}
"""


if __name__ == "__main__":
    (ROOT / "assets" / "budget-plane.md").write_text(document(), encoding="utf-8")
