"""HistoryRunner: runs scenes one after the other for their error histories, several times as fast as ``run``.

Solvers are used again, and no particles are stored. Errors are those of ``run`` to the bit, and the status follows from
the same rules.
"""

from collections.abc import Callable
from dataclasses import replace
from time import thread_time

import numpy as np

from solvers.running.run import build
from solvers.scene.kernel_options import kernel_key
from solvers.scene.scene import Scene
from solvers.scene.validation import SceneError
from solvers.solver import samples
from solvers.solver.base import Solver
from solvers.solver.samples import QUANTITIES
from solvers.solver.soundness import LOST, OK, UNSTABLE, earliest_finding, findings
from solvers.study.landscape.error_history import REFUSED, TRUTH, ErrorHistory
from solvers.study.landscape.parameter_values import varied_scene

MOST_SOLVERS = 6  # that are kept, of as many compiled codes
SLICE_SECONDS = 0.03  # of a launch, which cannot be interrupted
EXPECTED_RATE = 2e7  # particle-steps per s, before the first measurement
LEAST_MEASURED, RATE_WEIGHT = 5e-4, 0.3  # seconds of a run that is a measurement; its weight in the mean


class HistoryRunner:
    """Runner of scenes in the neighbourhood of others, which have the same compiled code."""

    def __init__(self) -> None:
        self._solvers: dict[tuple, Solver] = {}  # by kernel key, the one used last at the end
        self._rates: dict[tuple, float] = {}  # by kernel key, in particle-steps per s

    def run(self, scene: Scene, parameter: str, value: float, until: float,
            goes_on: Callable[[], bool] = lambda: True) -> ErrorHistory | None:
        """Returns the history of a scene with another value of a parameter until a time in periods; None if a launch
        ends and ``goes_on()`` is false. Estimators that are not valid in the scene itself are left out."""
        try:
            wanted = replace(varied_scene(scene, parameter, value), estimators=scene.active_estimators, t_end=None,
                             periods=until, sample_every=None)
            solver = self._solver(scene, wanted)
        except SceneError:
            return ErrorHistory(np.inf, status=REFUSED, broken_at=0.0)
        key = kernel_key(solver.scene)
        rows = self._advance(solver, key, goes_on)
        return None if rows is None else _history(solver, rows, until, self._rates.get(key, np.nan))

    def _solver(self, scene: Scene, wanted: Scene) -> Solver:
        """Returns a solver of the scene ``wanted``, at its start, with the compiled code of ``scene`` if possible."""
        key = kernel_key(scene)
        solver = self._solvers.pop(key, None)
        if solver is None:
            solver = build(scene)
            solver.compile()  # not while it is timed
        self._solvers[key] = solver
        if len(self._solvers) > MOST_SOLVERS:
            del self._solvers[next(iter(self._solvers))]
        return solver if solver.restart(wanted, idle_estimators=True) else build(wanted)

    def _advance(self, solver: Solver, key: tuple, goes_on: Callable[[], bool]) -> np.ndarray | None:
        """Runs a solver to its scene's end; returns its rows of samples, with one of the end, or None."""
        rows, end, particles, begun = [], solver.scene.steps, solver.particles, thread_time()
        while solver.step < end and solver.sound:
            most = int(SLICE_SECONDS * self._rates.get(key, EXPECTED_RATE) / particles)
            rows.append(solver.advance(min(end - solver.step, max(1, most), solver.longest_advance), margins=False))
            if not goes_on():
                return None
        took = thread_time() - begun
        if took > LEAST_MEASURED:
            rate = particles * solver.step / took
            self._rates[key] = rate + (1 - RATE_WEIGHT) * (self._rates.get(key, rate) - rate)
        last = solver.measure()
        if solver.step % solver.scene.sample_interval or not len(rows[-1]):
            rows.append(last)
        else:
            rows[-1][-1:, samples.LOOKS] = last[:, samples.LOOKS]
        return np.concatenate(rows)


def _history(solver: Solver, rows: np.ndarray, until: float, rate: float) -> ErrorHistory:
    """Returns the history of a run from all its rows of samples; ``solver`` is at its end."""
    scene, options = solver.scene, solver.options
    names = samples.column_names(options.estimators, options.effects)
    own = [k for k, name in enumerate(names) if name.partition("/")[0] not in options.estimators
           or name.partition("/")[0] in scene.active_estimators]
    series = samples.read_rows(rows[:, own], scene, solver.particles)
    if scene.has("truth"):  # the balance of momentum only bounds what is known, and takes longer than a run
        series["motion_square"][:] = np.nan
    not_valid = solver.not_valid()
    finding = earliest_finding(findings(scene, series), not_valid)
    status = UNSTABLE if not solver.sound else LOST if finding else OK
    since = finding.time if finding else np.inf if solver.sound else solver.time
    kinds = {TRUTH: "error"} if scene.has("truth") else {}
    kinds |= {name: f"{name}/estimate" for name in scene.active_estimators if name not in not_valid}
    kept = rows[:, samples.column_index("step")] % scene.look_interval == 0
    kept[-1] = True
    errors = {source: np.fmax.accumulate([series[f"{kind}_{quantity}"] for quantity in QUANTITIES], axis=1)[:, kept]
              for source, kind in kinds.items()}
    sizes = np.array([scene.size_of(quantity) for quantity in QUANTITIES])
    return ErrorHistory(until if solver.sound else np.inf, series["time"][kept] / scene.period, errors, sizes, status,
                        since / scene.period, rate)
