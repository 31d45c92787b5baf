"""What each rule of the estimators costs and saves: random runs with all rules switched off, what the rules would have
said, and what the estimates were worth.

``python -m tests.estimator_audit --seed 7 --runs 500 --out rows.json`` draws the runs, measures one after the other and
prints two tables: of each rule how many runs it refused and how many of these were good or bad, and of each estimator
and problem what it said where it was not refused. Rules are chosen on other seeds than those that are reported.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import math
import random
import re
import sys
from collections import defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from solvers.problems import PROBLEMS
from solvers.running.run import run
from solvers.scene.remedies import COUPLED, FILTER, FROZEN
from solvers.scene.rules import SceneError
from solvers.scene.scene import Scene
from solvers.solver.samples import QUANTITIES
from tests.ratios import ratio_of

Row = dict[str, Any]
ESTIMATORS = {"bar": ("recovered", "two-grid"), "ring": ("recovered", "two-grid"), "vortex": ("recovered",)}
SHARES = {"bar": 0.4, "ring": 0.25, "vortex": 0.35}  # of the runs
SMALLEST = {"bar": 1e-5, "ring": 1e-3, "vortex": 2e-2}  # amplitudes
LARGEST = {"bar": 0.12, "ring": 0.24, "vortex": 1.57}
CELLS = {"bar": (10, 220), "ring": (12, 64), "vortex": (14, 80)}
REACH = (0.6, 20.0)  # of waves in a period of the vortex, m
MOST_WORK = 2.5e6  # particles times steps
GOOD, BAD = (0.9, 1.1), 1.5  # bands of the index; a bad one lies beyond 1.5 or below 1/1.5
JUDGED = ("x", "v", "sigma")  # by which a run is good; a is often noise
#: What is compiled, by problem; everything else is drawn for each run.
SETS: dict[str, tuple[dict[str, Any], ...]] = {
    "bar": (
        {"method": "ugimp"}, {"method": "ugimp", "linearity_preserving": True},
        {"method": "ugimp", "linearity_preserving": True, "body_force": "node"},
        {"method": "ugimp", "linearity_preserving": True, "body_force": "none"},
        {"method": "cpgimp"}, {"method": "cpgimp", "body_force": "none"}, {"method": "cpgimp", "velocity": "corners"},
        {"method": "cpgimp", "velocity": "particle"}, {"method": "bspline", "linearity_preserving": True},
        {"method": "bspline"}, {"method": "mpm"},
        {"method": "mpm", "linearity_preserving": True, "body_force": "none"},
        {"method": "cpgimp", "remedies": (FILTER,)}, {"method": "ugimp", "remedies": (FILTER, COUPLED)},
        {"method": "mpm", "remedies": (FROZEN,)}),
    "ring": (
        {"method": "ugimp"}, {"method": "cpgimp"}, {"method": "cpdi"}, {"method": "cpdi"}, {"method": "mpm"},
        {"method": "cpdi", "velocity": "particle"}, {"method": "cpdi", "remedies": (FILTER,)},
        {"method": "ugimp", "remedies": (FROZEN,)}),
    "vortex": (
        {"method": "ugimp"}, {"method": "cpgimp"}, {"method": "cpgimp-v"}, {"method": "cpdi"}, {"method": "cpdi"},
        {"method": "mpm"}, {"method": "cpdi", "velocity": "particle"}, {"method": "ugimp", "remedies": (FILTER,)},
        {"method": "cpdi", "remedies": (FILTER,)}, {"method": "cpdi", "remedies": (FROZEN,)})}


def draw(chance: random.Random, problem: str, switches: dict[str, Any]) -> Scene:
    """A valid scene with these switches, of no more than ``MOST_WORK``."""
    def between(low: float, high: float) -> float:
        return math.exp(chance.uniform(math.log(low), math.log(high)))

    kind = PROBLEMS[problem].scene
    while True:
        inputs = {**switches, "estimators": ESTIMATORS[problem], "cells": round(between(*CELLS[problem])),
                  "ppc": chance.choice((1, 2, 3, 4, 5, 7) if problem == "bar" else (1, 2, 2, 3, 3, 4)),
                  "amplitude": between(SMALLEST[problem], LARGEST[problem]), "periods": between(0.3, 4.0),
                  "modulus": between(10.0, 1e8), "density": between(0.1, 1e4),
                  **({"cfl": between(0.03, 0.5)} if chance.random() < 0.75 else {"dt": "auto"})}
        with contextlib.suppress(SceneError):
            if problem == "vortex":
                inputs |= {"poisson_ratio": chance.uniform(0.0, 0.45), "periods": between(0.15, 1.2)}
                inputs["frequency"] = 2 * kind(**inputs).wave_speed / between(*REACH)
            scene = kind(**inputs)
            work = scene.steps * scene.particles
            if work > MOST_WORK:
                inputs["periods"] *= MOST_WORK / work
                scene = kind(**inputs)
            if inputs["periods"] > 0.1:
                return scene


def scenes(seed: int, runs: int) -> list[Scene]:
    """So many, those that are compiled alike together."""
    chance, found = random.Random(seed), []
    for problem, share in SHARES.items():
        count = round(share * runs)
        found += [draw(chance, problem, SETS[problem][n * len(SETS[problem]) // count]) for n in range(count)]
    return found


@contextlib.contextmanager
def no_rules() -> Iterator[None]:
    """Every estimator runs whatever is known beforehand."""
    kept = {problem: PROBLEMS[problem].scene.VALIDITY for problem in ESTIMATORS}
    for problem in kept:
        PROBLEMS[problem].scene.VALIDITY = {}
    try:
        yield
    finally:
        for problem, rules in kept.items():
            PROBLEMS[problem].scene.VALIDITY = rules


def measure(scene: Scene) -> Row:
    """A run with all estimators: what the rules say of each before and after, and its indices and distances."""
    row: Row = {"inputs": {name: value for name, value in scene.to_dict().items() if value is not None},
                "refused": dict(scene.not_valid), "index": {}, "distance": {}}
    with no_rules(), np.errstate(all="ignore"):
        scene = replace(scene)  # which asks anew
        try:
            result = run(scene, prices=False, mid_run=False)
        except (ArithmeticError, ValueError, SceneError) as error:  # what a rule keeps out may not even be computed
            return {**row, "status": f"failed: {error}"}
    row["refused"] = {**result.not_valid, **row["refused"]}
    for name in scene.active_estimators:
        for kind in ("index", "distance"):
            row[kind][name] = ratio_of(result, kind, name)
    return {**row, "status": result.status}


def verdict_on(index: dict[str, float | None], names: Iterable[str] = JUDGED) -> str:
    """"good" within the band in each of x, v and sigma of which something is said, "bad" beyond 1.5 in one, or "fair"
    between; "nothing" where nothing is said."""
    said = [value for name in names if (value := index[name]) is not None]
    if not said:
        return "nothing"
    if any(not 1 / BAD <= value <= BAD for value in said):
        return "bad"
    return "good" if all(GOOD[0] <= value <= GOOD[1] for value in said) else "fair"


def counts(rows: Iterable[Row]) -> tuple[dict, dict]:
    """Of each (estimator, problem, rule) what was refused, and of each (estimator, problem) what was said in runs that
    ended well: how many were good, fair, bad or nothing; of what was said also how many a was bad."""
    refused: dict = defaultdict(lambda: defaultdict(int))
    said: dict = defaultdict(lambda: defaultdict(int))
    for row in rows:
        if row["status"] not in ("ok", "lost"):
            continue
        for name, index in row["index"].items():
            key, verdict = (name, row["inputs"]["problem"]), verdict_on(index)
            if reason := row["refused"].get(name):
                refused[(*key, rule_of(reason))][verdict] += 1
            else:
                said[key][verdict if row["status"] == "ok" else f"{verdict}, lost"] += 1
                said[key]["a bad"] += row["status"] == "ok" and verdict_on(index, ("a",)) == "bad"
    return refused, said


def rule_of(reason: str) -> str:
    """A refusal without its numbers and names, cut to a line."""
    return re.sub(r"\b[\d.]+(e-?\d+)?\b", "#", reason.removeprefix("not valid here: "))[:58]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--runs", type=int, default=500)
    parser.add_argument("--out", type=Path, required=True)
    asked = parser.parse_args()
    rows = []
    with asked.out.open("w", encoding="utf-8") as out:
        for n, scene in enumerate(scenes(asked.seed, asked.runs)):
            rows.append(measure(scene))
            out.write(json.dumps(rows[-1]) + "\n")
            out.flush()
            print(f"\r{n + 1}", end="", file=sys.stderr)
    for table in counts(rows):
        print("\n| what | n | good | fair | bad | rest |\n|---|---|---|---|---|---|")
        for key, found in sorted(table.items()):
            rest = {name: count for name, count in found.items() if name not in ("good", "fair", "bad") and count}
            print(f"| {', '.join(key)} | {sum(found.values()) - found['a bad']} | {found['good']} | {found['fair']} | "
                  f"{found['bad']} | {rest or ''} |")


if __name__ == "__main__":
    assert QUANTITIES[:3] == JUDGED
    main()
