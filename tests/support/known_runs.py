"""Runs of ours drawn at random, good ones and broken ones: what they are worth, what the lab says of them with the
truth and without, and their particles as any code would write them."""

from __future__ import annotations

import itertools
import random
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from solvers.judging.particle_data_types import Frame
from solvers.judging.reference_runs import frame_of_snapshot
from solvers.problems import PROBLEMS
from solvers.running.run import run
from solvers.scene.scene import Scene
from solvers.scene.stabilisations import CENTRED, COUPLED, FILTER, FROZEN
from solvers.scene.validation import SceneError
from solvers.solver.particle_snapshot import Snapshot
from solvers.solver.soundness import LOST, LOST_FROM, OK, UNSTABLE, findings
from solvers.solver.verdict_basis import large_errors

FINE = 0.1  # amplitudes: a run whose error of x never exceeds it, nor v and sigma themselves, must not be called lost
BETWEEN = 1.2  # looks are 20 a period: between two of them an error may be larger than at either
MOST_WORK, MOST_STEPS = 3e5, 8000  # of a scene: particles and nodes times steps, and steps
MOMENTS = 24  # of a run that are written, about
CLOSE = 0.5  # of the distance of particles: farther off, their order says nothing
SMALL = 0.5  # of the quantity itself
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
    "square": ({"method": "mpm"}, {"method": "ugimp"}, {"method": "cpgimp"}, {"method": "cpdi"},
               {"method": "ugimp", "remedies": (FILTER, COUPLED)}, {"method": "mpm", "velocity": "particle"},
               {"method": "cpdi", "remedies": (FROZEN,)}),
}
#: Of each number the range it is drawn from, by its logarithm.
RANGES: dict[str, dict[str, tuple[float, float]]] = {
    "bar": {"cells": (4, 250), "ppc": (1, 8), "amplitude": (1e-4, 0.158), "cfl": (0.03, 0.6), "periods": (0.05, 40)},
    "ring": {"cells": (8, 40), "ppc": (1, 4), "amplitude": (1e-3, 0.384), "cfl": (0.03, 0.5), "periods": (0.05, 3)},
    "vortex": {"cells": (12, 40), "ppc": (1, 4), "amplitude": (1e-3, 1.57), "cfl": (0.03, 0.5), "periods": (0.05, 2),
               "frequency": (0.03, 6.0)},
    "square": {"cells": (8, 40), "ppc": (1, 4), "amplitude": (1e-3, 0.149), "cfl": (0.03, 0.5), "periods": (0.05, 3)},
}
#: From which part on of the logarithm of a range, and up to which, a number is drawn: all of it, what is to break a run
#: and what is to spare it.
PARTS: tuple[dict[str, tuple[float, float]], ...] = (
    {}, {"amplitude": (0.75, 1.0), "cells": (0.0, 0.6), "cfl": (0.5, 1.0), "periods": (0.6, 1.0)},
    {"cells": (0.6, 1.0), "ppc": (0.5, 1.0), "cfl": (0.3, 0.7), "periods": (0.0, 0.7), "frequency": (0.0, 0.5)})
Numbers = dict[str, float]


@dataclass(frozen=True)
class KnownRun:
    """A run with the largest errors of x (in amplitudes), v and the stress (in their own RMS), the lab's status, the
    kinds of evidence for it without the truth, and the particles at moments that an outsider would have."""

    scene: Scene
    errors: dict[str, float]
    status: str
    kinds: tuple[str, ...]
    named: tuple[str, ...]  # quantities as wrong as they are large
    particles: dict[str, np.ndarray]

    @property
    def blind(self) -> str:
        """The status without the truth."""
        return UNSTABLE if self.status == UNSTABLE else LOST if self.kinds else OK

    @property
    def missed(self) -> bool:
        """Whether it is off by more than half the motion, and nothing says so without the truth."""
        return self.blind == OK and self.errors["x"] > BETWEEN * LOST_FROM

    @property
    def false_alarm(self) -> bool:
        """Whether it is lost without the truth, and fine with it."""
        fine = self.errors["x"] < FINE and not self.named and self.status != UNSTABLE
        return self.blind == LOST and fine

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
        if self.status == LOST or self.errors["x"] > LOST_FROM:
            return next((kind for kind in ORDER if kind in self.kinds), "error_x")
        return "good" if self.good else "v or stress wrong" if self.named else "between"  # no small errors, nor large


#: Kinds of evidence, what is within the particles first.
ORDER = ("neighbour_gap", "displacement_mismatch", "out_of_shape", "mean_drift", "balance_gap")


class _SampledFrames:
    """Moments of a run, about evenly spread, however many there will be."""

    def __init__(self, scene: Scene):
        self._scene, self._every, self._seen = scene, 1, 0
        self.frames: list[Frame] = []

    def keep(self, shot: Snapshot) -> None:
        finite = all(np.isfinite(v).all() for v in (shot.position, shot.velocity, shot.deformation_gradient))
        if finite and self._seen % self._every == 0:
            self.frames.append(frame_of_snapshot(shot, self._scene))
        self._seen += 1
        if len(self.frames) >= 2 * MOMENTS:
            self.frames, self._every = self.frames[::2], 2 * self._every


def judge_known_run(scene: Scene) -> KnownRun:
    """Run a scene, and judge it again without the truth."""
    kept = _SampledFrames(scene)
    result = run(scene, prices=False, mid_run=False, on_sample=kept.keep)
    series, frames = result.series, kept.frames
    with np.errstate(all="ignore"):
        errors = {"x": float(np.nanmax(series["error_x"])) / scene.motion_amplitude,
                  **{q: float(np.nanmax(series[f"error_{q}"])) / scene.rms_of(q) for q in ("v", "sigma")}}
    last = frame_of_snapshot(result.final, scene)
    if not frames or last.time > frames[-1].time:  # of a run gone bad, too: a code stops with something
        frames.append(last)
    unseen = {name: np.full_like(values, np.nan) if name.startswith("error_") else values
              for name, values in series.items()}
    kinds = tuple(sorted(findings(replace(scene, effects=("soundness",)), unseen)))
    particles = {"t": np.array([f.time for f in frames]), "id": np.arange(len(frames[0].number)),
                 "X": frames[0].material_position,
                 **{name: np.stack([getattr(f, key) for f in frames])
                    for name, key in (("x", "position"), ("v", "velocity"), ("F", "deformation_gradient"))}}
    return KnownRun(scene, errors, result.status, kinds, tuple(sorted(large_errors(scene, series))), particles)


def draw_numbers(problem: str, parts: Mapping[str, tuple[float, float]], chance: random.Random) -> Numbers:
    """Numbers of a scene, each from its part of the range."""
    return {name: low * (high / low) ** chance.uniform(*parts.get(name, (0.0, 1.0)))
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


def random_runs(problem: str, count: int, chance: random.Random,
                switches: Sequence[Mapping[str, Any]] = ()) -> list[KnownRun]:
    """So many runs of random scenes, with some of the ``switches`` or any."""
    found: list[KnownRun] = []
    while len(found) < count:
        if scene := scene_of(problem, chance.choice(switches or SWITCHES[problem]), draw_numbers(problem, {}, chance)):
            found.append(judge_known_run(scene))
    return found


def known_runs(problem: str, seed: int) -> Iterator[KnownRun]:
    """Runs of a problem without end, the same for the same seed, of two moments at least: every third one is likely to
    break."""
    chance = random.Random(f"check {seed} {problem}")
    for turn in itertools.count():
        inputs = draw_numbers(problem, PARTS[turn % len(PARTS)], chance)
        scene = scene_of(problem, chance.choice(SWITCHES[problem]), inputs)
        if scene and len((found := judge_known_run(scene)).particles["t"]) > 1:
            yield found
