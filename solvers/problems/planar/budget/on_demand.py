"""The budget of a run in the plane, on demand: the usual solver a step at a time, the errors of causes beside it."""

from collections.abc import Callable

import numpy as np

from solvers.problems.planar.budget.material import Material
from solvers.problems.planar.budget.moment import Moment, PlanarBudget
from solvers.problems.planar.budget.pieces import Lattice, Pieces
from solvers.problems.planar.budget.push import CauseErrors
from solvers.problems.planar.budget.sources import TIME_STEP, Sources, sources
from solvers.problems.planar.budget.weights import Grid, StepWeights
from solvers.problems.planar.solver import PlanarSolver
from solvers.scene.causes import CAUSES, FIELDS, NOTHING
from solvers.solver.samples import BUDGET


class BudgetOnDemand:
    """A ``solver`` at the start of its run, and the errors that each cause has made in it; what one of ``CAUSES`` gives
    may be taken out of the run, exactly."""

    def __init__(self, solver: PlanarSolver, budget: PlanarBudget, take_away: str = NOTHING):
        scene, a = solver.scene, solver._arrays
        self.solver, self._budget, self._scene, self._arrays = solver, budget, scene, a
        self._X, self._volume = a.material_position, a.mass / a.density
        self._grid = Grid(a.row, solver.PARTS.traits.first)
        self._lattice = Lattice(scene)
        self._material = Material(*budget.lame(scene), at_rest=scene.frozen)
        self._now: Moment = budget.moment(scene, self._X, 0.0)
        self._taken = None if take_away == NOTHING else list(CAUSES).index(take_away)
        self.causes = CauseErrors(len(self._X))
        # A run may begin with the velocity of half a step before: that is how it steps.
        self.causes.velocity[TIME_STEP] = a.position_velocity[:, 2:] - self._now.velocity

    def errors(self) -> dict[str, np.ndarray]:
        """The true errors of x, v (P, 2) and F (P, 2, 2)."""
        q, now = self._arrays.position_velocity, self._now
        return {"x": q[:, :2] - self._X - now.displacement, "v": q[:, 2:] - now.velocity,
                "F": self._arrays.deformation_gradient.reshape(-1, 2, 2) - now.deformation_gradient}

    def step(self) -> bool:
        """Take one step; False where the run has gone bad."""
        scene, a, solver, now = self._scene, self._arrays, self.solver, self._now
        F = a.deformation_gradient.reshape(-1, 2, 2).copy()
        moved = a.position_velocity[:, :2] - self._X
        solver.advance(1)
        then = self._budget.moment(scene, self._X, solver.time)
        weights = StepWeights(scene, a, F, self._grid)
        at_rest = scene.frozen
        corners = self._lattice.place if at_rest else self._lattice.corners(moved, now.deformation_gradient)
        pieces = Pieces(self._lattice, corners, self._grid, a.cells_per_length, a.origin)
        particle = scene.velocity == "particle"
        given = sources(weights, pieces, now, then, self._material.stress(now.deformation_gradient), self._volume,
                        scene.time_step, particle, at_rest)
        if self._taken is not None:
            self._take_out(given, self._taken)
        self.causes.push(weights, self._material, F, now.deformation_gradient, self._volume, given, scene.time_step,
                         particle)
        self._now = then
        return solver.sound

    def _take_out(self, given: Sources, cause: int) -> None:
        """Of a step's sources those of a cause, from the run's particles and so from the errors."""
        a = self._arrays
        a.position_velocity[:, :2] -= given.position[cause]
        a.position_velocity[:, 2:] -= given.velocity[cause]
        a.deformation_gradient -= given.deformation_gradient[cause].reshape(-1, 4)
        for source in (given.position, given.velocity, given.deformation_gradient):
            source[cause] = 0.0


def series(solver: PlanarSolver, budget: PlanarBudget, steps: np.ndarray,
           on_progress: Callable[[float], None] | None = None) -> dict[str, np.ndarray]:
    """The budget's samples (``solvers.solver.samples.BUDGET``) after so many ``steps`` (T,), in rising order; NaN from
    where the run has gone bad."""
    out = {name: np.full(len(steps), np.nan) for name in BUDGET}
    run = BudgetOnDemand(solver, budget)
    for k, wanted in enumerate(steps):
        while solver.step < wanted:
            if not run.step():
                return out
        for name, value in sample(run).items():
            out[name][k] = value
        if on_progress:
            on_progress(float(wanted / max(1, steps[-1])))
    return out


def sample(run: BudgetOnDemand) -> dict[str, float]:
    """RMS errors, the signed part of each cause in them and the RMS of what it has made, by the names of samples."""
    found: dict[str, float] = {}
    for field in FIELDS:
        error, parts = run.errors()[field], run.causes.fields()[field]
        count = len(error)
        size = float(np.sqrt(np.sum(error**2) / count))
        found[f"budget/error_{field}"] = size
        for c, cause in enumerate(CAUSES):
            found[f"budget/part_{field}_{cause}"] = float(np.sum(parts[c] * error) / count / size) if size else 0.0
            found[f"budget/size_{field}_{cause}"] = float(np.sqrt(np.sum(parts[c] ** 2) / count))
    return found
