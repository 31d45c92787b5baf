"""``mpm-lab tables``: the paper's tables beside ours, row by row, so that what is finished is never run twice."""

from __future__ import annotations

import contextlib
import os
import sys
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

import tyro

from app.commands.flags import BadInput, PathFlag, Switch, TextFlag, default_hint
from app.commands.output import Progress, Target, json_text, noted_interrupts, say, stdout_to_stderr
from solvers.problems import PROBLEMS
from solvers.tables import plan
from solvers.tables.document import Results, document

if TYPE_CHECKING:
    from app.commands.tables_store import Store

OK, UNSTABLE = 0, 3
KINDS = ("md", "json", "png")


@dataclass(frozen=True)
class Tables:
    """Make the paper's tables again and write them beside the printed numbers: Markdown, JSON and a picture each.

    Takes a minute or two. Each finished row is kept in DIR/rows; a command that was stopped goes on there. Exit status:
    0 ok, 1 could not run or write, 2 bad input, 3 a row went unstable, 130 stopped by Ctrl-C.
    """

    table: Annotated[TextFlag, tyro.conf.Positional, tyro.conf.arg(metavar="{1,2,3,all}")] = "all"
    """Table of the paper."""
    out: Annotated[PathFlag, tyro.conf.arg(metavar="DIR", help_behavior_hint="(required)")] = ""
    """Directory for table1.md, table1.json, table1.png and so on; it is made if it is not there."""
    quiet: Annotated[Switch, default_hint("off")] = False
    """No progress bar and no remarks on standard error."""

    def execute(self) -> int:
        """Run what is not finished yet, then write every table."""
        numbers = _numbers(self.table)
        targets = _targets(self.out, numbers)
        with stdout_to_stderr(), noted_interrupts() as check_interrupts:
            from app.commands.tables_store import Store
            made = [plan.make(number, _estimators()) for number in numbers]
            results = _run_rows(made, Store(self.out), self.quiet, check_interrupts)
            tables = [document(table, results) for table in made]
            for table in tables:
                _write(table, targets[table["table"]])
        unstable = [row for table in tables for row in table["rows"] if row["unstable"]]
        for row in unstable:
            say(f"{row['name']}: {row['unstable']}")
        return UNSTABLE if unstable else OK


def _numbers(word: str) -> tuple[str, ...]:
    if word == "all":
        return plan.NUMBERS
    if word not in plan.NUMBERS:
        raise BadInput("", word, f"is not a table of the paper; give {', '.join(plan.NUMBERS)} or all")
    return (word,)


def _targets(directory: str, numbers: Iterable[str]) -> dict[str, dict[str, Target]]:
    """The files of each table, tried before anything runs; the directory and those above it are made."""
    if not directory.strip():
        raise BadInput("out", directory, "give a directory for the tables")
    try:
        os.makedirs(os.path.join(directory, "rows"), exist_ok=True)
    except (OSError, ValueError) as error:
        why = getattr(error, "strerror", None) or str(error)
        raise BadInput("out", directory, f"cannot be a directory: {why.lower()}; give one that exists or can be "
                       "made and may be written to") from None
    return {number: {kind: Target("out", os.path.join(directory, f"table{number}.{kind}")) for kind in KINDS}
            for number in numbers}


def _estimators() -> dict[str, tuple[str, ...]]:
    """The estimators of each problem, in the order of the scenes."""
    return {name: problem.estimators for name, problem in PROBLEMS.items()}


def _run_rows(tables: Iterable[plan.Table], store: Store, quiet: bool, check_interrupts) -> dict[str, Results]:
    """The results of every row by its name: kept ones first, then the others, each kept as soon as it is there."""
    rows = {row.name: row for table in tables for row in table.rows}
    results = {name: kept for name, row in rows.items() if (kept := store.read(row))}
    missing = [row for name, row in rows.items() if name not in results]
    if results and not quiet:
        say(f"{len(results)} of {len(rows)} rows are there already")
    total, done = sum(row.work for row in missing), 0.0
    with contextlib.closing(Progress(sys.stderr, quiet)) as progress:
        for row in missing:
            def show(part: float, before: float = done, work: float = row.work, name: str = row.name) -> None:
                check_interrupts()
                progress.show((before + part * work) / total, name)

            show(0.0)
            results[row.name] = run_row(row, show)
            store.write(row, results[row.name])
            done += row.work
    return results


def run_row(row: plan.Row, show) -> Results:
    """Make the runs of a row; ``show`` is told the part done."""
    from solvers.run import run

    results, done = {}, 0.0
    for purpose, scene in row.scenes.items():
        work = scene.particles * scene.steps / sum(s.particles * s.steps for s in row.scenes.values())
        results[purpose] = run(scene, on_progress=lambda part, a=done, w=work: show(a + w * part)).to_dict()
        done += work
    return results


def _write(table: Mapping, targets: Mapping[str, Target]) -> None:
    from app.commands.tables_text import markdown
    from app.pictures.run import png_bytes
    from app.pictures.tables import figure

    targets["json"].write(json_text(table, lines=True).encode())
    targets["md"].write(markdown(table).encode())
    targets["png"].write(png_bytes(figure(table)))
