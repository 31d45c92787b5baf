"""Landscapes: each point is ``run`` of its scene, to the bit, and the points lie where the curve bends."""

import random
from dataclasses import replace

import numpy as np
import pytest

from solvers.problems.bar.scene import BarScene
from solvers.problems.ring import RingScene
from solvers.problems.square import SquareScene
from solvers.problems.vortex import VortexScene
from solvers.running.run import run
from solvers.scene.stabilisations import FROZEN, PIECES
from solvers.scene.validation import SceneError
from solvers.solver.samples import QUANTITIES
from solvers.solver.soundness import OK, UNSTABLE
from solvers.study.landscape import parameter_values
from solvers.study.landscape.error_history import REFUSED, TRUTH
from solvers.study.landscape.history_runner import HistoryRunner

BAR = BarScene(method="mpm", cells=40, ppc=4, amplitude=0.0034, estimators=("recovered",))
RING = RingScene(cells=12)
#: Of the random points: scenes, and how many of each.
SCENES = {
    "hats": (BAR, 12),
    "uGIMP": (replace(BAR, method="ugimp", estimators=BarScene.choices("estimators")), 10),
    "cpGIMP": (replace(BAR, method="cpgimp", estimators=("companion",), dt=1e-3), 6),
    "B-splines": (replace(BAR, method="bspline", estimators=("transport", "companion")), 6),
    "frozen": (replace(BAR, remedies=(FROZEN,), estimators=("companion",)), 4),
    "pieces": (replace(BAR, remedies=(PIECES,), estimators=("companion",)), 4),
    "patch test": (BarScene(motion="patch", method="mpm", cells=20, ppc=2.5, cfl=0.2), 4),
    "ring": (RING, 6), "hats on the ring": (replace(RING, method="mpm", estimators=("recovered", "companion")), 3),
    "square": (SquareScene(cells=12), 3), "vortex": (VortexScene(cells=16, ppc=2), 2)}
RANGES = {"amplitude": (1e-4, 0.15), "cells": (12, 60), "ppc": (1, 5), "cfl": (0.02, 2.0), "modulus": (1.0, 40.0)}
runner = HistoryRunner()


def assert_is_run(scene, parameter, value, until):
    """Compares the end of a history with ``run`` of the same scene; returns its status, "refused" for an invalid one."""
    history = runner.run(scene, parameter, value, until)
    try:
        there = replace(parameter_values.varied_scene(scene, parameter, value), periods=until, t_end=None)
    except SceneError:
        assert history.status == REFUSED
        return REFUSED
    result = run(there, mid_run=False)
    assert history.status == result.status, there
    if history.status == UNSTABLE:
        return UNSTABLE
    assert history.phase[-1] == result.time / there.period and history.until == until
    valid = [name for name in there.active_estimators
             if name in scene.active_estimators and name not in result.not_valid]
    assert [*history.errors] == [TRUTH, *valid]
    for source in history.errors:
        kind = "error" if source == TRUTH else f"{source}/estimate"
        expected = [result.series[f"{kind}_{quantity}"][-1] for quantity in QUANTITIES]
        np.testing.assert_array_equal(history.errors[source][-1], expected, err_msg=f"{source} of {there}")
    return history.status


@pytest.mark.parametrize("name", SCENES)
def test_random_points_are_runs(name):
    """Of all problems, methods and parameters, with and without remedies; hard ones, which break, are among them."""
    (scene, count), chance = SCENES[name], random.Random(name)
    planar, statuses = scene.DIMENSIONS == 2, []
    for _ in range(count):
        parameter = chance.choice(parameter_values.parameters_of(scene))
        low, high = RANGES[parameter]
        value = float(np.exp(chance.uniform(np.log(low), np.log(high))))
        if parameter in ("modulus", "amplitude") and planar:
            value *= getattr(scene, parameter) / (4.0 if parameter == "modulus" else 0.1)
        if parameter in ("cells", "ppc"):
            value = max(getattr(type(scene), "FEWEST_CELLS", 1) if parameter == "cells" else 1,
                        round(value / 2 if planar else value))
        statuses.append(assert_is_run(scene, parameter, value, chance.choice((0.05, 0.15) if planar else (0.1, 0.6))))
    assert OK in statuses
