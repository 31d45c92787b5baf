"""Time per step, and the share of each estimator in it, measured with a compiled solver.

Other work on a machine can only slow a stretch of steps down, so the fastest stretch is the most reliable. Alternatives
run in turns, and are compared within each turn: the clock rate of a processor may change by half between turns, and the
fastest runs of two alternatives may then have different clock rates."""

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

MIN_SECONDS = 0.01  # minimum of a stretch: many times the cost of a launch
SHARE_SECONDS, LONGEST_SHARE_SECONDS, SHARE_TURNS = 0.006, 0.06, 9  # short, within a run that a user waits for


class RepeatedSteps:
    """A solver's steps, always the same from the same state, that take at least ``seconds``; a "stretch" below.

    The steps are whole rounds of estimators, samples and checks, so that each stretch contains its share of all; of
    estimators and samples, or estimators alone, where a round of the others takes more than ``longest`` seconds. A
    solver at step 0 is warmed up first. ``steps`` sets the number of steps, for comparison with another stretch.
    ``put_back`` restores the initial state of the solver, to the bit."""

    def __init__(self, solver: Solver, seconds: float = MIN_SECONDS, longest: float = math.inf, steps: int = 0):
        self.solver = solver
        alone = solver.plan == "serial" and solver.arch in PROCESSORS  # otherwise this thread waits for others
        # CPU time where one thread does everything, without other work on the machine; Windows has ticks of 1/64 s.
        self._clock = time.thread_time if alone and os.name != "nt" else time.perf_counter
        scene, most = solver.scene, solver.longest_advance
        rounds = [math.lcm(*solver.estimate_intervals)]  # of estimators, then with samples, then with margins
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
        a_step = self.seconds_per_step()
        for steps in rounds[1:]:
            if steps <= most and not a_step * steps > longest:
                self.steps = steps
        while self.seconds_per_step() * self.steps < seconds and 2 * self.steps <= most:
            self.steps *= 2
        self.put_back()

    def seconds_per_step(self, without: str | None = None) -> float:
        """Takes the steps again and returns the seconds that each took, optionally without the estimator of that name;
        NaN where the run becomes unstable, because steps are skipped then."""
        self.put_back()
        if without:
            self.solver.disable_estimator(without)
        begun = self._clock()
        self.solver.advance(self.steps)
        took = self._clock() - begun
        return took / self.steps if self.solver.sound else math.nan


def time_interleaved(stretches: Sequence[RepeatedSteps], turns: int) -> np.ndarray:
    """Returns the seconds per step (turns, stretches) of every stretch in every turn; stretches alternate."""
    return np.array([[stretch.seconds_per_step() for stretch in stretches] for _ in range(turns)])


def time_ratios(pairs: Mapping[Any, tuple[Scene, Scene]], turns: int) -> dict[Any, float]:
    """Returns, by a pair's name, time per step of its first scene over that of its second: median over turns."""
    scenes = list(dict.fromkeys(scene for pair in pairs.values() for scene in pair))
    solvers = [PROBLEMS[scene.problem].solver(scene) for scene in scenes]
    columns = time_interleaved([RepeatedSteps(solver) for solver in solvers], turns).T if scenes else ()
    seconds = dict(zip(scenes, columns, strict=True))
    return {name: float(np.median(seconds[one] / seconds[other])) for name, (one, other) in pairs.items()}


def particle_step_rate(solver: Solver, turns: int = 5, seconds: float = MIN_SECONDS) -> float:
    """Returns million particle-steps per second of a solver, the most of so many turns that take at least ``seconds``;
    NaN if its run becomes unstable."""
    return 1e-6 * solver.scene.particles / float(time_interleaved([RepeatedSteps(solver, seconds)], turns).min())


def estimator_shares(solver: Solver) -> dict[str, float]:
    """Measures each active estimator's share (0 to 1) of the running time, by name; {} if the run becomes unstable.

    The same steps are taken several times, from the present state: with the estimators; by a second solver without any,
    since even an inactive estimator stays in compiled code and slows it down; and, with several, with each one inactive
    in turn. The total cost comes from the first two, and is divided in proportion to the time saved without each.
    Samples are included. The state is restored, to the bit."""
    names = solver.scene.active_estimators
    if not names or not solver.sound or solver.scene.particles > MOST_PARTICLES:  # to have them twice
        return {}
    stretch = RepeatedSteps(solver, SHARE_SECONDS, LONGEST_SHARE_SECONDS)
    bare = RepeatedSteps(solver.without_estimators(), steps=stretch.steps)
    resting = names if len(names) > 1 else ()
    turns = [[stretch.seconds_per_step(), bare.seconds_per_step(),
              *map(stretch.seconds_per_step, resting)] for _ in range(SHARE_TURNS)]
    stretch.put_back()
    seconds = np.array(turns)
    saved = 1 - np.median(seconds[:, 1:] / seconds[:, :1], axis=0)
    if not np.isfinite(saved).all():
        return {}
    total, parts = max(0.0, float(saved[0])), np.maximum(saved[1:], 1e-3) if resting else np.ones(1)
    return {name: total * float(part) for name, part in zip(names, parts / parts.sum(), strict=True)}
