"""Runs of ours drawn at random, good ones and broken ones, with their particles as any code would write them."""

from __future__ import annotations

import itertools
import random
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from solvers.judging.frames import Frame
from solvers.judging.ours import framed
from solvers.running.run import run
from solvers.scene.scene import Scene
from solvers.solver.checked import as_large_as_itself
from solvers.solver.snapshot import Snapshot
from solvers.solver.soundness import LOST, MOST_ERROR, OK, UNSTABLE, findings
from tests.verdict_search import FINE, RANGES, SWITCHES, Numbers, scene_of

MOMENTS = 24  # of a run that are written, about
CLOSE = 0.5  # of the distance of particles: farther off, their order says nothing
SMALL = 0.5  # of the quantity itself
#: From which part on of the logarithm of a range, and up to which, a number is drawn: all of it, what is to break a run
#: and what is to spare it.
PARTS: tuple[dict[str, tuple[float, float]], ...] = (
    {}, {"amplitude": (0.75, 1.0), "cells": (0.0, 0.6), "cfl": (0.5, 1.0), "periods": (0.6, 1.0)},
    {"cells": (0.6, 1.0), "ppc": (0.5, 1.0), "cfl": (0.3, 0.7), "periods": (0.0, 0.7), "frequency": (0.0, 0.5)})
Arrays = dict[str, np.ndarray]


@dataclass(frozen=True)
class KnownRun:
    """A run with the largest errors of x (in amplitudes), v and the stress (in their own RMS), the lab's status, the
    kinds of evidence for it, and the particles at moments that an outsider would have."""

    scene: Scene
    errors: dict[str, float]
    status: str
    kinds: tuple[str, ...]
    named: tuple[str, ...]  # quantities as wrong as they are large
    particles: Arrays

    @property
    def good(self) -> bool:
        """Whether all errors are small: of x beside the motion and the distance of particles, of v and the stress
        beside themselves."""
        apart = self.scene.spacing / self.scene.ppc
        return self.status == OK and self.errors["x"] * self.scene.motion_amplitude < min(
            FINE * self.scene.motion_amplitude, CLOSE * apart) and max(self.errors["v"], self.errors["sigma"]) < SMALL

    @property
    def label(self) -> str:
        """What became of it, by the first of its kinds."""
        if self.status == UNSTABLE:
            return UNSTABLE
        if self.status == LOST or self.errors["x"] > MOST_ERROR:
            return next((kind for kind in ORDER if kind in self.kinds), "error_x")
        return "good" if self.good else "v or stress wrong" if self.named else "between"  # no small errors, nor large


#: Kinds of evidence, what is within the particles first.
ORDER = ("neighbour_gap", "displacement_mismatch", "out_of_shape", "mean_drift", "balance_gap")


class _Kept:
    """Moments of a run, about evenly spread, however many there will be."""

    def __init__(self, scene: Scene):
        self._scene, self._every, self._seen = scene, 1, 0
        self.frames: list[Frame] = []

    def keep(self, shot: Snapshot) -> None:
        finite = all(np.isfinite(v).all() for v in (shot.position, shot.velocity, shot.deformation_gradient))
        if finite and self._seen % self._every == 0:
            self.frames.append(framed(shot, self._scene))
        self._seen += 1
        if len(self.frames) >= 2 * MOMENTS:
            self.frames, self._every = self.frames[::2], 2 * self._every


def known(scene: Scene) -> KnownRun | None:
    """Run a scene; None where it left fewer than two moments."""
    kept = _Kept(scene)
    result = run(scene, prices=False, mid_run=False, on_sample=kept.keep)
    series = result.series
    with np.errstate(all="ignore"):
        errors = {"x": float(np.nanmax(series["error_x"])) / scene.motion_amplitude,
                  **{q: float(np.nanmax(series[f"error_{q}"])) / scene.rms_of(q) for q in ("v", "sigma")}}
    frames = kept.frames
    last = framed(result.final, scene)
    if not frames or last.time > frames[-1].time:  # of a run gone bad, too: a code stops with something
        frames.append(last)
    if len(frames) < 2:
        return None
    unseen = {name: np.full_like(values, np.nan) if name.startswith("error_") else values
              for name, values in series.items()}
    kinds = tuple(sorted(findings(replace(scene, effects=("soundness",)), unseen)))
    particles = {"t": np.array([f.time for f in frames]), "id": np.arange(len(frames[0].number)),
                 "X": frames[0].material_position,
                 **{name: np.stack([getattr(f, key) for f in frames])
                    for name, key in (("x", "position"), ("v", "velocity"), ("F", "deformation_gradient"))}}
    return KnownRun(scene, errors, result.status, kinds, tuple(sorted(as_large_as_itself(scene, series))), particles)


def numbers(problem: str, parts: Mapping[str, tuple[float, float]], chance: random.Random) -> Numbers:
    """Numbers of a scene, each from its part of the range."""
    return {name: low * (high / low) ** chance.uniform(*parts.get(name, (0.0, 1.0)))
            for name, (low, high) in RANGES[problem].items()}


def known_runs(problem: str, seed: int) -> Iterator[KnownRun]:
    """Runs of a problem without end, the same for the same seed: every third one is likely to break."""
    chance = random.Random(f"check {seed} {problem}")
    for turn in itertools.count():
        inputs = numbers(problem, PARTS[turn % len(PARTS)], chance)
        scene = scene_of(problem, chance.choice(SWITCHES[problem]), inputs)
        if scene and (found := known(scene)):
            yield found
