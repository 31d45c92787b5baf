"""How long a step takes, and which share of it an estimator, measured with a compiled solver.

Other work on a machine only ever makes a stretch of steps slower, so the fastest is the one to believe. What is to be
compared takes turns, and is compared within each turn: a processor may change its speed by half as much again between
one turn and the next, and the fastest of two things may then be of two speeds.
"""

import math
import os
import time
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from solvers.kernels.runtime import PROCESSORS
from solvers.problems import PROBLEMS
from solvers.scene.scene import MOST_PARTICLES, Scene
from solvers.solver.base import Solver

MIN_SECONDS = 0.01  # that a stretch takes at least: many times the cost of a launch
SHARE_SECONDS, LONGEST_SHARE_SECONDS, SHARE_TURNS = 0.006, 0.06, 9  # within a run that somebody waits for


class TimedSteps:
    """Some steps of a solver, taken again and again from the same state, for ``seconds`` at least.

    They are whole rounds of estimators, samples and looks at the run, so that each stretch has its fair part of all; of
    estimators and samples, or estimators alone, where the others are so rare that a round of them takes more than
    ``longest`` seconds. A solver that has not begun is warmed up first. ``steps`` are given where they must be another
    stretch's. The solver is left in the state in which it came, to which ``put_back`` brings it back, to the bit.
    """

    def __init__(self, solver: Solver, seconds: float = MIN_SECONDS, longest: float = math.inf, steps: int = 0):
        self.solver = solver
        alone = solver.plan == "serial" and solver.arch in PROCESSORS  # others work while this thread waits
        # The processor's own time where one thread does it all, so that what else runs on the machine is not counted;
        # Windows counts that in ticks of 1/64 s.
        self._clock = time.thread_time if alone and os.name != "nt" else time.perf_counter
        scene, most = solver.scene, solver.longest_advance
        rounds = [math.lcm(*solver.estimate_intervals)]  # of ever more of what is not done in each step
        for interval in (scene.sample_interval, scene.margin_interval):
            rounds.append(math.lcm(rounds[-1], interval))
        solver.advance(0)  # compiles
        if not solver.step:
            solver.advance(min(rounds[1], most))
        self.put_back = solver.bookmark()
        if steps:
            self.steps = steps
            return
        self.steps = min(rounds[0], most)
        a_step = self.time()
        for steps in rounds[1:]:
            if steps <= most and not a_step * steps > longest:
                self.steps = steps
        while self.time() * self.steps < seconds and 2 * self.steps <= most:
            self.steps *= 2
        self.put_back()

    def time(self, without: str | None = None) -> float:
        """Seconds a step, once more, on request without one of the estimators; NaN where the run goes bad, for then
        steps are skipped."""
        self.put_back()
        if without:
            self.solver.leave_out(without)
        begun = self._clock()
        self.solver.advance(self.steps)
        took = self._clock() - begun
        return took / self.steps if self.solver.sound else math.nan


def time_interleaved(stretches: Sequence[TimedSteps], turns: int) -> np.ndarray:
    """Seconds a step of every stretch (columns) in every turn (rows)."""
    return np.array([[stretch.time() for stretch in stretches] for _ in range(turns)])


def time_ratios(pairs: Mapping[Any, tuple[Scene, Scene]], turns: int) -> dict[Any, float]:
    """How many times as long a step of the one takes as of the other, by name: the median over turns."""
    scenes = list(dict.fromkeys(scene for pair in pairs.values() for scene in pair))
    solvers = [PROBLEMS[scene.problem].solver(scene) for scene in scenes]
    columns = time_interleaved([TimedSteps(solver) for solver in solvers], turns).T if scenes else ()
    seconds = dict(zip(scenes, columns, strict=True))
    return {name: float(np.median(seconds[one] / seconds[other])) for name, (one, other) in pairs.items()}


def particle_step_rate(solver: Solver, turns: int = 5, seconds: float = MIN_SECONDS) -> float:
    """Million particle-steps per second of a solver; NaN if its run goes bad."""
    return 1e-6 * solver.scene.particles / float(time_interleaved([TimedSteps(solver, seconds)], turns).min())


def estimator_shares(solver: Solver) -> dict[str, float]:
    """The share of the whole running time that each active estimator takes, measured here and now; none if the run goes
    bad.

    The same steps are taken several times, from the present state: with the estimators; by a second solver that has
    none, since an estimator that only rests stays in compiled code and makes that slower; and, of several, with each
    one resting in turn. What all cost together comes from the first two, and is divided as the resting ones saved.
    Samples are included. The state is put back, to the bit.
    """
    names = solver.scene.active_estimators
    if not names or not solver.sound or solver.scene.particles > MOST_PARTICLES:  # to have them twice
        return {}
    stretch = TimedSteps(solver, SHARE_SECONDS, LONGEST_SHARE_SECONDS)
    bare = TimedSteps(solver.without_estimators(), steps=stretch.steps)
    resting = names if len(names) > 1 else ()
    turns = [[stretch.time(), bare.time(), *map(stretch.time, resting)] for _ in range(SHARE_TURNS)]
    stretch.put_back()
    seconds = np.array(turns)
    saved = 1 - np.median(seconds[:, 1:] / seconds[:, :1], axis=0)
    if not np.isfinite(saved).all():
        return {}
    total, parts = max(0.0, float(saved[0])), np.maximum(saved[1:], 1e-3) if resting else np.ones(1)
    return {name: total * float(part) for name, part in zip(names, parts / parts.sum(), strict=True)}
