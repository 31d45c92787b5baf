"""Is "ok" ever said of a run that is wrong, or "lost" of a fine one? Random scenes with fresh seeds, and a search.

``python -m tests.verdict_search --runs 1000 --search 1000 --seed 7`` runs so many random scenes of each problem, and
then searches with as many evaluations for the one that is most wrong while its verdict is ok: in x with nothing on but
the effect soundness, in v and sigma with the truth on. It prints what was found, by kind.

One run has truth and soundness both; its verdict without the truth is made from the same samples, the truth struck out.
"""

from __future__ import annotations

import argparse
import math
import random
from collections import Counter
from collections.abc import Callable, Mapping
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
    kinds: frozenset[str]  # of evidence that condemned it without the truth

    @property
    def missed(self) -> bool:
        """Whether it is off by more than half the motion, and nothing says so without the truth."""
        return self.blind == OK and self.errors["x"] > BETWEEN * MOST_ERROR

    @property
    def false_alarm(self) -> bool:
        return self.blind == LOST and self.fine

    @property
    def fine(self) -> bool:
        return self.errors["x"] < FINE and not self.named and self.status != UNSTABLE

    def wrong(self, quantity: str) -> float:
        """How wrong a run is that counts as right in this quantity; 0 where that is said."""
        says_ok = self.blind == OK if quantity == "x" else self.status == OK and quantity not in self.named
        return self.errors[quantity] if says_ok else 0.0


def drawn(problem: str, chance: random.Random) -> Numbers:
    return {name: math.exp(chance.uniform(math.log(low), math.log(high)))
            for name, (low, high) in RANGES[problem].items()}


def moved(problem: str, numbers: Numbers, far: float, chance: random.Random) -> Numbers:
    """Numbers in the neighbourhood of others, within their ranges."""
    ranges = RANGES[problem]
    return {name: min(max(value * math.exp(far * chance.gauss(0, 1) * math.log(ranges[name][1] / ranges[name][0])),
                          ranges[name][0]), ranges[name][1]) for name, value in numbers.items()}


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
    kinds = frozenset(findings(replace(scene, effects=("soundness",)), unseen))
    with np.errstate(all="ignore"):
        errors = {"x": float(np.nanmax(series["error_x"])) / scene.motion_amplitude,
                  **{q: float(np.nanmax(series[f"error_{q}"])) / scene.rms_of(q) for q in ("v", "sigma")}}
    return Outcome(scene, errors, result.status,
                   UNSTABLE if result.status == UNSTABLE else LOST if kinds else OK,
                   frozenset(as_large_as_itself(scene, series)), kinds)


def random_runs(problem: str, count: int, chance: random.Random) -> list[Outcome]:
    """So many runs of random scenes."""
    found: list[Outcome] = []
    while len(found) < count:
        if scene := scene_of(problem, chance.choice(SWITCHES[problem]), drawn(problem, chance)):
            found.append(outcome(scene))
    return found


def search(problem: str, quantity: str, evaluations: int, chance: random.Random) -> Outcome:
    """The most wrong run that is called right: half of the evaluations at random, then about the best so far."""
    best: tuple[float, Outcome, Mapping[str, Any], Numbers] | None = None
    for turn in range(evaluations):
        at_random = best is None or turn < evaluations // 3 or chance.random() < 0.2
        switches = chance.choice(SWITCHES[problem]) if at_random or chance.random() < 0.2 else best[2]
        numbers = drawn(problem, chance) if at_random else moved(problem, best[3], 0.1 * chance.random() ** 2, chance)
        if scene := scene_of(problem, switches, numbers):
            one = outcome(scene)
            if best is None or one.wrong(quantity) > best[0]:
                best = one.wrong(quantity), one, switches, numbers
    assert best is not None
    return best[1]


def told(outcomes: list[Outcome]) -> str:
    """Counts of one problem's random runs."""
    lost = [one for one in outcomes if one.errors["x"] > MOST_ERROR and one.status != UNSTABLE]
    seen = [one for one in lost if one.blind == LOST]
    old = [one for one in seen if one.kinds - {"balance_gap"}]
    kinds = Counter(kind for one in lost for kind in one.kinds)
    return (f"{len(outcomes)} runs: {sum(one.status == UNSTABLE for one in outcomes)} unstable, {len(lost)} lost, "
            f"{len(seen)} of them found without the truth ({len(old)} without the balance of momentum; {dict(kinds)}), "
            f"{sum(one.missed for one in outcomes)} missed; "
            f"{sum(one.fine for one in outcomes)} fine, "
            f"{sum(one.false_alarm for one in outcomes)} false alarms; "
            f"ok with v or sigma as wrong as large: {sum(one.status == OK and bool(one.named) for one in outcomes)}")


def main(say: Callable[[str], None] = print) -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=1000)
    parser.add_argument("--search", type=int, default=0)
    parser.add_argument("--seed", type=int, default=random.SystemRandom().randrange(10**6))
    parser.add_argument("--problems", nargs="*", default=list(PROBLEMS))
    asked = parser.parse_args()
    for problem in asked.problems:
        chance = random.Random(f"{asked.seed} {problem}")
        outcomes = random_runs(problem, asked.runs, chance)
        say(f"{problem}, seed {asked.seed}: {told(outcomes)}")
        for one in outcomes:
            if one.missed or one.false_alarm:
                say(f"  {'missed' if one.missed else 'false alarm'}: {one.errors['x']:.3g} A, {one.kinds}, {one.scene}")
        for quantity in ("x", "v", "sigma") if asked.search else ():
            best = search(problem, quantity, asked.search, chance)
            say(f"  search for {quantity}: ok at {best.wrong(quantity):.3g} of "
                f"{'the amplitude' if quantity == 'x' else 'its own RMS'}: {best.scene}")


if __name__ == "__main__":
    main()
