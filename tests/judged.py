"""What the judge says of runs of ours, sound ones and such in whose files something is wrong.

``uv run python -m tests.judged`` writes ``assets/judge.md``: each alteration of each problem, with what the errors come
to and what the judge says, and how many runs drawn at random, in three forms, it says anything of.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import islice
from typing import Any

import numpy as np

from solvers.judging.columns import from_arrays
from solvers.judging.measure import Companions, summarised
from solvers.judging.ours import framed
from solvers.judging.placing import placed
from solvers.judging.verdict import GridJudgement
from solvers.problems import PROBLEMS
from solvers.running.run import build
from solvers.scene.rules import SceneError
from solvers.scene.scene import Scene
from solvers.study.markdown import grid
from tests.altered import ALL, ALTERATIONS, FRAMES, Files, files, given, rounded, scene_of, single, stepped
from tests.paths import ROOT

SEED, DRAWN = 27, 60
CELLS = {"bar": (0.9, 2.0), "ring": (0.9, 1.5), "vortex": (1.1, 1.55)}  # powers of ten
LARGEST = {"bar": 0.1, "ring": 0.1, "vortex": 1.2}  # amplitudes
HEAD = """# What the judge notices

Back to the [README](../README.md). Written by `python -m tests.judged`. Each line is a run of ours, the bar of 40 cells
(uGIMP), the ring of 24 (CPDI) and the vortex of 36 (CPDI, 0.25 rad), some 40 times of it (16 of the vortex), in whose
files something is wrong: how many times as large it makes the largest errors of x, v and σ, and what the judge says.
*Nothing* is the right answer to the first four lines of each problem. Elsewhere it means that this cannot be told
beside the error of the method itself, of the vortex here 6 % of the motion; the report's list of what was compared says
so, with the tolerance.

"""


@dataclass(frozen=True)
class Said:
    """What the judge makes of files: the largest errors, what it says, and of how many particles that they are not
    where their neighbours are."""

    errors: dict[str, float]
    notes: tuple[str, ...]
    by_themselves: int


def said(scene: Scene, arrays: Files) -> Said:
    found = judgement(scene, arrays)
    found.check()
    errors = summarised(found.grid.times, found.norms)
    return Said({q: errors[q]["max"] or np.nan for q in errors}, tuple(found.notes()),
                len(found.apart.which) if found.apart else 0)


def judgement(scene: Scene, arrays: Files) -> GridJudgement:
    """What is known of files; the companion is not asked, for it takes longest and the truth is known."""
    settled, [found] = placed([from_arrays("files", arrays)], replace(scene, cells=type(scene)().cells), [], [])
    own = replace(settled, cells=found.cells)
    return GridJudgement(own, found, Companions(own, tuple(found.times.tolist())))


def drawn(seed: int) -> Iterator[Scene]:
    """Scenes without end, the same for the same seed: methods, layouts and all numbers at random."""
    chance = random.Random(seed)
    while True:
        problem = chance.choice(ALL)
        kind = PROBLEMS[problem].scene
        inputs: dict[str, Any] = {
            "method": chance.choice(kind.choices("method")), "ppc": chance.randint(1, 5),
            "cells": round(10 ** chance.uniform(*CELLS[problem])),
            "cfl": 10 ** chance.uniform(-1.7, -0.4), "periods": 10 ** chance.uniform(-0.8, 0.3 * (problem != "vortex")),
            "amplitude": LARGEST[problem] * 10 ** chance.uniform(-3, 0),
            "velocity": "particle" if chance.random() < 0.15 else "grid"}
        if problem != "bar":
            inputs["layout"] = chance.choice(("polar", "polar", "cartesian"))
        try:
            scene = kind(**inputs, estimators=(), effects=())
        except SceneError:
            continue
        if 4 <= scene.steps and scene.steps * scene.particles < 1_000_000:
            yield scene


def honest(scene: Scene) -> Files | None:
    """The particles of a run; None where it did not come to its end."""
    solver = build(scene)
    solver.compile()
    frames = []
    every = max(1, scene.steps // FRAMES[scene.problem])
    while solver.step < scene.steps and solver.sound:
        solver.advance(min(every, scene.steps - solver.step))
        frames.append(framed(solver.snapshot(), scene))
    if not solver.sound:
        return None
    law = PROBLEMS[scene.problem].reference.stress
    return {"t": np.array([f.time for f in frames]), "cells": np.array(scene.cells), "X": frames[0].material_position,
            "x": np.stack([f.position for f in frames]), "v": np.stack([given(f.velocity) for f in frames]),
            "F": np.stack([given(f.deformation_gradient) for f in frames]),
            "sigma": np.stack([law(scene, given(f.deformation_gradient)) for f in frames])}


FORMS: dict[str, Callable[[Files], Files]] = {
    "double precision": lambda arrays: arrays, "single precision": single, "seven figures": lambda a: rounded(a, 7)}


def main() -> None:
    rows = []
    for problem in ALL:
        run = stepped(scene_of(problem))
        plain = said(run.scene, files(run))
        for name, (problems, altered) in ALTERATIONS.items():
            if problem in problems:
                found = said(run.scene, altered(run))
                over = {q: found.errors[q] / plain.errors[q] for q in found.errors}
                seen = [*found.notes, *([f"{found.by_themselves} not where the neighbours are"]
                                        if found.by_themselves else [])]
                rows.append([problem, name, *(f"{over[q]:.3g}" for q in over), "; ".join(seen) or "nothing"])
                print(" | ".join(rows[-1]), flush=True)
    wrong, sound = dict.fromkeys(FORMS, 0), 0
    for scene in islice(drawn(SEED), DRAWN):
        arrays = honest(scene)
        sound += arrays is not None
        for form, made in FORMS.items():
            if arrays is not None and ((found := said(scene, made(arrays))).notes or found.by_themselves):
                wrong[form] += 1
                print(scene, form, found, flush=True)
    tail = ", ".join(f"{count} in {form}" for form, count in wrong.items())
    (ROOT / "assets" / "judge.md").write_text(
        HEAD + grid(["problem", "what is wrong", "x", "v", "σ", "said"], rows, ("problem", "what is wrong", "said"))
        + f"\n\n{sound} sound runs drawn at random (methods, layouts, cells, steps, amplitudes), with F and the "
          f"stress, of which something is said: {tail}.\n", encoding="utf-8")


if __name__ == "__main__":
    main()
