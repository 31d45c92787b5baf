"""The error of a run's end, traced back over the material and time.

One number of the end, J = <z, e>, an error of a particle, or the RMS error with z = e/(P |e|), is traced back step by
step (``transpose``), and what each particle has added to it in each step is a term of a sum that is J to round-off. The
force that a particle's stress makes at nodes belongs to that particle, its maker, and not to those that feel it: of the
two forces of a pair only the difference matters, and it stays where it was made.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from solvers.problems.bar.error_map.recorded import MOST_KEPT, record
from solvers.problems.bar.error_map.transpose import Back
from solvers.problems.bar.scene import BarScene
from solvers.scene.causes import CAUSES, FIELDS, NOTHING
from solvers.scene.remedies import FROZEN, PIECES
from solvers.scene.rules import SceneError, require_choice
from solvers.solver.error_map import ErrorMap


def error_map(scene: BarScene, field: str = "x", particle: int | None = None,
              on_progress: Callable[[float], None] | None = None) -> ErrorMap | None:
    """Run a scene and trace the error of its end back; None where the run goes bad.

    Raises:
        SceneError: a field, a particle or a scene that has no map.
    """
    check_map(scene, field, particle)
    scene = replace(scene, effects=("truth",), estimators=(), take_away=NOTHING)
    run = record(scene, on_progress and (lambda part: on_progress(0.7 * part)))
    if run is None:
        return None
    f, P, n = FIELDS.index(field), scene.particles, len(run.steps)
    unit = 1 / run.numbers.unstretched if field == "F" else 1.0
    error = unit * run.error[f]
    size = float(np.sqrt(np.mean(error**2))) if particle is None else float(error[particle])
    z = np.zeros((3, P))
    z[f] = unit * (error / (P * (size or 1.0)) if particle is None else np.arange(P) == particle)
    made = np.zeros((n, len(CAUSES), P))
    for k in range(n - 1, -1, -1):
        z, made[k] = Back(run, run.steps[k]).pull(z)
        if on_progress and k % 100 == 0:
            on_progress(1 - 0.3 * k / n)
    times = scene.time_step * np.arange(1, n + 1)
    places = np.array([np.floor(at * scene.cells) for at in (*(step.position for step in run.steps), run.position)])
    when, who = np.nonzero(np.diff(places, axis=0))
    return ErrorMap(scene, field, particle, size, made, run.numbers.X, times,
                    np.stack([times[when], run.numbers.X[who]], axis=1))


def check_map(scene: BarScene, field: str, particle: int | None) -> None:
    """Refuse what has no map."""
    require_choice("field", field, FIELDS)
    if particle is not None and not (isinstance(particle, int) and 0 <= particle < scene.particles):
        raise SceneError("particle", particle, f"give one of the scene's, from 0 to {scene.particles - 1}")
    if not scene.solution_known:
        raise SceneError("body_force", scene.body_force, "has no known solution, and without one there is no error to "
                         "map; give material, node or none")
    if scene.take_away != NOTHING:
        raise SceneError("take_away", scene.take_away, "a run without a cause has no map; leave it out")
    if others := [name for name in scene.remedies if name not in (FROZEN, PIECES)]:
        raise SceneError("remedies", " ".join(scene.remedies), f"a map goes back through the method alone, and not "
                         f"through {others[0]}; leave it out, or take {FROZEN} or {PIECES}")
    if scene.steps * scene.particles > MOST_KEPT:
        raise SceneError("periods", scene.periods, f"a map keeps every step of every particle, at most {MOST_KEPT:,} "
                         f"together, and here they are {scene.steps * scene.particles:,}; end earlier or take longer "
                         "steps")
