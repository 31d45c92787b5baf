"""``mpm-lab tables``: the paper's numbers, ours and their ratio, then each estimator's numbers."""

import functools
import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Annotated

import tyro

from app.commands import lenient_flag_types
from app.commands.lenient_flag_types import BadInput, PathFlag, ProcessesFlag, Switch, TextFlag
from app.commands.output import OutputTarget, json_text, print_message
from app.commands.study.study_command import INCOMPLETE, Study
from app.names_and_units import NOTHING, QUANTITIES, method_name
from solvers.problems import PROBLEMS
from solvers.study.markdown_tables import markdown_table
from solvers.study.parameter_grid import Task
from solvers.study.row import FAILED
from solvers.study.tables import paper_table_definitions, table_runs
from solvers.study.tables.paper_table_definitions import PaperTableDefinition, format_digits

UNSTABLE = 3
KINDS = ("json", "md", "png")  # suffixes of a table's files


@dataclass(frozen=True)
class PaperTables(Study):
    """Make the paper's tables again and write them beside the printed numbers.

    As Markdown, JSON and a picture each. Takes a minute or two. Each finished run is kept in DIR/rows.jsonl; a command
    that was stopped goes on there.
    Exit status: 0 ok, 1 could not run or write, 2 bad input, 3 a row went unstable or is lost, 130 stopped by Ctrl-C.
    """

    EXAMPLE = "mpm-lab tables 1 --out tables"
    MEASURED = table_runs.MEASURED
    WORK = "solvers.study.tables.table_runs:measure_in_worker"

    table: Annotated[TextFlag, tyro.conf.Positional, tyro.conf.arg(metavar="{1,2,3,all}")] = "all"
    """Table of the paper."""
    out: Annotated[PathFlag, tyro.conf.arg(metavar="DIR", help_behavior_hint="(required)")] = ""
    """Directory for table1.md, table1.json, table1.png and so on; it is made if it is not there."""
    processes: ProcessesFlag = None
    """Processes that make runs side by side; what estimators cost is timed afterwards, alone."""
    quiet: Annotated[Switch, lenient_flag_types.default_hint("off")] = False
    """No remarks on standard error."""

    @property
    def only_problem(self) -> None:
        """None, as rows belong to several problems."""

    def measurement_tasks(self) -> list[Task]:
        if self.table not in (*paper_table_definitions.NUMBERS, "all"):
            raise BadInput("", self.table,
                           f"is not a table of the paper; give {', '.join(paper_table_definitions.NUMBERS)} or all")
        lenient_flag_types.process_count(self.processes)
        wanted = table_runs.all_runs(tables := self._tables())
        self.check_study_flags(len(wanted))
        for path in (f"{self.out.rstrip('/')}/table{table.number}.{kind}" for table in tables for kind in KINDS):
            if os.path.isdir(path):
                OutputTarget("out", path)  # rejects it now and not after the runs
        return wanted

    def _tables(self) -> list[PaperTableDefinition]:
        estimators = {name: problem.estimators for name, problem in PROBLEMS.items()}
        numbers = paper_table_definitions.NUMBERS if self.table == "all" else (self.table,)
        return [paper_table_definitions.make_table(number, estimators) for number in numbers]

    def parallel_groups(self, tasks: Sequence[Task]) -> Iterable[Sequence[Task]]:
        return [[task for task in tasks if not task.repeats], *([task] for task in tasks if task.repeats)]

    def describe_row(self, row: dict, tasks: Sequence[Task]) -> str:
        asked = row["asked"]
        return f"{row['problem']}, {asked['method']}, {asked['cells']} cells: {row['status']}"

    def with_timing_conditions(self, row: dict) -> dict:
        return row

    def _worker_count(self) -> int:
        return lenient_flag_types.process_count(self.processes)

    def write_tables(self, rows: list[dict]) -> int:
        from app.pictures.paper_tables import table_figure
        wanted = self._tables()
        keys = {task.key for task in table_runs.all_runs(wanted)}
        if failed := [row for row in rows if row["key"] in keys and row["status"] == FAILED]:
            print_message(f"{len(failed)} runs failed, the first of them: {failed[0]['reason']}; the others are kept")
            return INCOMPLETE
        made = [table_runs.table_to_dict(table, table_runs.results_by_row(table, rows)) for table in wanted]
        status = self.write({f"table{table['table']}": functools.partial(lambda table, _: table_figure(table), table)
                             for table in made}, made,
                            lambda _: {f"table{table['table']}.{kind}": text for table in made
                                       for kind, text in (("json", json_text(table, lines=True)),
                                                          ("md", table_markdown(table)))})
        unstable = [row for table in made for row in table["rows"] if row["unstable"]]
        for row in unstable:
            print_message(f"{row['name']}: {row['unstable']}")
        return UNSTABLE if unstable else status


#: The inputs that distinguish the rows of each table.
INPUTS = {"1": ("cells",), "2": ("method", "cells"), "3": ("method", "cells")}
#: Columns compared with the paper in each table: key and heading with the unit.
COMPARED = {"1": {"x": "x (m)", "v": "v (m/s)", "sigma_log": "σ (Pa)", "grid_crossings": "crossings"},
            "2": {"x": "x (m)", "v": "v (m/s)", "a_nodes": "Err A (m/s²)"}, "3": {"index_x": "index of x, transport"}}
Footnotes = dict[str, int]  # distinct sentences below the table, with their numbers


def table_markdown(table: dict) -> str:
    """Returns a table of the paper, with ours beside it, in Markdown, from its JSON object."""
    notes: Footnotes = {}
    blocks = [f"# {table['title']}", *table["setup"]]
    for part, rows in table_runs.rows_by_part(table).items():
        blocks += [f"## {part}", _paper_comparison(table["table"], rows, notes)]
        if table["table"] != "2":
            blocks += [f"Index of each estimator, its distance and its cost — {part}:",
                       _estimator_table(table, rows, notes)]
    seconds = table["seconds"]
    blocks.append(f"These runs took {seconds['run']:.0f} s, and {seconds['setup'] + seconds['compile']:.0f} s to set "
                  "up and compile; all but those for the cost may have been made side by side.")
    return "\n\n".join([*blocks, *(f"[^{number}]: {sentence}" for sentence, number in notes.items())]) + "\n"


def _footnote_mark(sentence: str, notes: Footnotes) -> str:
    """Returns the mark "[^2]" of a footnote with this sentence, which is added to ``notes`` if it is new."""
    return f"[^{notes.setdefault(sentence, len(notes) + 1)}]"


def _paper_comparison(number: str, rows: list[dict], notes: Footnotes) -> str:
    heads = list(INPUTS[number])
    for key, heading in COMPARED[number].items():
        ours = [f"{heading} to {rows[0]['inputs'][end]:g} s" for end in ("t_end_crossings", "t_end")] \
            if key == "grid_crossings" else [heading]
        heads += [*ours, "paper", "ratio"]
    others = [name for name in rows[0]["estimators"] if name != table_runs.PAPERS_ESTIMATOR] if number == "3" else []
    heads += others
    lines = []
    for row in rows:
        cells = _row_cells(number, row, notes)
        for key in COMPARED[number]:
            if key == "index_x":
                cells.append(_index_of_x(row, table_runs.PAPERS_ESTIMATOR, notes))
            elif key == "grid_crossings":
                cells += [NOTHING if count is None else f"{count:,}"
                          for count in (row["ours"][key], row["ours"]["grid_crossings_short"])]
            else:
                cells.append(NOTHING if row["ours"][key] is None else format_digits(row["ours"][key], 3))
            cells += [_format_printed(key, row["paper"][key]), _format_factor(row["ratio"][key])]
        lines.append([*cells, *(_index_of_x(row, name, notes) for name in others)])
    return markdown_table(heads, lines, words=("method",))


def _estimator_table(table: dict, rows: list[dict], notes: Footnotes) -> str:
    """Returns a Markdown table of the estimators' index, distance and cost; for Table 1 the paper's indices too."""
    number, symbols = table["table"], [quantity.symbol for quantity in QUANTITIES.values()]
    heads = [*INPUTS[number], "estimator", *(f"{kind} {s}" for kind in ("index", "distance") for s in symbols), "cost"]
    lines = []
    for row in rows:
        if number == "1":
            printed = [_format_printed(f"index_{q}", row["paper"].get(f"index_{q}")) for q in QUANTITIES]
            lines.append([*_row_cells(number, row, notes), "the paper's, printed", *printed, *[NOTHING] * 5])
        for name, said in row["estimators"].items():
            values = [_format_factor(said[kind][q]) for kind in ("index", "distance") for q in QUANTITIES]
            cost = NOTHING if said["cost"] is None else f"{100 * said['cost']:.0f} %"
            lines.append([*_row_cells(number, row, notes), name + _reason_mark(name, said, notes), *values, cost])
    return markdown_table(heads, lines, words=("method", "estimator"))


def _index_of_x(row: dict, name: str, notes: Footnotes) -> str:
    """Returns an estimator's index of x in a row; if it is not valid, a dash and the footnote's mark."""
    said = row["estimators"].get(name)
    return _format_factor(said["index"]["x"]) + _reason_mark(name, said, notes) if said else NOTHING


def _reason_mark(name: str, numbers: dict, notes: Footnotes) -> str:
    """Returns the mark of the footnote why an estimator with these numbers is not valid, or ""."""
    return _footnote_mark(f"{name}: {numbers['not_valid']}", notes) if numbers["not_valid"] else ""


def _row_cells(number: str, row: dict, notes: Footnotes) -> list[str]:
    scene = row["inputs"]
    words = {"method": method_name(scene["method"]),
             "cells": str(scene["cells"]) + (_footnote_mark(row["unstable"], notes) if row["unstable"] else "")}
    return [words[name] for name in INPUTS[number]]


def _format_printed(key: str, value: float | None) -> str:
    """Formats a number of the paper with its printed digits; ``key`` is that of its quantity, as index_x."""
    if value is None:
        return NOTHING
    if key == "grid_crossings":
        return f"{round(value):,}"
    if key.startswith("index"):
        return f"{value:.1f}" if value < 10 and value == round(value, 1) else f"{value:g}"
    return format_digits(value, 2)


def _format_factor(value: float | None) -> str:
    """Formats a ratio or an index: at least two digits, hundredths where they are meaningful."""
    if value is None:
        return NOTHING
    if value >= 1000 or value == 0:
        return f"{value:,.0f}"
    return f"{value:.2f}" if 0.1 <= value < 9.995 else f"{value:.3g}" if value > 1 else format_digits(value, 2)
