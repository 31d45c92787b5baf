"""Registry of the views of all problems. A new problem is one line here."""

from app.problems.bar.view import BAR
from app.problems.interface import ProblemView
from app.problems.planar_view import planar_problem_view
from solvers.problems import PROBLEMS
from solvers.problems.planar.problem import PlanarProblem

VIEWS: dict[str, ProblemView] = {view.problem: view for view in (
    BAR, *(planar_problem_view(one) for one in PROBLEMS.values() if isinstance(one, PlanarProblem)))}
