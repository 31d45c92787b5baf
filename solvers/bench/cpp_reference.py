"""Our rates over those of hand-written C++ (``cpp/``), compiled here: the same step, fused and vectorised by hand for
one method and one CPU. Solver and C++ take turns, so that a CPU that changes its clock rate affects both."""

import os
import shutil
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from solvers.bench.solver_benchmarks import bare_scene
from solvers.problems import PROBLEMS
from solvers.running.repeated_step_timing import RepeatedSteps
from solvers.running.run import build

CPP_SOURCES = Path(__file__).parent / "cpp"
FLAGS = ("-O3", "-march=native", "-ffast-math", "-fopenmp-simd", "-std=c++17")
#: What a program is compiled with beside that: the ring's nodes are vectors of eight numbers.
EXTRA_FLAGS = {"bar": (), "ring": ("-mprefer-vector-width=512",)}
COMPILERS = ("g++", "clang++", "c++")
PATIENCE = 120.0  # seconds
TURNS, QUICK_TURNS = 5, 3
SECONDS = 0.1  # of a stretch at least: about what a run of the C++ takes
BAR_CELLS, BAR_STEPS = 160, 20_000
RING_METHODS = ("ugimp", "cpgimp", "cpdi")
RING_CELLS, RING_STEPS = 96, 512  # beyond 0.01 s the C++ ring, without remedies for long runs, breaks


class CppMissing(Exception):
    """Raised where no C++ can be compiled or run; the message says why, and what would help."""


class CppProgram:
    """C++ program of the step of a problem (name), compiled into a folder. Raises :class:`CppMissing`."""

    def __init__(self, problem: str, folder: Path):
        self.path = folder / problem
        said = _run_command(find_compiler(), *FLAGS, *EXTRA_FLAGS[problem], str(CPP_SOURCES / f"{problem}.cpp"), "-o",
                            str(self.path))
        if said.returncode:
            reasons = [line for line in said.stderr.splitlines() if "error" in line] or ["it failed"]
            raise CppMissing(f"the C++ of the {problem} does not compile: "
                             f"{reasons[0].rpartition('error')[2].strip(': ')}")

    def run(self, *arguments: object) -> tuple[float, float]:
        """Runs the program (arguments: ``ComparisonCase``); returns million particle-steps per second of CPU time, and
        the largest error of x over the amplitude, as a proof of work. Raises :class:`CppMissing`."""
        said = _run_command(str(self.path), *map(str, arguments))
        if said.returncode:
            raise CppMissing(f"the C++ of the {self.path.name} ended with status {said.returncode}")
        rate, error = map(float, said.stdout.split())
        return rate, error


def find_compiler() -> str:
    """Returns the path of the C++ compiler in the variable CXX, or of a usual one. Raises :class:`CppMissing`."""
    names = (os.environ["CXX"],) if os.environ.get("CXX") else COMPILERS
    for name in names:
        if found := shutil.which(name):
            return found
    raise CppMissing(f"there is no C++ compiler ({', '.join(names)}); install one, or name it in the variable CXX")


def _run_command(*command: str) -> subprocess.CompletedProcess:
    try:
        return subprocess.run(command, capture_output=True, text=True, errors="replace", timeout=PATIENCE,
                              stdin=subprocess.DEVNULL)
    except (OSError, subprocess.TimeoutExpired) as error:
        raise CppMissing(f"{Path(command[0]).name} cannot be run: {' '.join(str(error).split())}") from None


@dataclass(frozen=True)
class ComparisonCase:
    """Method of ours and its number of cells, and the arguments of the C++ program that it is compared with."""

    method: str
    cells: int
    arguments: tuple[object, ...]


def comparison_cases(problem: str) -> list[ComparisonCase]:
    """Returns a problem's cases: the bar's methods, all against C++ of uGIMP; or the ring's, each against its own."""
    if problem == "bar":
        return [ComparisonCase(method, BAR_CELLS, (BAR_CELLS, BAR_STEPS))
                for method in PROBLEMS[problem].scene.choices("method")]
    return [ComparisonCase(method, RING_CELLS, (method, RING_CELLS, RING_STEPS)) for method in RING_METHODS]


def measure_ratios(problem: str, quick: bool) -> dict:
    """Returns the measured ``cases`` of a problem, or in ``missing`` why there are none. In each turn the solver and at
    once the C++ are measured; the first turn does not count. ``ratio`` is the median over the turns of our rate over
    that of C++, ``low`` and ``high`` are the quartiles; ``rate`` and ``limit`` are the highest rates of ours and of
    C++, in million particle-steps per second of one thread's time; ``seconds`` is our shortest time per step."""
    with tempfile.TemporaryDirectory(prefix="mpm-lab-limit-", ignore_cleanup_errors=True) as folder:
        try:
            program = CppProgram(problem, Path(folder))
            pairs = [(case, RepeatedSteps(build(bare_scene(problem, case.cells, method=case.method)), SECONDS))
                     for case in comparison_cases(problem)]
            turns = [[(stretch.seconds_per_step(), program.run(*case.arguments)[0]) for case, stretch in pairs]
                     for _ in range(1 + (QUICK_TURNS if quick else TURNS))]
        except CppMissing as why:
            return {"problem": problem, "missing": str(why), "cases": []}
    return {"problem": problem, "missing": None, "cases": [
        _ratio_row(case, stretch.solver.scene.particles, np.array(taken))
        for (case, stretch), taken in zip(pairs, np.swapaxes(turns[1:], 0, 1), strict=True)]}


def _ratio_row(case: ComparisonCase, particles: int, turns: np.ndarray) -> dict:
    """Returns a row of :func:`measure_ratios`; ``turns`` (T, 2) has our seconds per step and the rate of C++."""
    seconds, limits = turns.T
    rates = 1e-6 * particles / seconds
    low, ratio, high = np.quantile(rates / limits, [0.25, 0.5, 0.75])
    return {"method": case.method, "cells": case.cells, "particles": particles,
            "ratio": float(ratio), "low": float(low), "high": float(high), "rate": float(rates.max()),
            "limit": float(limits.max()), "seconds": float(seconds.min())}
