"""A solver that is restarted is a new one, to the bit, whatever it has run before."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings

from solvers.kernels import runtime
from solvers.problems import PROBLEMS
from solvers.problems.bar.scene import BarScene
from solvers.problems.ring import RingScene
from solvers.problems.vortex import VortexScene
from solvers.running import run as run_module
from solvers.running.run import build, run
from solvers.scene.kernel_options import kernel_key
from solvers.scene.scene import Scene
from solvers.scene.stabilisations import FROZEN
from solvers.scene.validation import SceneError
from solvers.solver import state_arrays
from solvers.solver.base import Solver
from tests.support.random_scenes import ASKED, RARE, inputs, switch_sets

MOST_STEPS = 400
PAIRS_A_SET = 6  # of random scenes

BAR = BarScene(cells=20, method="mpm", amplitude=0.01, periods=0.5, estimators=BarScene.choices("estimators"))
RING = RingScene(cells=12, periods=0.25)
UNSTABLE = {"cfl": 3.0, "dt": None, "amplitude": 0.1}


def outcome(solver: Solver) -> Iterator[tuple[str, Any]]:
    """Runs a solver that has taken no step; yields all that it then says, with names."""
    solver.compile()
    yield "start", solver.measure()
    for steps in (1, 7, 150, MOST_STEPS):
        steps = min(steps, solver.scene.steps - solver.step, solver.longest_advance)
        if solver.sound and steps > 0:
            yield f"rows after {solver.step}", solver.advance(steps)
    yield "end", solver.measure()
    shot = solver.snapshot(differences=True, plotted="sigma")
    yield from ((f"snapshot {name}", value) for name, value in vars(shot).items())
    yield "verdict", (solver.step, solver.time, solver.sound, solver.bytes, solver.scene, solver.estimate_intervals)
    yield "not valid", {name: str(reason) for name, reason in solver.not_valid().items()}
    yield "reason", None if solver.sound else str(solver.reason())
    fields = solver.fields()
    yield from ((f"fields {name}", value) for name, value in vars(fields).items())
    yield from solver._arrays.members().items()


def assert_new(solver: Solver, scene: Scene) -> None:
    """Restarts a solver with a scene, and compares it with a new one."""
    assert solver.restart(scene) and solver.step == 0
    for (name, restarted), (_, new) in zip(outcome(solver), outcome(build(scene)), strict=True):
        np.testing.assert_equal(restarted, new, err_msg=f"{name} of {scene}")


@pytest.mark.parametrize("switches", [
    pytest.param(switches, marks=pytest.mark.slow if switches in RARE and not ASKED else (), id=str(switches))
    for switches in switch_sets()])
def test_a_restarted_random_scene_is_a_new_one(switches):
    """Whatever their sizes; hard ones, which go unstable, are among them. Other estimators may hold in the second."""
    restarted = []

    @settings(max_examples=PAIRS_A_SET, derandomize=ASKED is None, database=None, deadline=None,
              suppress_health_check=list(HealthCheck))
    @given(inputs(switches), inputs(switches))
    def is_new(one, other):
        first, second = (PROBLEMS[switches["problem"]].scene(**drawn) for drawn in (one, other))
        solver = build(first)
        list(outcome(solver))
        if kernel_key(second) != kernel_key(first):
            assert not solver.restart(second) and solver.scene == first
            return
        assert_new(solver, second)
        assert_new(solver, first)
        restarted.append(second)

    is_new()
    assert restarted


@pytest.mark.parametrize(("scene", "changes"), [
    (replace(BAR, estimators=("companion", "transport")),
     ({"cells": 33, "ppc": 2}, {"cells": 6}, UNSTABLE, {}, {"modulus": 50.0, "cells": 80}, {"cells": 79})),
    (replace(BAR, estimators=("recovered", "companion"), effects=BarScene.choices("effects")),
     ({"take_away": "crossings"}, {"cells": 30}, {"cells": 9, "amplitude": 0.05}, {})),
    (replace(BAR, estimators=("companion",), remedies=(FROZEN,)), ({"cells": 50}, {"ppc": 1}, UNSTABLE, {})),
    (RING, ({"cells": 24}, {"cells": 9, "amplitude": 0.02}, UNSTABLE, {}, {"cells": 25})),
    pytest.param(replace(RING, estimators=RingScene.choices("estimators"), effects=RingScene.choices("effects")),
                 ({"cells": 18}, {"cells": 10, "amplitude": 0.02}, {}), marks=pytest.mark.slow),
    (VortexScene(cells=16, t_end=0.1, estimators=()), ({"cells": 24}, {"ppc": 3}, {})),
], ids=["bar", "budget", "frozen", "ring", "all of the ring", "vortex"])
def test_scenes_in_turn(scene, changes):
    """Larger and smaller ones, and after an unstable run; arrays grow and stay."""
    solver = build(scene)
    list(outcome(solver))
    for change in changes:
        assert_new(solver, replace(scene, **change))


def test_a_restart_keeps_the_arrays_and_their_launches():
    """Unless a scene needs more room: then there is some to spare, and what is far too large is given back."""
    solver = build(BAR)
    solver.compile()
    stepping, position = solver._stepping, solver._arrays.position
    assert solver.restart(replace(BAR, cells=10)) and solver._stepping is stepping
    assert np.shares_memory(solver._arrays.position, position) and len(solver._arrays.position) < len(position)
    assert solver.restart(replace(BAR, cells=40)) and solver._stepping is not stepping
    solver.compile()
    stepping = solver._stepping
    assert solver.restart(replace(BAR, cells=45)) and solver._stepping is stepping


def test_far_too_large_arrays_are_given_back(monkeypatch):
    solver = build(replace(BAR, cells=200))
    large = sum(buffer.nbytes for buffer in solver._buffers.arrays.values())
    monkeypatch.setattr(state_arrays, "MOST_SPARE_BYTES", large // 4)
    assert_new(solver, BAR)
    assert sum(buffer.nbytes for buffer in solver._buffers.arrays.values()) == solver.bytes


def test_what_needs_a_new_solver_is_refused(monkeypatch):
    """Other options, another plan, too many particles and a GPU: the run that is there goes on."""
    bar, ring = build(BAR), build(RING)
    for solver, scene in ((bar, replace(BAR, method="ugimp")), (bar, replace(BAR, effects=("truth",))), (bar, RING),
                          (bar, replace(BAR, estimators=())), (ring, replace(RING, plan="parallel", threads=2))):
        before = solver.state()[1]
        assert not solver.restart(scene)
        np.testing.assert_equal(solver.state()[1], before)
    monkeypatch.setattr("solvers.problems.planar.solver.MOST_PARTICLES", 10)
    with pytest.raises(SceneError):
        ring.restart(RING)
    monkeypatch.setattr(ring, "plan", "gpu")
    assert not ring.restart(RING)


def test_a_restart_after_taichi_has_restarted():
    """With other threads: the launches are lost, and made anew."""
    solver = build(RING)
    solver.advance(3)
    slabs = build(replace(RING, plan="parallel", threads=2))
    slabs.advance(3)
    assert_new(slabs, replace(slabs.scene, cells=10))
    assert runtime._started[1] == 2
    assert solver.restart(RING) and runtime._started[1] == 1
    assert_new(solver, replace(RING, cells=10))


def test_runs_one_after_the_other_are_those_of_new_solvers(monkeypatch):
    """Where solvers are reused. And what a result holds is its own: later runs write to other memory."""
    new = run(BAR, goals=["mean-stress"])
    monkeypatch.setattr(run_module, "_idle_solvers", None)
    run_module.reuse_solvers()
    first, small, again = (run(scene, goals=["mean-stress"]) for scene in (BAR, replace(BAR, cells=12), BAR))
    assert list(run_module._idle_solvers) == [kernel_key(BAR)]
    position = first.final.material_position.copy()
    run(replace(BAR, amplitude=0.02, cells=19))
    np.testing.assert_array_equal(first.final.material_position, position)
    assert len(small.final.position) < len(position)
    for result in (first, again):
        for name, values in new.series.items():
            np.testing.assert_array_equal(result.series[name], values, err_msg=name)
        np.testing.assert_equal(vars(result.final), vars(new.final))
        assert (result.goals, result.bytes, result.status) == (new.goals, new.bytes, new.status)
