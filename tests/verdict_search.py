"""Is "ok" ever said of a run that is wrong, or "lost" of a fine one? Random scenes.

One run has truth and soundness both; its verdict without the truth is made from the same samples, the truth struck out.
"""

from __future__ import annotations

import math
import random
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from solvers.problems import PROBLEMS
from solvers.running.run import run
from solvers.scene.remedies import CENTRED, COUPLED, FILTER, FROZEN
from solvers.scene.rules import SceneError
from solvers.scene.scene import Scene
from solvers.solver.checked import as_large_as_itself
from solvers.solver.soundness import LOST, MOST_ERROR, OK, UNSTABLE, findings

FINE = 0.1  # amplitudes: a run whose error of x never exceeds it, nor v and sigma themselves, must not be called lost
BETWEEN = 1.2  # looks are 20 a period: between two of them an error may be larger than at either
MOST_WORK, MOST_STEPS = 3e5, 8000  # of a scene: particles and nodes times steps, and steps
SWITCHES: dict[str, tuple[dict[str, Any], ...]] = {
    "bar": ({"method": "mpm"}, {"method": "ugimp"}, {"method": "cpgimp"}, {"method": "bspline"},
            {"method": "ugimp", "linearity_preserving": True}, {"method": "ugimp", "body_force": "node"},
            {"method": "cpgimp", "linearity_preserving": True, "remedies": (FILTER, COUPLED, CENTRED)},
            {"method": "mpm", "remedies": (FROZEN,)}, {"method": "cpgimp", "body_force": "none"},
            {"method": "ugimp", "velocity": "particle"}),
    "ring": ({"method": "mpm"}, {"method": "ugimp"}, {"method": "cpgimp"}, {"method": "cpdi"},
             {"method": "ugimp", "remedies": (FILTER, COUPLED)}, {"method": "mpm", "velocity": "particle"},
             {"method": "cpdi", "layout": "cartesian"}),
    "vortex": ({"method": "mpm"}, {"method": "ugimp"}, {"method": "cpgimp-v"}, {"method": "cpdi"},
               {"method": "cpgimp", "remedies": (FILTER,)}, {"method": "mpm", "remedies": (FROZEN,)},
               {"method": "cpdi", "layout": "cartesian"}, {"method": "cpdi", "poisson_ratio": 0.47}),
}
#: Of each number the range it is drawn from, by its logarithm.
RANGES: dict[str, dict[str, tuple[float, float]]] = {
    "bar": {"cells": (4, 250), "ppc": (1, 8), "amplitude": (1e-4, 0.158), "cfl": (0.03, 0.6), "periods": (0.05, 40)},
    "ring": {"cells": (8, 40), "ppc": (1, 4), "amplitude": (1e-3, 0.384), "cfl": (0.03, 0.5), "periods": (0.05, 3)},
    "vortex": {"cells": (12, 40), "ppc": (1, 4), "amplitude": (1e-3, 1.57), "cfl": (0.03, 0.5), "periods": (0.05, 2),
               "frequency": (0.03, 6.0)},
}
Numbers = dict[str, float]


@dataclass(frozen=True)
class Outcome:
    """A run: its largest errors (x in amplitudes; v and sigma in their own RMS), its status with the truth and without,
    and the quantities that are named as wrong."""

    scene: Scene
    errors: Mapping[str, float]
    status: str
    blind: str
    named: frozenset[str]

    @property
    def missed(self) -> bool:
        """Whether it is off by more than half the motion, and nothing says so without the truth."""
        return self.blind == OK and self.errors["x"] > BETWEEN * MOST_ERROR

    @property
    def false_alarm(self) -> bool:
        """Whether it is lost without the truth, and fine with it."""
        fine = self.errors["x"] < FINE and not self.named and self.status != UNSTABLE
        return self.blind == LOST and fine


def drawn(problem: str, chance: random.Random) -> Numbers:
    return {name: math.exp(chance.uniform(math.log(low), math.log(high)))
            for name, (low, high) in RANGES[problem].items()}


def scene_of(problem: str, switches: Mapping[str, Any], numbers: Numbers) -> Scene | None:
    """The scene, cut to what is cheap; None where it is refused."""
    whole = {name: round(value) if name in ("cells", "ppc") else value for name, value in numbers.items()}
    try:
        scene = PROBLEMS[problem].scene(**switches, **whole, estimators=(), effects=("truth", "soundness"))
        most = min(MOST_STEPS, MOST_WORK / (scene.particles + 0.2 * scene.cells**scene.DIMENSIONS))
        return replace(scene, periods=whole["periods"] * most / scene.steps) if scene.steps > most else scene
    except SceneError:
        return None


def outcome(scene: Scene) -> Outcome:
    """Run a scene and judge it twice."""
    result = run(scene, prices=False, mid_run=False)
    series = result.series
    unseen = {name: np.full_like(values, np.nan) if name.startswith("error_") else values
              for name, values in series.items()}
    lost = findings(replace(scene, effects=("soundness",)), unseen)
    with np.errstate(all="ignore"):
        errors = {"x": float(np.nanmax(series["error_x"])) / scene.motion_amplitude,
                  **{q: float(np.nanmax(series[f"error_{q}"])) / scene.rms_of(q) for q in ("v", "sigma")}}
    return Outcome(scene, errors, result.status,
                   UNSTABLE if result.status == UNSTABLE else LOST if lost else OK,
                   frozenset(as_large_as_itself(scene, series)))


def random_runs(problem: str, count: int, chance: random.Random,
                switches: Sequence[Mapping[str, Any]] = ()) -> list[Outcome]:
    """So many runs of random scenes, with some of the ``switches`` or any."""
    found: list[Outcome] = []
    while len(found) < count:
        if scene := scene_of(problem, chance.choice(switches or SWITCHES[problem]), drawn(problem, chance)):
            found.append(outcome(scene))
    return found
