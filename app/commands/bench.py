"""``mpm-lab bench``: how fast it is here."""

from __future__ import annotations

import contextlib
import sys
import warnings
from dataclasses import dataclass
from typing import Annotated

from app.commands.flags import PathFlag, Switch, default_hint
from app.commands.output import Progress, Target, json_text, noted_interrupts, stdout_to_stderr

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
        target = None if self.json is None else Target("json", self.json, may_be_stdout=True)
        with stdout_to_stderr():
            values = _measure(self.quick, self.quiet)
        if target:
            target.write(json_text(values, lines=not target.is_stdout).encode())
        else:
            from app.commands.bench_text import bench_table
            print(bench_table(values), flush=True)
        return 0


def _measure(quick: bool, quiet: bool) -> dict:
    with noted_interrupts() as check_interrupts, contextlib.closing(Progress(sys.stderr, quiet)) as progress:
        warnings.simplefilter("ignore", SyntaxWarning)  # Taichi's source, on its first import by Python 3.12 on
        from solvers.bench.bench import bench  # here: bad input and --help must not wait for Taichi

        def show(part: float) -> None:
            check_interrupts()
            progress.show(part)

        return bench(quick, COMMAND, show)
