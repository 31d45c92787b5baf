"""``mpm-lab coverage``: how often estimates are right in random runs of a problem, and bars in random cantilevers."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

from app.commands.lenient_flag_types import NumberFlag
from app.commands.output import json_text
from app.commands.study.study_command import RandomDrawStudy
from solvers.scene.scene import Scene
from solvers.study.coverage import random_cantilevers, random_runs
from solvers.study.coverage.cantilever_counts import cantilever_summary, tally_cantilevers
from solvers.study.coverage.estimate_coverage_counts import tally
from solvers.study.coverage.estimate_coverage_tables import coverage_summary
from solvers.study.coverage.random_cantilevers import RandomCantilever
from solvers.study.coverage.random_runs import RandomRun
from solvers.study.row import FAILED

SEED = 29  # of ``assets/coverage.md``
CANTILEVER_SEED = 61127  # of ``assets/body.md``


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
    DRAW, MEASURED = RandomRun, random_runs.MEASURED
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


@dataclass(frozen=True, kw_only=True)
class CantileverCoverage(RandomDrawStudy):
    """Count how often error bars of bodies hold, in random cantilevers.

    Lengths, stiffness, Poisson's ratios, methods, cells and particles are drawn at random. The truth is a companion of
    order 8 on much finer elements. The same seed draws the same beams, and more of them with a larger --runs and
    --resume.

    Exit status: 0 every row is there, 1 could not run or write, 2 bad input, 130 stopped by Ctrl-C (rows are kept)."""

    EXAMPLE: ClassVar[str] = "mpm-lab coverage body --runs 60 --out coverage"
    DRAW, MEASURED = RandomCantilever, random_cantilevers.MEASURED
    WORK = "solvers.study.coverage.random_cantilevers:measure_in_worker"
    only_problem = random_cantilevers.PROBLEM

    runs: NumberFlag = 60
    """Beams to draw."""
    seed: NumberFlag = CANTILEVER_SEED
    """Which beams: another seed draws others."""
    def write_tables(self, rows: list[dict]) -> int:
        from app.pictures.cantilever_coverage import cantilever_coverage_figure
        shown = rows[:self.runs]
        counted = tally_cantilevers(self.seed, shown)
        return self.write({"coverage": cantilever_coverage_figure}, shown, lambda drawn: {
            "coverage.json": json_text(counted), "coverage.md": cantilever_summary(counted, *drawn)},
                          printed="coverage.md")

    def describe_row(self, row: dict, tasks: Sequence[RandomCantilever]) -> str:
        return f"run {row['number']}: {row['status']}" + (f": {row['reason']}" if row["reason"] else "")
