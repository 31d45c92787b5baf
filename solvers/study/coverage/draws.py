"""Runs drawn at random, by number: the same number of the same seed is the same run, however many are drawn.

Nothing here was chosen after a look at what came out. Sizes are uniform in their logarithm, choices are equally likely
unless a share is given. Modulus and density stay as they are: errors scale with them, and no index depends on either.
"""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Hashable, Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from solvers.problems import PROBLEMS
from solvers.running.goals import DISPLACEMENT
from solvers.scene.rules import SceneError
from solvers.scene.scene import Scene
from solvers.scene.switches import combination

GRIDS = 3  # h, 2h and 4h: what a grid convergence index is of
COARSEST = 2 ** (GRIDS - 1)
EFFECTS = ("truth", "estimate", "soundness", "crossings")
MOST_TRIES = 1000
SCENES, POINTS = 0, 1  # what chance is for


@dataclass(frozen=True)
class Reach:
    """Where the numbers of a problem are drawn from; the amplitude is that of its scene, in its unit, and ``work`` are
    particles times steps at most, so that a thousand runs take minutes."""

    cells: tuple[int, int]
    ppc: tuple[int, int]
    amplitude: tuple[float, float]
    periods: tuple[float, float] = (0.1, 3.0)
    step: tuple[float, float] = (0.1, 0.8)  # of the longest that the motion ahead bears
    work: float = 1e6


REACH = {"bar": Reach((16, 128), (1, 6), (1e-4, 0.12)),
         "ring": Reach((32, 64), (1, 3), (1e-3, 0.15), periods=(0.1, 2.0)),
         "vortex": Reach((32, 64), (1, 3), (1e-2, 1.0), periods=(0.02, 1.0))}
#: How likely a choice is that is not as likely as the others of its field.
SHARES: Mapping[str, Mapping[Any, float]] = {
    "velocity": {"grid": 0.8}, "linearity_preserving": {False: 0.75}, "body_force": {"material": 0.7},
    "layout": {"polar": 0.75}}
FORCES = {"bar": ("material", "node"), "ring": ("material",), "vortex": ("material",)}  # with exact solutions


@dataclass(frozen=True)
class Draw:
    """Number ``number`` of the ``seed`` for a problem; a task for ``solvers.study.places``."""

    problem: str
    seed: int
    number: int

    @property
    def key(self) -> str:
        """What its row is known by."""
        return hashlib.sha256(json.dumps(asdict(self), sort_keys=True).encode()).hexdigest()[:16]

    def scene(self) -> Scene:
        """The run on the finest grid, with every estimator."""
        chance = self._chance(SCENES)
        for _ in range(MOST_TRIES):
            scene = _drawn(self.problem, chance)
            if scene is not None and scene.particles * scene.steps <= REACH[self.problem].work:
                return scene
        raise AssertionError(f"no scene of the {self.problem} is cheap enough")

    def point(self) -> str:
        """The goal at a material point somewhere in the body."""
        kind, chance = PROBLEMS[self.problem].scene, self._chance(POINTS)
        if kind.DIMENSIONS == 1:
            return f"{DISPLACEMENT}@{chance.uniform():.6f}"
        body: Any = kind
        R, angle = chance.uniform(body.INNER, body.OUTER), chance.uniform(0, body.ANGLE)
        return f"{DISPLACEMENT}@{R * math.cos(angle):.6f},{R * math.sin(angle):.6f}"

    @property
    def kind(self) -> Hashable:
        """What has to be compiled for it, but for the estimators, which are all that there can be."""
        return combination(replace(self.scene(), estimators=()))

    def to_dict(self) -> dict:
        return asdict(self)

    def _chance(self, of: int) -> np.random.Generator:
        return np.random.default_rng([self.seed, self.number, of, *self.problem.encode()])


def coarser(scene: Scene, times: int) -> Scene:
    """The same run on cells so many times as wide, with steps as many times as long, and no estimator."""
    return replace(scene, cells=scene.cells // times, estimators=(), effects=("truth", "soundness"))


def _drawn(problem: str, chance: np.random.Generator) -> Scene | None:
    """A scene, or None where these choices do not go together, or give no coarser grids."""
    kind, reach = PROBLEMS[problem].scene, REACH[problem]
    inputs: dict[str, Any] = {
        "cells": COARSEST * round(_between(chance, *(n / COARSEST for n in reach.cells))),
        "ppc": int(chance.integers(reach.ppc[0], reach.ppc[1] + 1)), "amplitude": _between(chance, *reach.amplitude),
        "periods": _between(chance, *reach.periods),
        "method": _choice(chance, kind.choices("method")), "body_force": _choice(chance, FORCES[problem], "body_force"),
        "velocity": _choice(chance, kind.choices("velocity"), "velocity"),
        "linearity_preserving": _choice(chance, (False, True), "linearity_preserving"),
        "estimators": kind.choices("estimators"), "effects": EFFECTS}
    if layouts := kind.choices("layout") if "layout" in kind.__dataclass_fields__ else ():
        inputs["layout"] = _choice(chance, layouts, "layout")
    step = _between(chance, *reach.step)
    try:
        scene = kind(**inputs)
        if scene.particles * scene.steps > 10 * reach.work:  # with the usual step: the bound is not worth asking for
            return None
        scene = replace(scene, cfl=step * scene.step_bound * scene.wave_speed / scene.spacing)
        coarser(scene, COARSEST)
    except SceneError:
        return None
    return scene


def _between(chance: np.random.Generator, low: float, high: float) -> float:
    return math.exp(chance.uniform(math.log(low), math.log(high)))


def _choice(chance: np.random.Generator, choices: tuple, field: str = "") -> Any:
    """One of them, by its share."""
    known = {one: share for one, share in SHARES.get(field, {}).items() if one in choices}
    rest = (1 - sum(known.values())) / max(1, len(choices) - len(known))
    shares = [known.get(one, rest) for one in choices]
    return choices[int(chance.choice(len(choices), p=np.array(shares) / sum(shares)))]
