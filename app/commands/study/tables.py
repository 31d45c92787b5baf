"""``mpm-lab tables``: the paper's tables beside ours, run by run, so that what is finished is never run twice."""

import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, ClassVar

import tyro

from app.commands.flags import BadInput, PathFlag, ProcessesFlag, Switch, TextFlag, default_hint, side_by_side
from app.commands.output import Target, json_text, made_directory, say
from app.commands.progress import working
from app.commands.study.tables_text import markdown
from solvers.problems import PROBLEMS
from solvers.study.store import NotWhole
from solvers.study.tables import plan
from solvers.study.tables.document import Results, document
from solvers.study.tables.making import Making
from solvers.study.tables.rows import read_begun, read_row, write_row

OK, UNSTABLE = 0, 3
KINDS = ("md", "json", "png")
ROWS = "rows"  # the folder of finished rows


@dataclass(frozen=True)
class Tables:
    """Make the paper's tables again and write them beside the printed numbers.

    As Markdown, JSON and a picture each. Takes a minute or two. Each finished run is kept in DIR/rows; a command that
    was stopped goes on there.
    Exit status: 0 ok, 1 could not run or write, 2 bad input, 3 a row went unstable or is lost, 130 stopped by Ctrl-C.
    """

    EXAMPLE: ClassVar[str] = "mpm-lab tables 1 --out tables"

    table: Annotated[TextFlag, tyro.conf.Positional, tyro.conf.arg(metavar="{1,2,3,all}")] = "all"
    """Table of the paper."""
    out: Annotated[PathFlag, tyro.conf.arg(metavar="DIR", help_behavior_hint="(required)")] = ""
    """Directory for table1.md, table1.json, table1.png and so on; it is made if it is not there."""
    processes: ProcessesFlag = None
    """Processes that make runs side by side; what estimators cost is timed afterwards, alone."""
    quiet: Annotated[Switch, default_hint("off")] = False
    """No progress bar and no remarks on standard error."""

    def execute(self) -> int:
        if self.table not in (*plan.NUMBERS, "all"):
            raise BadInput("", self.table, f"is not a table of the paper; give {', '.join(plan.NUMBERS)} or all")
        processes = side_by_side(self.processes)
        numbers = plan.NUMBERS if self.table == "all" else (self.table,)
        targets = _targets(self.out, numbers)
        estimators = {name: problem.estimators for name, problem in PROBLEMS.items()}
        made = [plan.make(number, estimators) for number in numbers]
        results = _run_rows(made, Path(self.out, ROWS), processes, self.quiet)
        tables = [document(table, results) for table in made]
        for table in tables:
            _write(table, targets[table["table"]])
        unstable = [row for table in tables for row in table["rows"] if row["unstable"]]
        for row in unstable:
            say(f"{row['name']}: {row['unstable']}")
        return UNSTABLE if unstable else OK


def _targets(directory: str, numbers: Iterable[str]) -> dict[str, dict[str, Target]]:
    """The files of each table, tried before anything runs; the directory and those above it are made."""
    if not directory.strip():
        raise BadInput("out", directory, "give a directory for the tables")
    made_directory(os.path.join(directory, ROWS), directory)
    return {number: {kind: Target("out", os.path.join(directory, f"table{number}.{kind}")) for kind in KINDS}
            for number in numbers}


def _run_rows(tables: Iterable[plan.Table], folder: Path, processes: int, quiet: bool) -> dict[str, Results]:
    """The results of every row by its name: kept ones first, then the others, whose runs are kept as they come."""
    rows = {row.name: row for table in tables for row in table.rows}
    results = {name: kept for name, row in rows.items() if (kept := _kept(folder, row, quiet))}
    missing = [row for name, row in rows.items() if name not in results]
    if results and not quiet:
        say(f"{len(results)} of {len(rows)} rows are there already")

    def keep(row: plan.Row, made: Results) -> None:
        results[row.name] = made
        write_row(folder, row, made)

    with working(quiet) as show:
        Making(missing, {row.name: read_begun(folder, row) for row in missing}, processes, show, keep).make()
    return results


def _kept(folder: Path, row: plan.Row, quiet: bool) -> Results | None:
    """What is kept of a row; None, and a sentence that says why, where that is not what this row would be."""
    try:
        return read_row(folder, row)
    except NotWhole as error:
        if not quiet:
            say(f"{folder.name}/{row.name}.json {error}: it is made again")
        return None


def _write(table: dict, targets: Mapping[str, Target]) -> None:
    from app.pictures.run import png_bytes
    from app.pictures.tables import figure

    targets["json"].write(json_text(table, lines=True).encode())
    targets["md"].write(markdown(table).encode())
    targets["png"].write(png_bytes(figure(table)))
