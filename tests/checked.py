"""What the check says of runs of ours, good ones and broken ones, and of such in whose files something is wrong.

``uv run python -m tests.checked`` writes ``assets/check.md``: of runs drawn at random how many it finds, by what is
wrong with them, and each alteration of a file with what judge and check say of it. ``--draw SEED`` prints the first
part of another seed alone: the limits were set on seeds 1 and 11 to 13.
"""

from __future__ import annotations

import argparse
from collections import Counter, defaultdict
from collections.abc import Callable
from dataclasses import dataclass
from itertools import islice

from solvers.judging.check import CONSISTENT, Checked, check
from solvers.outside.file_error import FileError
from solvers.study.markdown import grid
from tests.altered import ALL, ALTERATIONS, Files, Steps, files, scene_of, stepped
from tests.checking_runs import KnownRun, known_runs
from tests.judged import said
from tests.paths import ROOT

SEED, DRAWN = 14, 300  # of each problem
TEXT = ROOT / "tests" / "checked.md"
LABELS = {"good": "good", "between": "neither", "v or stress wrong": "x holds; v or the stress as wrong as it is large",
          "neighbour_gap": "lost: neighbours not where their deformation says",
          "displacement_mismatch": "lost: displacements do not add up", "mean_drift": "lost: the body has drifted",
          "out_of_shape": "lost: the ring is not round", "balance_gap": "lost: not the motion of the problem",
          "error_x": "lost: by the truth alone", "unstable": "unstable"}
LOST = tuple(label for label in LABELS if label not in ("good", "between", "v or stress wrong"))


@dataclass(frozen=True)
class Told:
    """A run and what the check says of it."""

    run: KnownRun
    verdict: str
    names: tuple[str, ...]


def told(run: KnownRun) -> Told:
    """Of the particles alone: neither the problem nor its cells are said."""
    try:
        found = check(run.particles)
    except FileError as refused:
        return Told(run, f"refused: {refused.sentence}", ())
    return Told(run, found.verdict, tuple(one.name for one in found.wrong))


def table(every: dict[str, list[Told]]) -> str:
    """Of each problem and kind how many runs there were, and how many were found."""
    rows = []
    for label, words in LABELS.items():
        row = [words]
        for found in every.values():
            counts = Counter(one.verdict for one in found if one.run.label == label)
            seen = sum(counts.values()) - counts[CONSISTENT]
            row += [f"{seen} of {sum(counts.values())}" if counts else "none drawn"]
        rows.append(row)
    return grid(["runs", *every], rows, ("runs",))


def by_finding(every: dict[str, list[Told]]) -> str:
    """What found the lost and unstable ones."""
    counts: dict[str, Counter] = defaultdict(Counter)
    for problem, found in every.items():
        for one in found:
            if one.run.label in LOST:
                counts[problem].update(set(one.names))
    names = sorted(set().union(*counts.values()), key=lambda name: -sum(count[name] for count in counts.values()))
    return grid(["finding", *every], [[name, *(str(counts[problem][name]) for problem in every)] for name in names],
                ("finding",))


def drawn(seed: int, count: int, say: Callable[[str], None] = print) -> dict[str, list[Told]]:
    """Runs of each problem, each checked."""
    every = {}
    for problem in ALL:
        every[problem] = [told(run) for run in islice(known_runs(problem, seed), count)]
        for one in every[problem]:
            if one.run.good and one.verdict != CONSISTENT:
                say(f"false alarm: {one.run.scene}, {one.verdict} by {', '.join(one.names)}")
    return every


def altered() -> str:
    """Each alteration of each problem, with what it makes of the errors and what both say."""
    rows = []
    for problem in ALL:
        run = stepped(scene_of(problem))
        plain = said(run.scene, files(run))
        for name, (problems, change) in ALTERATIONS.items():
            if problem in problems:
                rows.append([problem, name, *_judge(run, change(run), plain.errors), _check(change(run))])
                print(" | ".join(rows[-1]), flush=True)
    heads = ["problem", "what is wrong", "x", "v", "σ", "the judge", "the check"]
    return grid(heads, rows, ("problem", "what is wrong", "the judge", "the check"))


def _judge(run: Steps, arrays: Files, plain: dict[str, float]) -> list[str]:
    try:
        found = said(run.scene, arrays)
    except FileError as refused:
        return ["", "", "", f"refused: {refused.sentence}"]
    alone = [f"{found.by_themselves} not where the neighbours are"] if found.by_themselves else []
    return [*(f"{found.errors[q] / plain[q]:.3g}" for q in plain), "; ".join([*found.notes, *alone]) or "nothing"]


def _check(arrays: Files) -> str:
    try:
        found = check({key: values for key, values in arrays.items() if key != "cells"})
    except FileError as refused:
        return f"refused: {refused.sentence}"
    return _short(found)


def _short(found: Checked) -> str:
    return f"{found.verdict}: {'; '.join(one.says for one in found.wrong)}" if found.wrong else found.verdict


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--draw", type=int)
    asked = parser.parse_args()
    every = drawn(SEED if asked.draw is None else asked.draw, DRAWN)
    print(table(every), by_finding(every), sep="\n\n", flush=True)
    if asked.draw is not None:
        return
    head, between, tail = TEXT.read_text(encoding="utf-8").split("{{}}\n")
    (ROOT / "assets" / "check.md").write_text(
        f"{head}{table(every)}\n\nWhat found the lost and unstable ones:\n\n{by_finding(every)}\n{between}"
        f"{altered()}\n{tail}", encoding="utf-8")


if __name__ == "__main__":
    main()
