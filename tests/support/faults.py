"""Runs of ours in whose files something is wrong: what a judge is to see, and what it cannot."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from solvers.judging import problem_handout
from solvers.judging.particle_data_types import Frame
from solvers.judging.reference_runs import frame_of_snapshot
from solvers.problems import PROBLEMS
from solvers.running.run import build
from solvers.scene.scene import Scene

BASES: Mapping[str, Mapping[str, Any]] = {
    "bar": {"periods": 1.0}, "ring": {"periods": 1.0}, "vortex": {"amplitude": 0.25, "cells": 36, "periods": 0.5}}
FRAMES = {"bar": 40, "ring": 40, "vortex": 16, "square": 40}  # of a run, about
KEYS = {"X": "material_position", "x": "position", "v": "velocity", "F": "deformation_gradient", "sigma": "stress"}


def scene_of(problem: str, **changed: Any) -> Scene:
    return PROBLEMS[problem].scene(estimators=(), effects=(), **{**BASES[problem], **changed})


@dataclass(frozen=True)
class RecordedRun:
    """A run of ours, every step of it."""

    scene: Scene
    frames: Sequence[Frame]

    @property
    def chosen(self) -> range:
        """The steps that go into files, none of them the first two."""
        every = max(1, len(self.frames) // FRAMES[self.scene.problem])
        return range(max(2, every), len(self.frames), every)


def record(scene: Scene, begin: Callable[[Any], None] = lambda solver: None) -> RecordedRun:
    solver = build(scene)
    solver.compile()
    begin(solver)
    frames = [frame_of_snapshot(solver.snapshot(), scene)]
    while solver.step < scene.steps and solver.sound:
        solver.advance(1)
        frames.append(frame_of_snapshot(solver.snapshot(), scene))
    return RecordedRun(scene, frames)


Files = dict[str, np.ndarray]
Alteration = Callable[[RecordedRun], Files]


def files(run: RecordedRun, stress: bool = False, before: int = 0) -> Files:
    """The chosen frames as arrays, or those so many steps ``before`` them."""
    return as_files(run.scene, [run.frames[k - before] for k in run.chosen], stress)


def as_files(scene: Scene, frames: Sequence[Frame], stress: bool = False) -> Files:
    """Frames as arrays (T, P, ...), with the stress where they have it or it is asked for."""
    law = PROBLEMS[scene.problem].reference.stress
    if stress:
        frames = [f if f.stress is not None else replace(f, stress=law(scene, f.deformation_gradient)) for f in frames]
    arrays = {"t": np.array([f.time for f in frames]), "cells": np.array(scene.cells), "X": frames[0].material_position}
    return arrays | {key: np.stack([getattr(f, KEYS[key]) for f in frames])
                     for key in ("x", "v", "F", "sigma") if getattr(frames[0], KEYS[key]) is not None}


def rounded(arrays: Files, figures: int) -> Files:
    """To so many figures, as a .csv has them."""
    def cut(values: np.ndarray) -> np.ndarray:
        with np.errstate(divide="ignore", invalid="ignore"):
            power = 10.0 ** (figures - 1 - np.floor(np.log10(np.abs(values))))
            return np.where(values == 0, 0.0, np.round(values * power) / power)

    # through text: only then are the numbers those that so many figures have
    return {key: np.array([float(f"{v:.{figures - 1}e}") for v in cut(values).ravel().tolist()]).reshape(values.shape)
            if key in KEYS else values for key, values in arrays.items()}


def single(arrays: Files) -> Files:
    return {key: values.astype(np.float32).astype(float) if key in KEYS else values for key, values in arrays.items()}


def moving_particle(run: RecordedRun) -> int:
    """A particle in the thick of it, where x moves and F is not 1."""
    reference, last = PROBLEMS[run.scene.problem].reference, run.frames[-1]
    X = last.material_position
    t = 0.3 * run.scene.period
    u, F = reference.displacement(run.scene, X, t), reference.deformation_gradient(run.scene, X, t)
    moved, strained = (np.sqrt(np.sum(values.reshape(len(X), -1)**2, axis=1)) for values in (u, F - np.eye(X.shape[1])))
    return int(np.argmax(np.minimum(moved / moved.max(), strained / strained.max())))


def change_arrays(**new: Callable[[RecordedRun, Files], np.ndarray]) -> Alteration:
    """Some of the arrays made anew, from the run and all arrays."""
    def altered(run: RecordedRun) -> Files:
        arrays = files(run)
        return arrays | {key: make(run, arrays) for key, make in new.items()}
    return altered


def change_particle(key: str, value: Callable[[Files, int], Any]) -> Alteration:
    """One particle's quantity, the same at all times."""
    def make(run: RecordedRun, arrays: Files) -> np.ndarray:
        p, values = moving_particle(run), arrays[key].copy()
        values[:, p] = value(arrays, p)
        return values
    return change_arrays(**{key: make})


def permute(key: str, seed: int) -> Callable[[RecordedRun, Files], np.ndarray]:
    return lambda run, a: a[key][:, np.random.default_rng(seed).permutation(len(a["X"]))]


def add_drift(share: float) -> Alteration:
    def make(run: RecordedRun, a: Files) -> np.ndarray:
        aside = np.eye(a["x"].shape[-1])[0]
        return a["x"] + share * run.scene.size_of("x") * a["t"][:, None, None] / run.frames[-1].time * aside
    return change_arrays(x=make)


def swap(next_to: bool) -> Alteration:
    def make(run: RecordedRun, a: Files) -> np.ndarray:
        p, order = moving_particle(run), np.arange(len(a["X"]))
        far = np.linalg.norm(a["X"] - a["X"][p], axis=1)
        q = int(np.argsort(far)[1 if next_to else len(far) // 2])
        order[[p, q]] = q, p
        return a["x"][:, order]
    return change_arrays(x=make)


def drop_particles(kept: Callable[[int], np.ndarray], ids: bool = False) -> Alteration:
    def altered(run: RecordedRun) -> Files:
        arrays = files(run)
        chosen = kept(len(arrays["X"]))
        arrays = {key: values if key in ("t", "cells") else values[chosen] if key == "X" else values[:, chosen]
                  for key, values in arrays.items()}
        if ids:
            del arrays["X"]
            arrays["id"] = chosen
        return arrays
    return altered


def drop_three_neighbours(run: RecordedRun) -> Files:
    """Three neighbours missing at all times, with the masses of the others in the file."""
    arrays = files(run)
    X, masses = arrays["X"], problem_handout.particle_masses(run.scene)
    chosen = np.argsort(np.linalg.norm(X - X[moving_particle(run)], axis=1))[3:]
    arrays |= {key: arrays[key][:, chosen] for key in ("x", "v", "F")}
    return arrays | {"X": X[chosen], "mass": np.tile(masses[chosen], (len(arrays["t"]), 1))}


def random_share(share: float) -> Callable[[int], np.ndarray]:
    return lambda count: np.sort(np.random.default_rng(3).choice(count, round(share * count), replace=False))


def other_inputs(stress: bool = False, by: Mapping[str, float] | None = None, **inputs: float) -> Alteration:
    """A run with other numbers in its scene, some ``by`` a factor, judged as if it had its own."""
    def altered(run: RecordedRun) -> Files:
        scaled = {name: factor * getattr(run.scene, name) for name, factor in (by or {}).items()}
        return files(record(replace(run.scene, **scaled, **inputs)), stress)
    return altered


def double_one_mass(told: bool) -> Alteration:
    def altered(run: RecordedRun) -> Files:
        def begin(solver: Any) -> None:
            solver._arrays.mass[moving_particle(run)] *= 2
            masses.append(np.array(solver._arrays.mass))

        masses: list[np.ndarray] = []
        arrays = files(record(run.scene, begin))
        return arrays | ({"mass": np.tile(masses[0], (len(arrays["t"]), 1))} if told else {})
    return altered


def delay_stress(run: RecordedRun, arrays: Files) -> np.ndarray:
    law = PROBLEMS[run.scene.problem].reference.stress
    return np.stack([law(run.scene, F) for F in files(run, before=1)["F"]])


PLANE, VORTEX = ("ring", "vortex"), ("vortex",)
ALL = ("bar", "ring", "vortex")
#: What is done to the files, of which problems, and what makes them.
ALTERATIONS: dict[str, tuple[tuple[str, ...], Alteration]] = {
    "nothing": (ALL, files),
    "nothing; stress too": (ALL, lambda run: files(run, stress=True)),
    "nothing; stress too, single precision": (ALL, lambda run: single(files(run, stress=True))),
    "nothing; stress too, seven figures": (ALL, lambda run: rounded(files(run, stress=True), 7)),
    "v half a step late": (ALL, change_arrays(v=lambda run, a: 0.5 * (a["v"] + files(run, before=1)["v"]))),
    "F a step late": (ALL, change_arrays(F=lambda run, a: files(run, before=1)["F"])),
    "stress a step late beside F": (ALL, change_arrays(sigma=delay_stress)),
    "x shuffled": (ALL, change_arrays(x=permute("x", 1))),
    "ids permuted, the same at all times": (ALL, change_arrays(**{key: permute(key, 2) for key in ("x", "v", "F")})),
    "x is the displacement": (ALL, change_arrays(x=lambda run, a: a["x"] - a["X"])),
    "x in mm": (ALL, change_arrays(x=lambda run, a: 1000 * a["x"])),
    "x and X in mm": (ALL, change_arrays(x=lambda run, a: 1000 * a["x"], X=lambda run, a: 1000 * a["X"])),
    "two particles swapped": (ALL, swap(False)),
    "two neighbours swapped": (ALL, swap(True)),
    "density 1.02 times": (ALL, other_inputs(by={"density": 1.02})),
    "E 1.01 times": (ALL, other_inputs(by={"modulus": 1.01})),
    "E 1.01 times, its stress too": (ALL, other_inputs(True, by={"modulus": 1.01})),
    "Poisson's ratio 0.25 for 0.3": (VORTEX, other_inputs(poisson_ratio=0.25)),
    "Poisson's ratio 0.25, its stress too": (VORTEX, other_inputs(True, poisson_ratio=0.25)),
    "Poisson's ratio 0 for 0.3": (VORTEX, other_inputs(poisson_ratio=0.0)),
    "one mass doubled": (PLANE, double_one_mass(False)),
    "one mass doubled, masses in the file": (PLANE, double_one_mass(True)),
    "one particle stuck": (ALL, change_particle("x", lambda a, p: a["X"][p])),
    "one particle with v = 0": (ALL, change_particle("v", lambda a, p: 0.0)),
    "one particle with F = 1": (ALL, change_particle("F", lambda a, p: np.eye(a["X"].shape[1]))),
    "x drifts by 1e-3 of the motion": (ALL, add_drift(1e-3)),
    "x drifts by 1e-2 of the motion": (ALL, add_drift(1e-2)),
    "a tenth missing, with ids": (ALL, drop_particles(random_share(0.9), ids=True)),
    "every second missing, without ids": (ALL, drop_particles(lambda count: np.arange(0, count, 2))),
    "half missing by chance, without ids": (ALL, drop_particles(random_share(0.5))),
    "three neighbours missing, masses in the file": (ALL, drop_three_neighbours),
    "F transposed": (PLANE, change_arrays(F=lambda run, a: np.swapaxes(a["F"], -1, -2))),
    "times 1 % too long": (ALL, change_arrays(t=lambda run, a: 1.01 * a["t"])),
    "x and y of positions exchanged": (PLANE, change_arrays(x=lambda run, a: a["x"][..., ::-1])),
    "x and y of everything exchanged": (VORTEX, change_arrays(
        **{key: lambda run, a, key=key: a[key][..., ::-1] for key in ("X", "x", "v")},
        F=lambda run, a: a["F"][..., ::-1, ::-1]))}
