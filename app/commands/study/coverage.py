"""``mpm-lab coverage PROBLEM``: how often the estimators are right, in random runs."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

from app.commands.lenient_flag_types import NumberFlag
from app.commands.output import json_text
from app.commands.study.study_command import RandomDrawStudy
from solvers.scene.scene import Scene
from solvers.study.coverage.estimate_coverage_counts import tally
from solvers.study.coverage.estimate_coverage_tables import coverage_summary
from solvers.study.coverage.random_runs import MEASURED, RandomRun
from solvers.study.row import FAILED

SEED = 29  # of ``assets/coverage.md``


@dataclass(frozen=True, kw_only=True)
class Coverage(RandomDrawStudy):
    """Command ``mpm-lab coverage``: flags of the number of random runs, their seed, and the output."""

    HELP: ClassVar[str] = """Count how often the error estimators of the {title} are right.

    Runs are drawn at random: methods, cells, particles, amplitudes, steps and ends. Each has all estimators, those that
    refuse too, and runs on cells two and four times as wide beside it, for the grid convergence index. The same seed
    draws the same runs, and more of them with a larger --runs and --resume.
    Exit status: 0 every row is there, 1 could not run or write, 2 bad input, 130 stopped by Ctrl-C (rows are kept)."""
    EXAMPLE: ClassVar[str] = "mpm-lab coverage {problem} --runs 50 --out coverage"
    SCENE: ClassVar[type[Scene]]
    DRAW, MEASURED = RandomRun, MEASURED
    WORK = "solvers.study.coverage.random_runs:measure_in_worker"

    runs: NumberFlag = 1000
    """Runs to draw."""
    seed: NumberFlag = SEED
    """Which runs: another seed draws others."""
    def write_tables(self, rows: list[dict]) -> int:
        from app.pictures.study_parts import coverage_figure
        counted = tally(self.SCENE.problem, self.seed, rows[:self.runs])
        return self.write({"coverage": coverage_figure}, [counted], lambda drawn: {
            "coverage.json": json_text(counted), "coverage.md": coverage_summary(counted, *drawn)},
                          printed="coverage.md")

    def describe_row(self, row: dict, tasks: Sequence[RandomRun]) -> str:
        return f"run {row['number']}: {row['status']}" + (f": {row['reason']}" if row["status"] == FAILED else "")
