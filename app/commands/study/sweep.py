"""``mpm-lab sweep PROBLEM``: all combinations of values, one row each."""

import math
from dataclasses import dataclass, fields
from typing import Annotated, Any, ClassVar, get_args, get_type_hints

from app import __version__
from app.commands.lenient_flag_types import NumberFlag, Switch, default_hint
from app.commands.output import json_text
from app.commands.scene_flags import SceneFlags
from app.commands.study.study_command import StudyFlags
from solvers.scene.validation import require_whole
from solvers.study import csv_and_markdown_summary as table
from solvers.study.parameter_grid import Task, plan_tasks


@dataclass(frozen=True, kw_only=True)
class Sweep(StudyFlags, SceneFlags):
    """Command ``mpm-lab sweep``: its flags, and those of scenes, of which all but ``LISTS`` take several values."""

    HELP: ClassVar[str] = """Run the {title} with every combination of values: what accuracy costs.

    Give any flag of a scene several values: --cells 20 40 80 --method {methods}. Each combination is a row with its
    errors, estimates, times and status; rows are kept as they finish. Tables and pictures follow at the end.
    Exit status: 0 every row is there, 1 could not run or write, 2 bad input, 130 stopped by Ctrl-C (rows are kept)."""
    EXAMPLE: ClassVar[str] = "mpm-lab sweep {problem} --cells 20 40 80 --method {methods} --out sweep"
    LISTS: ClassVar[frozenset[str]] = frozenset({"estimator", "effects", "remedies"})

    no_linearity_preserving: Annotated[Switch, default_hint("on")] = False
    """Plain transfers; give both to compare."""
    repeats: NumberFlag = 3
    """Timed runs of each row; the shortest counts."""
    each_effect: Annotated[Switch, default_hint("off")] = False
    """Time each effect alone as well, which compiles and runs more."""

    def measurement_tasks(self) -> list[Task]:
        require_whole("repeats", self.repeats, 1, 1000)
        axes = self.axes()
        self.check_study_flags(math.prod(map(len, axes.values())))
        return plan_tasks(self.SCENE.problem, axes, repeats=self.repeats, price_effects=self.each_effect,
                          version=__version__)

    def write_tables(self, rows: list[dict]) -> int:
        from app.pictures.cost_and_convergence import FIGURES
        problem = self.SCENE.problem
        return self.write(FIGURES, rows, lambda drawn: {
            "table.csv": table.csv_text(rows), "table.json": json_text(table.study_to_dict(problem, rows), lines=True),
            "summary.md": table.summarise_study(problem, rows, drawn)}, printed="summary.md")

    def axes(self) -> dict[str, list]:
        """Returns all values of each input of the sweep's scenes, by the name of its flag."""
        hints = get_type_hints(type(self), include_extras=True)
        formulas = {f.name for f in fields(self.SCENE) if f.type == "str" and not self.SCENE.choices(f.name)}
        axes = {name: [value] if name in self.LISTS else value.split(";") if name in formulas
                else flag_values(value, hints[name]) for name, value in self.inputs().items()}
        on = axes["linearity_preserving"][0]
        return axes | {"linearity_preserving": [True] * on + [False] * (self.no_linearity_preserving or not on)}


def flag_values(value: Any, hint: Any) -> list:
    """Returns the values of a flag with the annotation ``hint``: of a text with several words, each one parsed."""
    if not isinstance(value, str):
        return [value]
    words = value.replace(",", " ").split()
    parse = next(part for part in get_args(hint) if hasattr(part, "instance_from_str")).instance_from_str
    return [parse([word]) for word in words] if len(words) > 1 else [value]
