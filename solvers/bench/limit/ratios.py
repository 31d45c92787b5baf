"""Our rates over the limit's: solver and C++ take turns, so that a processor that changes its speed changes both."""

import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from solvers.bench.limit.program import NoLimit, Program
from solvers.bench.measure import bare
from solvers.problems import PROBLEMS
from solvers.running.run import build
from solvers.running.timing import Stretch

TURNS, QUICK_TURNS = 9, 3
SECONDS = 0.1  # of a stretch at least: about what a run of the C++ takes
BAR_CELLS, BAR_STEPS = 160, 20_000
RING_METHODS = ("ugimp", "cpgimp", "cpdi")
RING_CELLS, RING_STEPS = 96, 512  # beyond 0.01 s the C++ ring, without remedies for long runs, breaks


@dataclass(frozen=True)
class Case:
    """A method of a problem, the grid that it is measured on, and what the C++ is told to do."""

    problem: str
    method: str
    cells: int
    arguments: tuple[object, ...]


def cases(quick: bool = False) -> list[Case]:
    """The bar's methods, all against the C++ step of uGIMP; the ring's boxes and CPDI, each against its own. ``quick``
    leaves out the ring, whose C++ takes longest to compile."""
    bar = [Case("bar", method, BAR_CELLS, (BAR_CELLS, BAR_STEPS)) for method in PROBLEMS["bar"].scene.choices("method")]
    ring = [Case("ring", method, RING_CELLS, (method, RING_CELLS, RING_STEPS)) for method in RING_METHODS]
    return bar if quick else bar + ring


def ratios(quick: bool, on_progress: Callable[[float], None]) -> dict:
    """A row for each case, and why a problem has none. In a turn each case is measured twice, the solver and at once
    the C++, both after a turn that does not count.

    ``ratio`` is the median over the turns, ``low`` and ``high`` are the quartiles; ``rate`` and ``limit`` are the
    fastest of each, in million particle-steps a second of one thread's time; ``seconds`` are those of our step.

    Raises :class:`~solvers.bench.limit.program.NoLimit` where no C++ can be compiled.
    """
    with tempfile.TemporaryDirectory(prefix="mpm-lab-limit-", ignore_cleanup_errors=True) as folder:
        programs, missing = _programs({case.problem for case in cases(quick)}, Path(folder))
        measured = [case for case in cases(quick) if case.problem in programs]
        stretches = [Stretch(build(bare(case.problem, case.cells, method=case.method)), SECONDS) for case in measured]
        turns = []
        for turn in range(1 + (QUICK_TURNS if quick else TURNS)):
            on_progress(turn / (1 + (QUICK_TURNS if quick else TURNS)))
            turns.append([(stretch.time(), programs[case.problem].run(*case.arguments)[0])
                          for case, stretch in zip(measured, stretches, strict=True)])
    on_progress(1.0)
    return {"missing": missing, "cases": [
        _row(case, stretch.solver.scene.particles, np.array(pairs))
        for case, stretch, pairs in zip(measured, stretches, np.swapaxes(turns[1:], 0, 1), strict=True)]}


def _programs(problems: set[str], folder: Path) -> tuple[dict[str, Program], dict[str, str]]:
    programs, missing = {}, {}
    for problem in sorted(problems):
        try:
            programs[problem] = Program(problem, folder)
        except NoLimit as why:
            missing[problem] = str(why)
    if not programs:
        raise NoLimit("; ".join(dict.fromkeys(missing.values())))
    return programs, missing


def _row(case: Case, particles: int, pairs: np.ndarray) -> dict:
    """``pairs``: seconds a step of the solver and the rate of the C++, a row a turn."""
    seconds, limits = pairs.T
    rates = 1e-6 * particles / seconds
    low, ratio, high = np.quantile(rates / limits, [0.25, 0.5, 0.75])
    return {"problem": case.problem, "method": case.method, "cells": case.cells, "particles": particles,
            "ratio": float(ratio), "low": float(low), "high": float(high), "rate": float(rates.max()),
            "limit": float(limits.max()), "seconds": float(seconds.min())}
