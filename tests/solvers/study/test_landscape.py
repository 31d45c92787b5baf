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
from solvers.solver.soundness import LOST, OK, UNSTABLE
from solvers.study.landscape import parameter_values
from solvers.study.landscape.error_history import REFUSED, TRUTH, ErrorHistory, HistoryCache
from solvers.study.landscape.history_runner import HistoryRunner
from solvers.study.landscape.landscape import COSTLY, PENDING, LandscapeRequest, assemble_landscape, choose_costly

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
    """Compares a history with ``run`` of the same scene; returns its status, "refused" for an invalid one."""
    history = runner.run(scene, parameter, value, until)
    try:
        there = replace(parameter_values.varied_scene(scene, parameter, value), periods=until, t_end=None)
    except SceneError:
        assert history.status == REFUSED
        return REFUSED
    result = run(there, mid_run=False)
    assert history.status == result.status, there
    assert history.status == OK or history.broken_at == result.broken_at / there.period
    if history.status == UNSTABLE:
        return UNSTABLE
    assert history.phase[-1] == result.time / there.period and history.until == until
    valid = [name for name in there.active_estimators
             if name in scene.active_estimators and name not in result.not_valid]
    assert [*history.errors] == [TRUTH, *valid]
    for source in history.errors:
        kind = "error" if source == TRUTH else f"{source}/estimate"
        expected = [np.nanmax(result.series[f"{kind}_{quantity}"]) for quantity in QUANTITIES]
        np.testing.assert_array_equal(history.errors[source][:, -1], expected, err_msg=f"{source} of {there}")
    return history.status


@pytest.mark.parametrize(("scene", "parameter", "value", "status"), [
    (BAR, "amplitude", 0.005, OK), (BAR, "cells", 36, OK), (BAR, "cfl", 1.2, UNSTABLE), (BAR, "cfl", 0.9, LOST),
    (BAR, "amplitude", 0.2, REFUSED), (replace(BAR, dt=1e-3), "modulus", 900.0, UNSTABLE)])
def test_points_are_runs(scene, parameter, value, status):
    assert assert_is_run(scene, parameter, value, 0.8) == status


def test_estimators_that_do_not_hold_in_a_point_stand_still():
    """They are in the compiled code of the scene on the stage; the point itself is a run without them."""
    scene = replace(BAR, method="cpgimp", estimators=("companion", "two-grid"))
    assert scene.active_estimators == ("companion", "two-grid")
    assert replace(scene, cells=12).active_estimators == ("companion",)
    assert assert_is_run(scene, "cells", 12, 0.3) == OK
    assert list(runner.run(scene, "cells", 12, 0.3).errors) == [TRUTH, "companion"]


def test_a_point_that_is_outdated_is_given_up():
    assert runner.run(BAR, "amplitude", 0.01, 0.3, lambda: False) is None


@pytest.mark.parametrize("name", SCENES)
def test_random_points_are_runs(name):
    """Of all problems, methods and parameters, with and without remedies."""
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


def test_a_run_that_breaks_has_errors_until_then():
    """In the size of each quantity, and at the moment itself none."""
    broken = ErrorHistory(2.0, np.array([0.0, 1.0, 2.0]), {TRUTH: np.outer([1.0, 2.0, 3.0, 4.0], [0.0, 1.0, 8.0])},
                          np.array([10.0, 100.0, 1.0, 1.0]), UNSTABLE, 1.5)
    assert [broken.largest_error(TRUTH, quantity, 1.0) for quantity in ("x", "v")] == [0.1, 0.02]
    assert np.isnan(broken.largest_error(TRUTH, "x", 1.5))
    assert [broken.status_at(until) for until in (1.49, 1.5)] == [OK, UNSTABLE]


def test_an_earlier_time_is_looked_up():
    """One run until a whole period knows the largest errors of shorter ones, and when it broke."""
    long = runner.run(BAR, "amplitude", 0.14, 1.0)
    for until in (0.2, 0.35):
        short = runner.run(BAR, "amplitude", 0.14, until).largest_error(TRUTH, "x", until)
        # Between samples it is interpolated, and the error grows by a few per cent from one to the next.
        assert long.largest_error(TRUTH, "x", until) == pytest.approx(short, rel=0.1)
    assert (np.diff(long.errors[TRUTH], axis=1) >= 0).all()  # the largest so far, of every quantity
    assert long.status == LOST and long.status_at(0.9 * long.broken_at) == OK
    assert np.isnan(long.largest_error("companion", "x", 0.5))


@pytest.mark.parametrize("scene", [BAR, replace(RING, estimators=()), SquareScene(cells=12, estimators=())],
                         ids=["bar", "ring", "square"])
def test_the_modulus_changes_units_alone(scene):
    """With a CFL number, at equal phase; not in the vortex, whose frequency is its own."""
    assert not parameter_values.has_effect(scene, "modulus")
    assert parameter_values.has_effect(VortexScene(), "modulus")
    assert parameter_values.has_effect(replace(scene, dt=1e-4 * scene.period), "modulus")
    here, stiffer = (runner.run(scene, "modulus", share * scene.modulus, 0.1) for share in (1, 10))
    for quantity in QUANTITIES:
        found, expected = (one.largest_error(TRUTH, quantity, 0.1) for one in (stiffer, here))
        assert found == pytest.approx(expected, rel=1e-9)  # rounding


def test_the_first_crossing_is_that_of_the_exact_motion():
    """Of particles h/8 from the border of a cell: one of 160 is near the maximum of the sine."""
    first = parameter_values.first_crossing(BAR, 0.25)
    assert first == pytest.approx(BAR.spacing / 8, rel=2e-3)
    values = tuple(range(20, 60))
    assert parameter_values.first_crossing_value(BAR, "cells", values, 0.25) == 37
    assert parameter_values.first_crossing_value(BAR, "ppc", (1, 2, 3, 4), 0.25) == 4
    assert parameter_values.first_crossing_value(BAR, "cfl", (0.1, 0.2), 0.25) is None
    vortex = VortexScene()  # does not scale with its amplitude
    first = parameter_values.first_crossing(vortex, 0.25)
    assert parameter_values.crossing_share(replace(vortex, amplitude=first), 0.25) == pytest.approx(1, rel=2e-3)


def test_points_lie_where_the_curve_bends():
    def values(parameter, reach, scene=BAR):
        return parameter_values.choose_values(scene, parameter, reach, 0.25)

    amplitudes = values("amplitude", (1e-4, 0.2, 0.0))
    assert 0.0034 in amplitudes and len([A for A in amplitudes if 0.003 < A < 0.0037]) >= 4
    assert {36, 37, 40} <= set(values("cells", (8, 160, 1)))
    assert values("ppc", (1, 8, 1)) == tuple(range(1, 9))
    assert values("modulus", (1.0, 1000.0, 0.0)) == (4.0,)
    assert len(values("modulus", (1.0, 1000.0, 0.0), replace(BAR, dt=1e-3))) > 15
    assert set(values("cells", (12, 96, 6), RING)) <= set(range(12, 97, 6))
    automatic = values("amplitude", (1e-4, 0.2, 0.0), replace(BAR, dt="auto"))  # each has a step bound of its own
    assert len(automatic) < 8 and 0.0034 in automatic
    assert parameter_values.point_levels(range(10), 6) == [0, 2, 1, 2, 0, 2, 0, 2, 0, 0]


def test_the_place_of_a_cliff_is_halved():
    assert parameter_values.values_at_cliff((1.0, 2.0, 4.0), (OK, OK, LOST)) == (2.83,)
    assert parameter_values.values_at_cliff((1.0, 2.0), (OK, PENDING)) == ()
    assert parameter_values.values_at_cliff((1.0, 1.001), (OK, UNSTABLE)) == ()


def test_equal_runs_have_equal_keys():
    """Whichever slider was moved, and however long they are; the time step may be given or the default."""
    key, other = parameter_values.history_key, replace(BAR, cells=50, periods=2)
    assert key(BAR, "cells", 50) == key(other, "cells", 50) == key(replace(other, cfl=0.05), "amplitude", 0.0034)
    assert key(BAR, "cfl", 0.05) == key(BAR, "cells", 40) != key(BAR, "cells", 41)
    assert key(BAR, "cells", 40) != key(replace(BAR, estimators=()), "cells", 40)


def test_a_landscape_says_what_is_known():
    request = LandscapeRequest(BAR, "cells", 0.25, "sigma", "recovered", (8, 160, 1))
    history = runner.run(BAR, "cells", 40, 0.25)
    found = assemble_landscape(request, (20, 40, 60, 80), (None, history, ErrorHistory(np.inf, status=REFUSED), None),
                               (False, False, False, True), 1e7)
    assert found.status == (PENDING, OK, REFUSED, COSTLY) and not found.complete and not found.flat
    assert found.true[1] == history.largest_error(TRUTH, "sigma", 0.25) and np.isnan(found.true[0])
    assert 0.05 < found.estimated[1] < found.true[1] < 0.07
    assert found.seconds[3] == pytest.approx(4 * found.seconds[1]) and found.first_crossing == 40
    done = assemble_landscape(replace(request, parameter="cfl"), (0.05,), (history,), (False,), 1e7)
    assert done.complete and 0.5 < done.step_bound < 1.0


def test_what_is_too_dear_is_left_out():
    assert choose_costly([0.5, 0.1, 0.2, 0.4, 0.1], most=0.9, most_each=0.3) == [False, False, False, True, False]


def test_the_cache_keeps_the_longest(monkeypatch):
    monkeypatch.setattr("solvers.study.landscape.error_history.MOST_HISTORIES", 2)
    cache, long = HistoryCache(), ErrorHistory(1.0)
    cache.put([("a", long), ("a", ErrorHistory(0.5)), ("b", long), ("c", long)])
    assert cache.get("a") is None and cache.get("b") is long and cache.get("c") is long


@pytest.mark.parametrize(("parameter", "value"), [("cells", 80), ("ppc", 2), ("amplitude", 0.01), ("modulus", 16.0),
                                                  ("cfl", 0.2)])
@pytest.mark.parametrize("step", [{"dt": 1e-3}, {"cfl": 0.1}])
@pytest.mark.parametrize("kind", [BarScene, SquareScene])
def test_the_work_of_a_value_is_that_of_its_own_scene(parameter, value, step, kind):
    """With a fixed step a stiffer body, whose periods are shorter, takes fewer steps for as many of them."""
    scene = kind(cells=40, ppc=4, amplitude=0.02, modulus=4.0, **step)
    if parameter not in parameter_values.parameters_of(scene):
        pytest.skip("not a parameter of a fixed step")
    changed = parameter_values.varied_scene(scene, parameter, value)
    found, own = (parameter_values.particle_steps(one, parameter, value, 2.0) for one in (scene, changed))
    assert found == pytest.approx(own, rel=1e-9)
