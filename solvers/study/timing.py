"""How long a step takes: the fastest of several stretches of a compiled, warmed-up solver.

Other work on a machine only ever makes a stretch slower, so the fastest is the one to believe; and what is to be
compared takes turns, so that a slow spell slows all of it.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from solvers.solver import Solver

SECONDS = 0.01  # that a stretch takes at least: many times the cost of a launch


class Stretch:
    """Some steps of a solver, taken again and again from the same state.

    They are whole rounds of samples and of estimators, so that each stretch has its fair part of both.
    """

    def __init__(self, solver: Solver, seconds: float = SECONDS):
        self.solver = solver
        solver.advance(0)  # compiles
        self._clock = solver.clock
        self.steps = _round(solver)
        solver.advance(self.steps)
        self._put_back = solver.bookmark()
        while self.time() * self.steps < seconds and 2 * self.steps <= solver.longest_advance and solver.sound:
            self.steps *= 2

    def time(self) -> float:
        """Seconds a step, once more; NaN where the run goes bad, for then steps are skipped."""
        self._put_back()
        begun = self._clock()
        self.solver.advance(self.steps)
        took = self._clock() - begun
        return took / self.steps if self.solver.sound else np.nan


def _round(solver: Solver) -> int:
    """The fewest steps with a whole number of samples and of steps of each estimator."""
    whole = np.lcm.reduce([solver.scene.sample_interval, *solver.estimate_intervals])
    return min(int(whole), solver.longest_advance)


def take_turns(stretches: Sequence[Stretch], turns: int) -> np.ndarray:
    """Seconds a step of every stretch (columns) in every turn (rows)."""
    return np.array([[stretch.time() for stretch in stretches] for _ in range(turns)])


def rate(solver: Solver, turns: int = 5, seconds: float = SECONDS) -> float:
    """Million particle-steps per second of a solver; NaN if its run goes bad."""
    return 1e-6 * solver.scene.particles / float(take_turns([Stretch(solver, seconds)], turns).min())
