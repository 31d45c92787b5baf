"""What the judge and the check say of runs of ours: sound ones, broken ones, and some whose files have been altered.

``python -m tests.findings`` writes ``assets/judge.md`` and ``assets/check.md``: each alteration of each problem, with
what the errors come to and what both say; how many sound runs drawn at random, in three forms, the judge says anything
of; and how many of others drawn at random the check finds, by what is wrong with them. ``--draw SEED`` prints the last
of another seed alone: the limits of the check were set on seeds 1 and 11 to 13.
"""

from __future__ import annotations

import argparse
import random
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import islice
from typing import Any

import numpy as np

from solvers.judging.check import CONSISTENT, check
from solvers.judging.column_names import table_from_arrays
from solvers.judging.error_norms import TwoMeshCompanion, summarise_norms
from solvers.judging.judgement import SingleGridJudgement
from solvers.judging.particle_scene_matching import match_files
from solvers.judging.reference_runs import frame_of_snapshot
from solvers.problems import PROBLEMS
from solvers.running.run import build
from solvers.scene.scene import Scene
from solvers.scene.validation import SceneError
from solvers.study.markdown_tables import markdown_table
from solvers.untrusted.quoting import FileError
from tests.support.faults import ALL, ALTERATIONS, FRAMES, Files, as_files, files, record, rounded, scene_of, single
from tests.support.faults_in_time import IN_TIME
from tests.support.foreign_forms import FORMS as FOREIGN
from tests.support.known_runs import KnownRun, known_runs
from tests.support.paths import ROOT

JUDGE_SEED, JUDGED = 27, 60
CHECK_SEED, CHECKED = 14, 300  # of each problem
CELLS = {"bar": (0.9, 2.0), "ring": (0.9, 1.5), "vortex": (1.1, 1.55)}  # powers of ten
LARGEST = {"bar": 0.1, "ring": 0.1, "vortex": 1.2}  # amplitudes
LABELS = {"good": "good", "between": "neither", "v or stress wrong": "x holds; v or the stress as wrong as it is large",
          "neighbour_gap": "lost: neighbours not where their deformation says",
          "displacement_mismatch": "lost: displacements do not add up", "mean_drift": "lost: the body has drifted",
          "out_of_shape": "lost: the ring is not round", "balance_gap": "lost: not the motion of the problem",
          "error_x": "lost: by the truth alone", "unstable": "unstable"}
FORMS_TEXT = """
## Whose files are read

Text (`.csv`, `.txt`, `.dat`, `.tsv`), `.npz`, VTK's `.vtk`, `.vtu` and `.vtp`, text and VTK's also packed as `.gz`;
`.pvd`, `.pvtu` and `.pvtp` with the files that they name; `.h5` where the package h5py is installed (`pip install
mpm-lab[hdf5]`). Names may have any case and separators, units (`x [mm]`, `time (ms)`, or in a line below), and
components as letters or counted from 0 or 1. Text may have decimal commas (between commas in quotes), arrays in cells
(`"[0.1, 0.2]"`), exponents and repeated numbers as Fortran writes them (`1.0D-03`, `3*0.0`). Columns that were not read
are named, and so is a cell that is no number, with its line and column. A row's particle is known by an id, from 0 or
1, by its material position or by its displacement. Parts of one moment in several files are joined. The plane of x and
z of a three-dimensional code is read with `--plane xz`. Each row of the table is a test that writes that form with our
numbers.

"""
LOST = tuple(label for label in LABELS if label not in ("good", "between", "v or stress wrong"))
FORMS: dict[str, Callable[[Files], Files]] = {
    "double precision": lambda arrays: arrays, "single precision": single, "seven figures": lambda a: rounded(a, 7)}


@dataclass(frozen=True)
class Judged:
    """What the judge makes of files: the largest errors, what it says, and of how many particles that they are not
    where their neighbours are."""

    errors: dict[str, float]
    notes: tuple[str, ...]
    by_themselves: int

    @property
    def told(self) -> str:
        alone = [f"{self.by_themselves} not where the neighbours are"] if self.by_themselves else []
        return "; ".join([*self.notes, *alone])


def judged(scene: Scene, arrays: Files) -> Judged:
    found = judgement(scene, arrays)
    found.check_coordinate_origin()
    errors = summarise_norms(found.grid.times, found.norms)
    return Judged({q: errors[q]["max"] or np.nan for q in errors}, tuple(found.notes()),
                  len(found.position_outliers.which) if found.position_outliers else 0)


def judgement(scene: Scene, arrays: Files) -> SingleGridJudgement:
    """What is known of files; the companion is not asked, for it takes longest and the truth is known."""
    settled, [found] = match_files([table_from_arrays("files", arrays)], replace(scene, cells=type(scene)().cells), [],
                                   [])
    own = replace(settled, cells=found.cells)
    return SingleGridJudgement(own, found, TwoMeshCompanion(own, tuple(found.times.tolist())))


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
    """The particles of a run, with the stress; None where it did not come to its end."""
    solver = build(scene)
    solver.compile()
    frames = []
    every = max(1, scene.steps // FRAMES[scene.problem])
    while solver.step < scene.steps and solver.sound:
        solver.advance(min(every, scene.steps - solver.step))
        frames.append(frame_of_snapshot(solver.snapshot(), scene))
    return as_files(scene, frames, stress=True) if solver.sound else None


def checked(particles: Mapping[str, Any]) -> tuple[str, list[str], str]:
    """Verdict, names and sentences of what the check finds in particles alone, knowing neither problem nor cells."""
    try:
        found = check({key: values for key, values in particles.items() if key != "cells"})
    except FileError as refused:
        return "refused", [], f"refused: {refused.sentence}"
    says = (
        f"{found.verdict}: {'; '.join(one.says for one in found.contradictions)}"
        if found.contradictions
        else found.verdict
    )
    return found.verdict, [one.name for one in found.contradictions], says


def altered() -> list[list[str]]:
    """A row for each alteration of each problem: what it makes of the errors, and what both say."""
    rows = []
    for problem in ALL:
        run = record(scene_of(problem))
        plain = judged(run.scene, files(run)).errors
        for name, (problems, change) in (ALTERATIONS | IN_TIME).items():
            if problem in problems:
                arrays = change(run)
                try:
                    found = judged(run.scene, arrays)
                    said = [*(f"{found.errors[q] / plain[q]:.3g}" for q in plain), found.told or "nothing"]
                except FileError as refused:
                    said = ["", "", "", f"refused: {refused.sentence}"]
                rows.append([problem, name, *said, checked(arrays)[2]])
                print(" | ".join(rows[-1]), flush=True)
    return rows


def false_alarms() -> str:
    """Of how many sound runs the judge says something."""
    runs = [(scene, arrays) for scene in islice(drawn(JUDGE_SEED), JUDGED) if (arrays := honest(scene)) is not None]
    count = {form: sum(bool(judged(scene, made(arrays)).told) for scene, arrays in runs)
             for form, made in FORMS.items()}
    return (f"{len(runs)} sound runs drawn at random (methods, layouts, cells, steps, amplitudes), with F and the "
            f"stress, of which something is said: {', '.join(f'{n} in {form}' for form, n in count.items())}.")


def random_runs(seed: int) -> tuple[str, str]:
    """How many runs of each problem and kind there were and were found, and what found the lost and unstable ones."""
    every: dict[str, list[tuple[KnownRun, str, list[str]]]] = {}
    for problem in ALL:
        every[problem] = [(run, *checked(run.particles)[:2]) for run in islice(known_runs(problem, seed), CHECKED)]
        for run, verdict, names in every[problem]:
            if run.good and verdict != CONSISTENT:
                print(f"false alarm: {run.scene}, {verdict} by {', '.join(names)}")
    rows = []
    for label, words in LABELS.items():
        verdicts = [[verdict for run, verdict, _ in found if run.label == label] for found in every.values()]
        rows.append([words, *(f"{sum(one != CONSISTENT for one in some)} of {len(some)}" if some else "none drawn"
                              for some in verdicts)])
    counts = {problem: Counter(name for run, _, names in found if run.label in LOST for name in set(names))
              for problem, found in every.items()}
    names = sorted(set().union(*counts.values()), key=lambda name: -sum(count[name] for count in counts.values()))
    return (markdown_table(["runs", *every], rows, ("runs",)),
            markdown_table(["finding", *every],
                           [[name, *(str(count[name]) for count in counts.values())] for name in names], ("finding",)))


def forms_section() -> str:
    """The section on whose files are read, each of which a test writes."""
    table = markdown_table(["of", "as"], [[name, form.how] for name, form in FOREIGN.items()], ("of", "as"))
    return f"{FORMS_TEXT}{table}\n"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--draw", type=int)
    seed = parser.parse_args().draw
    found = random_runs(CHECK_SEED if seed is None else seed)
    print(*found, sep="\n\n", flush=True)
    if seed is not None:
        return
    rows, heads = altered(), ["problem", "what is wrong", "x", "v", "σ", "the judge", "the check"]
    both = markdown_table(heads, rows, (*heads[:2], *heads[5:]))
    judge = markdown_table([*heads[:5], "said"], [row[:6] for row in rows], (*heads[:2], "said"))
    head, of_runs, tail, judge_head = (ROOT / "tests" / "findings.md").read_text(encoding="utf-8").split("{{}}\n")
    for name, text in (("check", f"{head}{found[0]}\n\nWhat found the lost and unstable ones:\n\n{found[1]}\n{of_runs}"
                                 f"{both}\n{tail}"),
                       ("judge", f"{judge_head}{judge}\n\n{false_alarms()}\n{forms_section()}")):
        (ROOT / "assets" / f"{name}.md").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
