"""Runs of ours in whose files something is wrong: what a judge is to see, and what it cannot."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from solvers.judging.frames import Frame
from solvers.judging.ours import framed
from solvers.problems import PROBLEMS
from solvers.running.run import build
from solvers.scene.scene import Scene

BASES: Mapping[str, Mapping[str, Any]] = {
    "bar": {"periods": 1.0}, "ring": {"periods": 1.0}, "vortex": {"amplitude": 0.25, "cells": 36, "periods": 0.5}}
FRAMES = {"bar": 40, "ring": 40, "vortex": 16}  # of a run, about
KEYS = {"X": "material_position", "x": "position", "v": "velocity", "F": "deformation_gradient", "sigma": "stress"}


def scene_of(problem: str, **changed: Any) -> Scene:
    return PROBLEMS[problem].scene(estimators=(), effects=(), **{**BASES[problem], **changed})


@dataclass(frozen=True)
class Steps:
    """A run of ours, every step of it."""

    scene: Scene
    frames: Sequence[Frame]

    @property
    def chosen(self) -> range:
        """The steps that go into files, none of them the first two."""
        every = max(1, len(self.frames) // FRAMES[self.scene.problem])
        return range(max(2, every), len(self.frames), every)


def stepped(scene: Scene, begin: Callable[[Any], None] = lambda solver: None) -> Steps:
    solver = build(scene)
    solver.compile()
    begin(solver)
    frames = [framed(solver.snapshot(), scene)]
    while solver.step < scene.steps and solver.sound:
        solver.advance(1)
        frames.append(framed(solver.snapshot(), scene))
    return Steps(scene, frames)


Files = dict[str, np.ndarray]
Alteration = Callable[[Steps], Files]


def files(run: Steps, change: Callable[[Frame, Frame, int], Frame] = lambda frame, before, k: frame,
          stress: bool = False, **names: str) -> Files:
    """Frames as arrays (T, P, ...), each changed, knowing the one a step before; with the stress where it is asked
    for, or that of a frame a step before."""
    law = PROBLEMS[run.scene.problem].reference.stress
    kept = [change(run.frames[k], run.frames[k - 1], k) for k in run.chosen]
    if stress:
        kept = [f if f.stress is not None else replace(f, stress=law(run.scene, given(f.deformation_gradient)))
                for f in kept]
    arrays = {"t": np.array([f.time for f in kept]), "cells": np.array(run.scene.cells),
              "X": kept[0].material_position}
    return arrays | {key: np.stack([getattr(f, KEYS[key]) for f in kept])
                     for key in ("x", "v", "F", "sigma") if getattr(kept[0], KEYS[key]) is not None}


def given(values: np.ndarray | None) -> np.ndarray:
    assert values is not None
    return values


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


def someone(run: Steps) -> int:
    """A particle in the thick of it, where x moves and F is not 1."""
    reference, last = PROBLEMS[run.scene.problem].reference, run.frames[-1]
    X = last.material_position
    t = 0.3 * run.scene.period
    u, F = reference.displacement(run.scene, X, t), reference.deformation_gradient(run.scene, X, t)
    moved, strained = (np.sqrt(np.sum(values.reshape(len(X), -1)**2, axis=1)) for values in (u, F - np.eye(X.shape[1])))
    return int(np.argmax(np.minimum(moved / moved.max(), strained / strained.max())))


def put(values: np.ndarray | None, p: int, new: Any) -> np.ndarray:
    out = given(values).copy()
    out[p] = new
    return out


def _drift(share: float) -> Alteration:
    def altered(run: Steps) -> Files:
        end, far = run.frames[-1].time, share * run.scene.size_of("x")
        aside = np.eye(run.frames[0].position.shape[1])[0]
        return files(run, lambda f, b, k: replace(f, position=f.position + far * f.time / end * aside))
    return altered


def _swapped(next_to: bool) -> Alteration:
    def altered(run: Steps) -> Files:
        p, X = someone(run), run.frames[0].material_position
        far = np.linalg.norm(X - X[p], axis=1)
        q = int(np.argsort(far)[1 if next_to else len(X) // 2])
        order = np.arange(len(X))
        order[[p, q]] = q, p
        return files(run, lambda f, b, k: replace(f, position=f.position[order]))
    return altered


def _missing(kept: Callable[[np.ndarray], np.ndarray], ids: bool = False) -> Alteration:
    def altered(run: Steps) -> Files:
        arrays = files(run)
        chosen = kept(arrays["X"])
        arrays = {key: values if key in ("t", "cells") else values[chosen] if key == "X" else values[:, chosen]
                  for key, values in arrays.items()}
        if ids:
            del arrays["X"]
            arrays["id"] = chosen
        return arrays
    return altered


def _of_another(**changed: float) -> Alteration:
    """A run with another number in its scene, judged as if it had none."""
    def altered(run: Steps) -> Files:
        return files(stepped(replace(run.scene, **changed)))
    return altered


def _with_its_stress(**changed: float) -> Alteration:
    def altered(run: Steps) -> Files:
        return files(stepped(replace(run.scene, **changed)), stress=True)
    return altered


def _one_mass_doubled(told: bool) -> Alteration:
    def altered(run: Steps) -> Files:
        p = someone(run)

        def begin(solver: Any) -> None:
            solver._arrays.mass[p] *= 2
            doubled.append(np.array(solver._arrays.mass))

        doubled: list[np.ndarray] = []
        arrays = files(stepped(run.scene, begin))
        return arrays | ({"mass": np.tile(doubled[0], (len(arrays["t"]), 1))} if told else {})
    return altered


def _half(X: np.ndarray) -> np.ndarray:
    return np.arange(0, len(X), 2)


def _any(share: float) -> Callable[[np.ndarray], np.ndarray]:
    return lambda X: np.sort(np.random.default_rng(3).choice(len(X), round(share * len(X)), replace=False))


def _late(run: Steps) -> Files:
    return files(run, lambda f, b, k: replace(f, velocity=0.5 * (given(f.velocity) + given(b.velocity))))


def _stress_late(run: Steps) -> Files:
    law = PROBLEMS[run.scene.problem].reference.stress
    return files(run, lambda f, b, k: replace(f, stress=law(run.scene, given(b.deformation_gradient))))


PLANE, VORTEX = ("ring", "vortex"), ("vortex",)
ALL = ("bar", "ring", "vortex")
#: What is done to the files, of which problems, and what makes them.
ALTERATIONS: dict[str, tuple[tuple[str, ...], Alteration]] = {
    "nothing": (ALL, files),
    "nothing; stress too": (ALL, lambda run: files(run, stress=True)),
    "nothing; stress too, single precision": (ALL, lambda run: single(files(run, stress=True))),
    "nothing; stress too, seven figures": (ALL, lambda run: rounded(files(run, stress=True), 7)),
    "v half a step late": (ALL, _late),
    "F a step late": (ALL, lambda run: files(run, lambda f, b, k: replace(
        f, deformation_gradient=b.deformation_gradient))),
    "stress a step late beside F": (ALL, _stress_late),
    "x shuffled": (ALL, lambda run: files(run, lambda f, b, k: replace(
        f, position=f.position[np.random.default_rng(1).permutation(len(f.position))]))),
    "ids permuted, the same at all times": (ALL, lambda run: (lambda a: a | {
        key: a[key][:, np.random.default_rng(2).permutation(len(a["X"]))] for key in ("x", "v", "F")})(files(run))),
    "x is the displacement": (ALL, lambda run: files(run, lambda f, b, k: replace(
        f, position=f.position - f.material_position))),
    "x in mm": (ALL, lambda run: files(run, lambda f, b, k: replace(f, position=1000 * f.position))),
    "x and X in mm": (ALL, lambda run: (lambda a: a | {key: 1000 * a[key] for key in ("X", "x")})(files(run))),
    "two particles swapped": (ALL, _swapped(False)),
    "two neighbours swapped": (ALL, _swapped(True)),
    "density 1.02 times": (ALL, lambda run: _of_another(density=1.02 * run.scene.density)(run)),
    "E 1.01 times": (ALL, lambda run: _of_another(modulus=1.01 * run.scene.modulus)(run)),
    "E 1.01 times, its stress too": (ALL, lambda run: _with_its_stress(modulus=1.01 * run.scene.modulus)(run)),
    "Poisson's ratio 0.25 for 0.3": (VORTEX, _of_another(poisson_ratio=0.25)),
    "Poisson's ratio 0.25, its stress too": (VORTEX, _with_its_stress(poisson_ratio=0.25)),
    "Poisson's ratio 0 for 0.3": (VORTEX, _of_another(poisson_ratio=0.0)),
    "one mass doubled": (PLANE, _one_mass_doubled(False)),
    "one mass doubled, masses in the file": (PLANE, _one_mass_doubled(True)),
    "one particle stuck": (ALL, lambda run: files(run, lambda f, b, k: replace(
        f, position=put(f.position, someone(run), f.material_position[someone(run)])))),
    "one particle with v = 0": (ALL, lambda run: files(run, lambda f, b, k: replace(
        f, velocity=put(f.velocity, someone(run), 0.0)))),
    "one particle with F = 1": (ALL, lambda run: files(run, lambda f, b, k: replace(
        f, deformation_gradient=put(f.deformation_gradient, someone(run), np.eye(f.position.shape[1]))))),
    "x drifts by 1e-3 of the motion": (ALL, _drift(1e-3)),
    "x drifts by 1e-2 of the motion": (ALL, _drift(1e-2)),
    "a tenth missing, with ids": (ALL, _missing(_any(0.9), ids=True)),
    "every second missing, without ids": (ALL, _missing(_half)),
    "half missing by chance, without ids": (ALL, _missing(_any(0.5))),
    "F transposed": (PLANE, lambda run: files(run, lambda f, b, k: replace(
        f, deformation_gradient=given(f.deformation_gradient).transpose(0, 2, 1)))),
    "times 1 % too long": (ALL, lambda run: (lambda a: a | {"t": 1.01 * a["t"]})(files(run))),
    "x and y of positions exchanged": (PLANE, lambda run: files(run, lambda f, b, k: replace(
        f, position=f.position[:, ::-1]))),
    "x and y of everything exchanged": (VORTEX, lambda run: (lambda a: a | {
        key: a[key][..., ::-1] for key in ("X", "x", "v")} | {"F": a["F"][..., ::-1, ::-1]})(files(run)))}
