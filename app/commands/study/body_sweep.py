"""``mpm-lab sweep FILE.toml``: a body from a file with every combination of values, one row each."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, get_type_hints

import tyro

from app.commands.body import read_body_file, value_and_bar
from app.commands.lenient_flag_types import BadInput, NumberFlag, RealFlag, TextFlag, default_hint
from app.commands.output import json_text
from app.commands.study.study_command import StudyFlags
from app.commands.study.sweep import flag_values
from solvers.bodies.estimate import QUANTITIES
from solvers.scene.validation import SceneError, field_flag
from solvers.study import body_sweep
from solvers.study.body_sweep import BodyTask, plan_body_tasks
from solvers.study.csv_and_markdown_summary import NOTHING, csv_text
from solvers.study.markdown_tables import markdown_table
from solvers.untrusted.quoting import escape_markdown, file_name

OWN = default_hint("that of the file")
FLAGS = {"cells": "cells_per_metre", "method": "method", "ppc": "ppc", "cfl": "cfl",
         "youngs_modulus": "youngs_modulus"}


@dataclass(frozen=True, kw_only=True)
class BodySweep(StudyFlags):
    """Run the body of a file with every combination of values: how errors, goals and bars change.

    Give a flag several values: --cells 4 8 16. Each combination is a row with estimated errors, delta, goals with their
    bars, status and times; rows are kept as they finish. Tables and a picture follow at the end.
    Exit status: 0 every row is there, 1 could not run or write, 2 bad input, 130 stopped by Ctrl-C (rows are kept)."""

    EXAMPLE: ClassVar[str] = "mpm-lab sweep FILE.toml --cells 4 8 16 --out sweep"
    IDENTITY, MEASURED = body_sweep.IDENTITY, body_sweep.MEASURED
    WORK = body_sweep.MEASURE_BODY
    only_problem = body_sweep.PROBLEM

    file: Annotated[TextFlag, tyro.conf.Positional, tyro.conf.arg(name="FILE")] = ""
    """File of the body, .toml."""
    cells: Annotated[RealFlag, OWN] = None
    """Cells per metre."""
    method: Annotated[TextFlag, OWN] = None
    """cpdi, ugimp, cpgimp or mpm."""
    ppc: Annotated[NumberFlag, OWN] = None
    """Particles per cell and direction."""
    cfl: Annotated[RealFlag, OWN] = None
    """Time step over that in which a wave crosses a cell."""
    youngs_modulus: Annotated[RealFlag, OWN] = None
    """Young's modulus, Pa."""

    def measurement_tasks(self) -> list[BodyTask]:
        hints = get_type_hints(type(self), include_extras=True)
        axes = {name: flag_values(value, hints[flag]) for flag, name in FLAGS.items()
                if (value := getattr(self, flag)) is not None}
        body = read_body_file(self.file)
        try:
            tasks = plan_body_tasks(body, axes)
        except SceneError as error:  # by the name of the flag
            flags = {name: flag for flag, name in FLAGS.items()}
            raise BadInput(field_flag(flags.get(error.field, error.field)), error.value, error.sentence) from None
        self.check_study_flags(len(tasks))
        return tasks

    def failed_task_row(self, task: BodyTask, reason: str) -> dict:
        return task.failed_row(reason)

    def describe_row(self, row: dict, tasks: Sequence[BodyTask]) -> str:
        return f"{_inputs_text(row)}: {row['status']}" + (f": {row['reason']}" if row["reason"] else "")

    def write_tables(self, rows: list[dict]) -> int:
        from app.pictures.body_sweep_goals import body_goals_figure
        name = file_name(self.file)
        values = {"schema": "mpm-lab/body-sweep/1", "problem": self.only_problem, "file": name, "rows": rows}
        return self.write({"goals": body_goals_figure}, rows, lambda drawn: {
            "table.csv": csv_text(rows), "table.json": json_text(values, lines=True),
            "summary.md": body_sweep_summary(name, rows, drawn)}, printed="summary.md")


def body_sweep_summary(name: str, rows: Sequence[dict], pictures: Sequence[str] = ()) -> str:
    """Returns a body's sweep in Markdown: every row in short, and links to ``pictures`` (file names); ``name`` is the
    body's file."""
    asked = list(dict.fromkeys(["method", "cells_per_metre", *(field for row in rows for field in row["asked"])]))
    goals = list(dict.fromkeys(goal for row in rows for goal in row.get("goals", ())))
    heads = [*(field.replace("_", " ") for field in asked), "status",
             *(f"estimated error {quantity} ({unit})" for quantity, unit in QUANTITIES.items()), "delta x", *goals,
             "seconds"]
    lines = [[*(_input_cell((row["scene"] or row["asked"]).get(field)) for field in asked), row["status"],
              *(_estimate_cell(row, quantity) for quantity in QUANTITIES),
              f"{row['estimate']['x']['delta']:.2f}" if row.get("estimate") else NOTHING,
              *(_goal_cell(row.get("goals", {}).get(goal)) for goal in goals),
              f"{row['seconds']['run']:.3g}" if "seconds" in row else NOTHING] for row in rows]
    reasons = [f"* {_inputs_text(row)}: {escape_markdown(words)}"
               for row in rows for words in (row["reason"], *row.get("remarks", ())) if words]
    parts = [f"# Sweep of {escape_markdown(name)}", "Estimated errors are the largest RMS over particles; seconds are "
             "those of the run without the companions.", markdown_table(heads, lines), "\n".join(reasons),
             *(f"![{picture}]({picture})" for picture in pictures)]
    return "\n\n".join(part for part in parts if part) + "\n"


def _inputs_text(row: dict) -> str:
    return ", ".join(f"{name.replace('_', ' ')} {_input_cell(value)}" for name, value in row["asked"].items()) \
        or "the file as it is"


def _input_cell(value: Any) -> str:
    return NOTHING if value is None else f"{value:g}" if isinstance(value, (int, float)) else \
        escape_markdown(str(value))


def _estimate_cell(row: dict, quantity: str) -> str:
    one = row.get("estimate", {}).get(quantity)
    return NOTHING if one is None or one["max"] is None else \
        f"{one['max']:.3e}" + (" ± 30 %" if one["trust"] == "30 %" else "")


def _goal_cell(found: Any) -> str:
    if found is None or found["value"] is None:
        return NOTHING
    value, bar = found["value"], found["bar"]
    return f"{value:.6g} {found['unit']}" if bar is None else f"{value_and_bar(value, bar)} {found['unit']}"
