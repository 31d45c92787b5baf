"""``mpm-lab coverage PROBLEM``: how often the estimators are right, on runs drawn at random."""

import contextlib
from dataclasses import dataclass
from typing import ClassVar

from app.commands.flags import NumberFlag, ProcessesFlag
from app.commands.output import json_text, put_text, say, telling
from app.commands.study.rows import INCOMPLETE, Study
from solvers.outside.quoting import quoted
from solvers.scene.rules import require_whole
from solvers.scene.scene import Scene
from solvers.study.coverage.draws import Draw
from solvers.study.coverage.measured import failed, fault
from solvers.study.coverage.tally import tally
from solvers.study.coverage.text import summary
from solvers.study.grid import MOST_ROWS
from solvers.study.row import FAILED

WORK = "solvers.study.coverage.measured:measure_draw"
SEED = 29  # of what ``assets/coverage.md`` shows
MOST_SEED = 2**31 - 1


@dataclass(frozen=True, kw_only=True)
class Coverage(Study):
    """How many runs are drawn, and from which seed."""

    HELP: ClassVar[str] = """Count how often the error estimators of the {title} are right.

    Runs are drawn at random: methods, cells, particles, amplitudes, steps and ends. Each has all estimators, those that
    refuse too, and runs on cells two and four times as wide beside it, for the grid convergence index. The same seed
    draws the same runs, and more of them with a larger --runs and --resume.
    Exit status: 0 every row is there, 1 could not run or write, 2 bad input, 130 stopped by Ctrl-C (rows are kept).
    """
    EXAMPLE: ClassVar[str] = "mpm-lab coverage {problem} --runs 50 --out coverage"
    SCENE: ClassVar[type[Scene]]
    TIMED = False

    runs: NumberFlag = 1000
    """Runs to draw."""
    seed: NumberFlag = SEED
    """Which runs: another seed draws others."""
    workers: ProcessesFlag = None
    """Processes on this machine that run rows side by side; nothing is timed."""

    def execute(self) -> int:
        from app.pictures.coverage import coverage_figure

        require_whole("runs", self.runs, 1, MOST_ROWS)
        require_whole("seed", self.seed, 0, MOST_SEED)
        self.check_place(self.runs)
        problem = self.SCENE.problem
        rows = self._drawn([Draw(problem, self.seed, number) for number in range(self.runs)])
        if rows is None:
            return INCOMPLETE
        counted = tally(problem, self.seed, rows)
        drawn, status = self.draw({"coverage": coverage_figure}, [counted])
        text = summary(counted, *drawn)
        self.put("coverage.json", json_text(counted).encode())
        self.put("coverage.md", text.encode())
        put_text(text.partition("\n\n![")[0] + "\n")
        return status

    def _drawn(self, draws: list[Draw]) -> list[dict] | None:
        """The rows of the draws; None if the place where they run was lost on the way."""
        from solvers.study.places import PlaceLost, execute

        with contextlib.ExitStack() as stack:
            place = stack.enter_context(contextlib.closing(self._place(WORK)))
            store = stack.enter_context(contextlib.closing(self._store(draws[0].problem, fault)))
            todo = [draw for draw in draws if not store.finished(draw.key)]
            done = len(draws) - len(todo)
            if done and not self.quiet:
                say(f"{done} of {len(draws)} rows are there already")

            def keep(row: dict) -> None:
                nonlocal done
                done += 1
                with telling(f"--out {quoted(self.out)}"):
                    store.append(row)
                if not self.quiet:
                    say(f"{done}/{len(draws)} run {row['number']}: {row['status']}"
                        + (f": {row['reason']}" if row["status"] == FAILED else ""))

            try:
                execute(todo, place, keep, failed)
            except PlaceLost as error:
                say(f"{error}; {done} of {len(draws)} rows are kept: give --resume to run the others")
                return None
            return [store.rows[draw.key] for draw in draws]
