"""The limit's programs: compiled by the C++ compiler that is there, and asked for their rate."""

import os
import shutil
import subprocess
from pathlib import Path

HERE = Path(__file__).parent
FLAGS = ("-O3", "-march=native", "-ffast-math", "-fopenmp-simd", "-std=c++17")
#: What a program is compiled with beside that: the ring's nodes are vectors of eight numbers.
MORE = {"bar": (), "ring": ("-mprefer-vector-width=512",)}
COMPILERS = ("g++", "clang++", "c++")
PATIENCE = 120.0  # seconds


class NoLimit(Exception):
    """There is nothing to hold a rate against here; the sentence says why, and what would help."""


def compiler() -> str:
    """The compiler that the variable CXX names, or the first that is found."""
    names = (os.environ["CXX"],) if os.environ.get("CXX") else COMPILERS
    for name in names:
        if found := shutil.which(name):
            return found
    raise NoLimit(f"there is no C++ compiler ({', '.join(names)}); install one, or name it in the variable CXX")


class Program:
    """The step of a problem in C++, compiled into a folder. Raises :class:`NoLimit` where that cannot be."""

    def __init__(self, problem: str, folder: Path):
        self.path = folder / problem
        said = _run(compiler(), *FLAGS, *MORE[problem], str(HERE / f"{problem}.cpp"), "-o", str(self.path))
        if said.returncode:
            reasons = [line for line in said.stderr.splitlines() if "error" in line] or ["it failed"]
            raise NoLimit(f"the C++ of the {problem} does not compile: {reasons[0].rpartition('error')[2].strip(': ')}")

    def run(self, *arguments: object) -> tuple[float, float]:
        """Million particle-steps a second of the processor's time, the start not counted; and the largest error of x
        over the amplitude, by which one sees that it has done the work."""
        said = _run(str(self.path), *map(str, arguments))
        if said.returncode:
            raise NoLimit(f"the C++ of the {self.path.name} ended with status {said.returncode}")
        rate, error = map(float, said.stdout.split())
        return rate, error


def _run(*command: str) -> subprocess.CompletedProcess:
    try:
        return subprocess.run(command, capture_output=True, text=True, errors="replace", timeout=PATIENCE,
                              stdin=subprocess.DEVNULL)
    except (OSError, subprocess.TimeoutExpired) as error:
        raise NoLimit(f"{Path(command[0]).name} cannot be run: {' '.join(str(error).split())}") from None
