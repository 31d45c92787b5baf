"""``mpm-lab bench``: how fast it is here."""

import sys
from dataclasses import dataclass
from typing import Annotated

from app.commands.bench_text import bench_table
from app.commands.flags import PathFlag, Switch, default_hint
from app.commands.output import json_target, report, working

COMMAND = (sys.executable, "-m", "app", "--version")


@dataclass(frozen=True)
class Bench:
    """Measure rates, what estimators and effects cost, and start-up times on this machine.

    One thread of the processor, in its own time; takes less than a minute. Beside them stands the rate of Taichi's own
    example mpm99.
    """

    json: Annotated[PathFlag, default_hint("a table is printed instead")] = None
    """File for the result as a JSON object; - is standard output."""
    quick: Annotated[Switch, default_hint("off")] = False
    """Fewer sizes and turns: less time, more noise."""
    quiet: Annotated[Switch, default_hint("off")] = False
    """No progress bar on standard error."""

    def execute(self) -> int:
        """Measure, then write or print."""
        target = json_target(self.json)
        with working(self.quiet) as show:
            from solvers.bench.bench import bench  # here: bad input and --help must not wait for Taichi
            values = bench(self.quick, COMMAND, show)
        report(values, target, bench_table)
        return 0
