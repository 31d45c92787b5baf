"""Registry of all problems. A new problem is one line here (see CONTRIBUTING.md)."""

from solvers.problems.bar.problem import BarProblem
from solvers.problems.descriptor import Problem
from solvers.problems.ring import RING
from solvers.problems.square import SQUARE
from solvers.problems.vortex import VORTEX
from solvers.scene.extension_modules import load_extensions

PROBLEMS: dict[str, Problem] = {"bar": BarProblem(), "square": SQUARE, "ring": RING, "vortex": VORTEX}


def register(problem: Problem) -> None:
    """Makes an external problem known to commands, page and studies: in a module that ``MPM_LAB_EXTENSIONS`` names, or
    before anything runs. Raises ValueError where another problem has its name."""
    name = problem.scene.problem
    if name in PROBLEMS:
        raise ValueError(f"there is a problem called {name}; give yours another name")
    PROBLEMS[name] = problem


load_extensions()
