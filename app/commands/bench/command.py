"""``mpm-lab bench``: how fast it is here."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

import tyro

from app.commands.bench.history import History, history_table
from app.commands.bench.itself import ITSELF
from app.commands.bench.text import bench_table
from app.commands.bench.waits.checkout import beside, here
from app.commands.flags import BadInput, NumberFlag, PathFlag, Switch, default_hint
from app.commands.output import json_target, put_result
from app.commands.progress import working
from solvers.scene.rules import require_number, require_whole

MOST_VISITORS, MOST_MINUTES = 200, 600


@dataclass(frozen=True)
class Bench:
    """Measure how fast this machine is, and what estimators and effects cost on it.

    One thread of the processor, in its own time; takes less than a minute. Beside them stands the rate of Taichi's own
    example mpm99. With --class, have so many visitors use the page on a server of this machine instead; with --history,
    keep the rates as ratios to hand-written C++; with --waits, measure what people wait for: the page, searches,
    exports, checks, tables.
    Exit status: 0 ok, 1 could not run or write, 2 bad input.
    """

    EXAMPLE: ClassVar[str] = "mpm-lab bench --quick"

    json: Annotated[PathFlag, default_hint("a table is printed instead")] = None
    """File for the result as a JSON object; - is standard output."""
    quick: Annotated[Switch, default_hint("off")] = False
    """Fewer sizes and turns: less time, more noise."""
    visitors: Annotated[NumberFlag, tyro.conf.arg(name="class", help_behavior_hint="(default: no class)")] = None
    """Visitors without a browser who come within five seconds and move sliders; says what each of them gets."""
    minutes: NumberFlag = 1
    """How long the class stays."""
    history: Annotated[PathFlag, default_hint("no history")] = None
    """File that gets a line with today's ratios to C++ that is compiled here, and a picture of all its lines beside."""
    waits: Annotated[Switch, default_hint("off")] = False
    """What people wait for, three times each; takes some ten minutes, with --quick five."""
    beside: Annotated[PathFlag, default_hint("this code alone")] = None
    """With --waits: folder of another version of mpm-lab, to take turns with."""
    quiet: Annotated[Switch, default_hint("off")] = False
    """No progress bar on standard error."""

    def execute(self) -> int:
        target = json_target(self.json)
        self._require_one()
        other = None if self.beside is None else beside(self.beside)
        history = None if self.history is None else History(self.history)
        with working(self.quiet) as show:  # imports here: bad input and --help must not wait for Taichi
            if history:
                values, table = history.add(self.quick, show), history_table
            elif self.waits:
                from app.commands.bench.waits.text import waits_table
                from app.commands.bench.waits.waits import waits
                values, table = waits(here(), other, self.quick, show), waits_table
            elif self.visitors is None:
                from solvers.bench.bench import bench
                values, table = bench(self.quick, (*ITSELF, "--version"), show), bench_table
            else:
                from app.commands.bench.class_load import Load, class_load, class_table
                values, table = class_load(Load(self.visitors, 60 * self.minutes), show), class_table
        put_result(values, target, table)
        return 0

    def _require_one(self) -> None:
        """What is measured is one thing."""
        if self.visitors is not None:
            require_whole("class", self.visitors, 1, MOST_VISITORS)
            require_number("minutes", self.minutes, 0, MOST_MINUTES)
            if self.history is not None:
                raise BadInput("history", self.history, "goes without --class; give one of them")
        for flag, value in (("class", self.visitors), ("history", self.history)):
            if self.waits and value is not None:
                raise BadInput(flag, value, "goes without --waits; give one of them")
        if self.beside is not None and not self.waits:
            raise BadInput("beside", self.beside, "goes with --waits; give both")
