"""Trials of what may help a broken run (``solvers.running.cures``): only what then ends as ok counts as held."""

import time
from collections.abc import Callable
from dataclasses import replace

from solvers.running.result import Result
from solvers.running.run import reuse_solvers, run
from solvers.scene.kernel_options import kernel_key
from solvers.scene.scene import Scene
from solvers.solver.soundness import BROKEN, OK

PATIENCE = 3.0  # times the run's own time, for all trials
LEAST_SECONDS = 1.0
BEYOND = 1.1  # times the moment of the break, at which a first, short run ends
WORTH_A_SHORT_RUN = 0.5  # of the run: it is made where the break came earlier


class _TimeIsUp(Exception):
    """Raised where the time for trials is over."""


def own_seconds(result: Result) -> float:
    """Returns the time in s that a run took to start, compile and step, and would take to its scene's own end."""
    seconds = result.seconds
    return seconds.setup + seconds.compile + seconds.run * result.scene.steps / max(1, result.steps)


def try_cures(result: Result, seconds: float | None = None, enough: int = 1,
              on_progress: Callable[[float, str], None] = lambda part, change: None) -> Result:
    """Returns the result of a broken run with its ``advice`` tried, the cheapest first, until ``enough`` of it held: in
    a run just past the moment of the break, and if that is ok in one to the scene's own end. A run that is ok stays as
    it is.

    Trials end after ``seconds``, by default three times what the run itself took or would take to its end, and a second
    at least; Ctrl-C ends them earlier. What was not tried until then remains so. ``on_progress`` is called several
    times a second with the part of the time that has gone, 0 to 1, and the change that is being tried, in words."""
    if result.status not in BROKEN or result.broken_at is None:
        return result
    reuse_solvers()
    limit = max(LEAST_SECONDS, PATIENCE * own_seconds(result)) if seconds is None else seconds
    pace = result.seconds.run / max(1, result.particles * result.steps)  # seconds a particle and step
    begun, cures = time.perf_counter(), list(result.advice)
    short_end, compiled = BEYOND * result.broken_at, {kernel_key(result.scene)}

    def ends_ok(scene: Scene, change: str) -> bool:
        def watch(_: float) -> None:
            gone = (time.perf_counter() - begun) / limit
            on_progress(min(1.0, gone), change)
            if gone > 1:
                raise _TimeIsUp

        watch(0.0)
        return run(scene, on_progress=watch, mid_run=False).status == OK

    try:
        for k, cure in enumerate(cures):
            scene = replace(result.scene, **cure.change)
            key = kernel_key(scene)
            compiling = 0.0 if key in compiled else result.seconds.compile
            if begun + limit < time.perf_counter() + compiling + pace * scene.particles * scene.steps:
                continue  # a cheaper one may follow: an earlier end
            compiled.add(key)
            ends = [replace(scene, t_end=short_end, periods=None)] \
                if result.broken_at < WORTH_A_SHORT_RUN * scene.end_time else []
            cures[k] = replace(cure, tried=True, held=all(ends_ok(one, cure.text) for one in (*ends, scene)))
            if sum(one.held for one in cures) >= enough:
                break
    except (_TimeIsUp, KeyboardInterrupt):
        pass
    return replace(result, advice=tuple(cures))
