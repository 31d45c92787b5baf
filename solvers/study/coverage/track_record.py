"""What was counted once, of a thousand runs of each problem, and stands in ``assets/coverage``."""

import functools
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from solvers.running.goals import DISPLACEMENT, SAFETY
from solvers.scene.scene import Scene
from solvers.study.coverage.tally import FACTORS, regime

FOLDER = Path(__file__).parents[3] / "assets" / "coverage"
FEWEST = 20  # runs: of fewer nothing is said


@functools.cache
def counted(problem: str) -> Mapping[str, Any] | None:
    """All counts (:func:`~solvers.study.coverage.tally.tally`); None for a problem of which nobody has counted."""
    path = FOLDER / f"{problem}.json"
    return json.loads(path.read_text(encoding="utf-8")) if path.exists() else None


def right(scene: Scene, estimator: str, quantity: str = "x") -> tuple[int, int] | None:
    """In how many runs like a scene, by method and by how far particles move, the estimate of a quantity was within a
    factor of 1.1 of the true error, and of how many; None where there were too few."""
    split = _of(scene, "estimators", estimator)
    found = split and split.get(quantity)
    if not found or found["runs"] < FEWEST:
        return None
    return found["within"][f"{FACTORS[0]:g}"], found["runs"]


def middle(problem: str, estimator: str, quantity: str) -> tuple[float, float] | None:
    """Between which two ratios of estimated to true error, at the end of a run, 80 of 100 of a problem's runs lay; None
    where there were too few, or a tenth of them read nothing."""
    known = counted(problem)
    found = known and known["estimators"].get(estimator, {}).get("all", {}).get(quantity, {}).get("at the end")
    if not found or found["runs"] < FEWEST or not found["middle"][0] > 0:
        return None
    low, high = found["middle"]
    return low, high


def held(scene: Scene, goal: str, estimator: str) -> tuple[int, int] | None:
    """In how many such runs a bar of twice the estimated error around a goal (by its name) held the truth, and of how
    many; None where there were too few."""
    kind = DISPLACEMENT if goal.startswith(DISPLACEMENT) else goal
    split = _of(scene, "goals", kind)
    found = split and split.get(f"{SAFETY:g} x {estimator}")
    return (found["held"], found["runs"]) if found and found["runs"] >= FEWEST else None


def _of(scene: Scene, group: str, name: str) -> Mapping[str, Any] | None:
    """Counts of runs like a scene; remedies and motions that none of the drawn ones had are like none."""
    known = counted(scene.problem)
    if known is None or name not in known[group] or scene.remedies or not scene.swings or not scene.solution_known:
        return None
    methods = known[group][name]["method and regime"]
    return methods.get(scene.method, {}).get(regime(scene.motion_amplitude / scene.spacing, scene.ppc))
