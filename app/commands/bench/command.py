"""``mpm-lab bench``: how fast it is here."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

import tyro

from app.commands.bench.text import bench_table
from app.commands.flags import NumberFlag, PathFlag, Switch, default_hint
from app.commands.output import json_target, put_result
from app.commands.progress import working
from solvers.scene.rules import require_number, require_whole

MOST_VISITORS, MOST_MINUTES = 200, 600


@dataclass(frozen=True)
class Bench:
    """Measure how fast this machine is, and what estimators and effects cost on it.

    One thread of the processor, in its own time; takes about a minute. Beside them stand rates of C++ that is compiled
    here. With --class, have so many visitors use the page on a server of this machine instead.
    Exit status: 0 ok, 1 could not run or write, 2 bad input.
    """

    EXAMPLE: ClassVar[str] = "mpm-lab bench --quick"
    GONE: ClassVar[dict[str, str]] = {
        "--history": "mpm-lab bench itself has the ratios to C++; --json keeps them",
        "--waits": "assets/speed.md keeps what it has measured",
        "--beside": "it went with --waits"}

    json: Annotated[PathFlag, default_hint("a table is printed instead")] = None
    """File for the result as a JSON object; - is standard output."""
    quick: Annotated[Switch, default_hint("off")] = False
    """Fewer sizes and turns: less time, more noise."""
    visitors: Annotated[NumberFlag, tyro.conf.arg(name="class", help_behavior_hint="(default: no class)")] = None
    """Visitors without a browser who come within five seconds and move sliders; says what each of them gets."""
    minutes: NumberFlag = 1
    """How long the class stays."""
    quiet: Annotated[Switch, default_hint("off")] = False
    """No progress bar on standard error."""

    def execute(self) -> int:
        target = json_target(self.json)
        if self.visitors is not None:
            require_whole("class", self.visitors, 1, MOST_VISITORS)
            require_number("minutes", self.minutes, 0, MOST_MINUTES)
        with working(self.quiet) as show:  # imports here: bad input and --help must not wait for Taichi
            if self.visitors is None:
                from app.commands.bench.class_load import ITSELF
                from solvers.bench.bench import bench
                values, table = bench(self.quick, (*ITSELF, "--version"), show), bench_table
            else:
                from app.commands.bench.class_load import Load, class_load, class_table
                values, table = class_load(Load(self.visitors, 60 * self.minutes), show), class_table
        put_result(values, target, table)
        return 0
