"""The problems there are: the one place that knows them all. A new problem is one line here (see CONTRIBUTING.md)."""

from __future__ import annotations

import importlib
import importlib.util
from dataclasses import dataclass
from typing import TYPE_CHECKING

from solvers.problems.bar.scene import BarScene
from solvers.problems.ring.scene import RingScene
from solvers.problems.vortex.scene import VortexScene
from solvers.scene.scene import Scene

if TYPE_CHECKING:
    from solvers.problems.reference import ProblemReference
    from solvers.solver.base import Solver


@dataclass(frozen=True)
class Problem:
    """A problem: its scene, and where its solver is (``module:name``, imported when first needed: Taichi is heavy)."""

    scene: type[Scene]
    solver_path: str

    @property
    def solver(self) -> type[Solver]:
        module, _, name = self.solver_path.partition(":")
        return getattr(importlib.import_module(module), name)

    @property
    def baseline(self) -> type[Solver] | None:
        """A solver whose step has nothing optional in it, written out by hand, where the problem has one."""
        module = f"{self.solver_path.rpartition('.')[0]}.baseline"
        return importlib.import_module(module).SOLVER if importlib.util.find_spec(module) else None

    @property
    def reference(self) -> ProblemReference:
        """The problem as another code sees it: the ``REFERENCE`` of its folder's ``reference.py``."""
        return importlib.import_module(f"{self.solver_path.rpartition('.')[0]}.reference").REFERENCE

    @property
    def estimators(self) -> tuple[str, ...]:
        """The names of the estimators that it has."""
        return self.scene.choices("estimators")


PROBLEMS: dict[str, Problem] = {
    "bar": Problem(BarScene, "solvers.problems.bar.solver:BarSolver"),
    "ring": Problem(RingScene, "solvers.problems.ring.solver:RingSolver"),
    "vortex": Problem(VortexScene, "solvers.problems.vortex.solver:VortexSolver"),
}
