"""The budget of a run in the plane, on demand: the usual solver step by step, and the causes' errors beside it."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from solvers.motion.laws.stress_difference import StressDifference
from solvers.problems.planar.budget import cause_errors
from solvers.problems.planar.budget.body_pieces import MovedBodyPieces, PieceLattice
from solvers.problems.planar.budget.cause_errors import LOCAL_CAUSES, TIME_STEP, StepErrorSources, step_error_sources
from solvers.problems.planar.budget.exact_state import ExactState, exact_state_at
from solvers.problems.planar.solver import PlanarSolver
from solvers.problems.planar.step_weights import MirroredNodeGrid, StepWeights
from solvers.scene.error_causes import CAUSES, FIELDS, NOTHING
from solvers.scene.stabilisations import FROZEN
from solvers.scene.validation import SceneError, require_choice
from solvers.solver.base import Solver
from solvers.solver.error_series import IGNORE_OVERFLOW
from solvers.solver.samples import BUDGET
from solvers.translatable_message import Message


@dataclass(frozen=True)
class PlanarBudget:
    """Error budgets of the runs of a plane problem with this ``solver``."""

    solver: type[PlanarSolver]

    def require_budget(self, scene: Any, take_away: str = NOTHING) -> None:
        """Raises :class:`SceneError` where a scene has no budget, or where there is no cause ``take_away``."""
        require_choice("take_away", take_away, (NOTHING, *CAUSES))
        if not scene.solution_known:
            raise SceneError("body_force", scene.body_force, "leaves no exact solution to compare the {problem} with, "
                             "which a budget needs; give material", Message(scene.problem))
        others = [name for name in scene.remedies if name != FROZEN]
        if others:
            raise SceneError("remedies", " ".join(scene.remedies), "{others} changes the particles by more than a "
                             "step, which the budget of the {problem} does not follow; give none or {frozen}",
                             others[0], Message(scene.problem), FROZEN)
        if scene.prefers_gpu:
            raise SceneError("arch", scene.arch, "steps faster than a budget follows, which is made on the processor; "
                             "give cpu")

    def budget_series(self, scene: Any, steps: np.ndarray, take_away: str = NOTHING,
                      on_progress: Callable[[float], None] | None = None) -> tuple[dict[str, np.ndarray], Solver]:
        """Returns the budget's samples (T,) by key (``solvers.solver.samples.BUDGET``) after the numbers of ``steps``
        (T,), which increase, NaN once the run is unstable; and the solver at the end. The run lacks the effect of the
        cause ``take_away``; ``on_progress`` is called with the part done, 0 to 1."""
        bare = replace(scene, effects=(), estimators=(), plan="serial", threads=1)
        run = CauseTrackingRun(self.solver(bare), take_away)
        out = {name: np.full(len(steps), np.nan) for name in BUDGET}
        for k, wanted in enumerate(steps):
            while run.solver.step < wanted:
                if not run.step():
                    run.solver.measure()  # which checks the particles
                    return out, run.solver
                if on_progress:
                    on_progress(run.solver.step / float(steps[-1]))
            for name, value in sample_budget(run).items():
                out[name][k] = value
        return out, run.solver


class CauseTrackingRun:
    """The run of a ``solver`` from its start, and the errors that each cause makes in it; the contribution of the cause
    ``take_away``, one of ``CAUSES``, is removed from the run, exactly."""

    def __init__(self, solver: PlanarSolver, take_away: str = NOTHING):
        self.solver, self._scene, self._arrays = solver, solver.scene, solver._arrays
        scene = solver.scene
        a = solver._arrays
        self._X, self._volume = a.material_position, a.mass / a.density
        self._grid = MirroredNodeGrid(a.row, solver.PARTS.traits.first, scene.PLANES[1])
        self._lattice = PieceLattice(scene)
        self._material = StressDifference(scene.material, at_rest=scene.frozen)
        self._now: ExactState = exact_state_at(scene, a, 0.0)
        self._removed_cause = LOCAL_CAUSES.index(take_away) if take_away in LOCAL_CAUSES else None
        self.causes = cause_errors.CauseErrors(len(self._X))
        # A run may begin with the velocity of half a step before, for the sake of how it steps.
        self.causes.velocity[TIME_STEP] = a.position_velocity[:, 2:] - self._now.velocity
        if self._removed_cause == TIME_STEP:
            a.position_velocity[:, 2:] = self._now.velocity
            self.causes.velocity[TIME_STEP] = 0.0

    def true_errors(self) -> dict[str, np.ndarray]:
        """Returns the run's true errors now: "x" in m, "v" in m/s (P, 2) and "F" (P, 2, 2)."""
        q, now = self._arrays.position_velocity, self._now
        return {"x": q[:, :2] - self._X - now.displacement, "v": q[:, 2:] - now.velocity,
                "F": self._arrays.deformation_gradient.reshape(-1, 2, 2) - now.deformation_gradient}

    @IGNORE_OVERFLOW
    def step(self) -> bool:
        """Takes one step of run and errors; returns False where the run is unstable, and then leaves the errors."""
        scene, a, now = self._scene, self._arrays, self._now
        F = a.deformation_gradient.reshape(-1, 2, 2).copy()
        corners = self._lattice.place if scene.frozen else \
            self._lattice.corners(a.position_velocity[:, :2] - self._X, now.deformation_gradient)
        place = corners * a.cells_per_length + a.origin
        self.solver.advance(1)
        if not (self.solver.sound and np.all((place > 0) & (place < a.row - 1)) and np.all(np.linalg.det(F) > 0)):
            return False
        then = exact_state_at(scene, a, self.solver.time)
        weights = StepWeights(scene, a, F, self._grid)
        pieces = MovedBodyPieces(self._lattice, corners, self._grid, place)
        particle = scene.velocity == "particle"
        sources = step_error_sources(weights, pieces, now, then, self._material.stress(now.deformation_gradient),
                                     self._volume, scene.time_step, particle, scene.frozen)
        if self._removed_cause is not None:
            self._remove_cause(sources, self._removed_cause)
        self.causes.propagate(weights, self._material, F, now.deformation_gradient, self._volume, sources,
                              scene.time_step, particle)
        self._now = then
        return True

    def _remove_cause(self, sources: StepErrorSources, cause: int) -> None:
        """Subtracts the ``sources`` of ``cause``, an index, in one step from the run's particles, and zeros them."""
        a = self._arrays
        a.position_velocity[:, :2] -= sources.position[cause]
        a.position_velocity[:, 2:] -= sources.velocity[cause]
        a.deformation_gradient -= sources.deformation_gradient[cause].reshape(-1, 4)
        for source in (sources.position, sources.velocity, sources.deformation_gradient):
            source[cause] = 0.0


@IGNORE_OVERFLOW
def sample_budget(run: CauseTrackingRun) -> dict[str, float]:
    """Returns by sample name RMS errors of x (m), v (m/s) and F, each cause's signed part, and its own RMS error."""
    numbers: dict[str, float] = dict.fromkeys(BUDGET, 0.0)
    for field in FIELDS:
        error, parts = run.true_errors()[field], run.causes.fields()[field]
        count = len(error)
        size = float(np.sqrt(np.sum(error**2) / count))
        numbers[f"budget/error_{field}"] = size
        for c, cause in enumerate(LOCAL_CAUSES):
            numbers[f"budget/part_{field}_{cause}"] = float(np.sum(parts[c] * error) / count / size) if size else 0.0
            numbers[f"budget/size_{field}_{cause}"] = float(np.sqrt(np.sum(parts[c] ** 2) / count))
    return numbers
