"""``mpm-lab coverage body``: how often error bars of bodies without an exact solution hold, in random cantilevers."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

from app.commands.lenient_flag_types import NumberFlag
from app.commands.output import json_text
from app.commands.study.study_command import RandomDrawStudy
from solvers.study.coverage.cantilever_counts import cantilever_summary, tally_cantilevers
from solvers.study.coverage.random_cantilevers import MEASURED, PROBLEM, RandomCantilever

SEED = 61127  # of ``assets/body.md``


@dataclass(frozen=True, kw_only=True)
class CantileverCoverage(RandomDrawStudy):
    """Count how often error bars of bodies hold, in random cantilevers.

    Lengths, stiffness, Poisson's ratios, methods, cells and particles are drawn at random. The truth is a companion of
    order 8 on much finer elements. The same seed draws the same beams, and more of them with a larger --runs and
    --resume.

    Exit status: 0 every row is there, 1 could not run or write, 2 bad input, 130 stopped by Ctrl-C (rows are kept)."""

    EXAMPLE: ClassVar[str] = "mpm-lab coverage body --runs 60 --out coverage"
    DRAW, MEASURED = RandomCantilever, MEASURED
    WORK = "solvers.study.coverage.random_cantilevers:measure_in_worker"
    only_problem = PROBLEM

    runs: NumberFlag = 60
    """Beams to draw."""
    seed: NumberFlag = SEED
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
