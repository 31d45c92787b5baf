"""The problems there are: the one place that knows them all. A new problem is one line here (see CONTRIBUTING.md)."""

from solvers.problems.bar.problem import BarProblem
from solvers.problems.descriptor import Problem
from solvers.problems.ring.problem import RingProblem
from solvers.problems.square import SQUARE
from solvers.problems.vortex.problem import VortexProblem

PROBLEMS: dict[str, Problem] = {"bar": BarProblem(), "ring": RingProblem(), "vortex": VortexProblem(),
                                "square": SQUARE}
