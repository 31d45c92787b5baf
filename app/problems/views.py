"""How each problem is shown: the one place of the app that knows them all. A new problem is one line here."""

from app.problems.bar.view import BAR
from app.problems.interface import ProblemView
from app.problems.manufactured import view_of
from app.problems.ring.view import RING
from app.problems.vortex.view import VORTEX
from solvers.problems.square import SQUARE

VIEWS: dict[str, ProblemView] = {view.problem: view for view in (BAR, RING, VORTEX, view_of(SQUARE))}
