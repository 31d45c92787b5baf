"""Running a ring: two plans give one answer, slices and effects change nothing, memory does not grow."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from solvers.problems.ring.scene import RingScene
from solvers.running.run import build, run

METHODS = ["mpm", "ugimp", "cpgimp", "cpdi"]
SCENE = RingScene(cells=24, periods=0.25)
PAGE = 4096


def state(solver) -> np.ndarray:
    return np.concatenate([solver._arrays.position_velocity, solver._arrays.deformation_gradient], axis=1)


@pytest.mark.parametrize("method", [pytest.param(method, marks=() if method in ("ugimp", "cpdi") else pytest.mark.slow)
                                    for method in METHODS])
def test_plans_agree(method):
    """Slabs add in another order: a rounding (1e-16 of v) a step, measured 3e-13 m/s; crossings and index the same."""
    scene = replace(SCENE, method=method, effects=("truth", "estimate", "crossings", "energy"))
    one, other = (run(s, prices=False) for s in (scene, replace(scene, plan="parallel", threads=2)))
    assert (one.plan, one.threads, other.plan, other.threads) == ("serial", 1, "parallel", 2)
    assert np.abs(one.final.position - other.final.position).max() < 1e-13
    assert np.abs(one.final.velocity - other.final.velocity).max() < 1e-10
    assert one.series["crossings"][-1] == other.series["crossings"][-1]
    for name in ("error_x", "work", "transport/estimate_x"):
        np.testing.assert_allclose(other.series[name], one.series[name], rtol=1e-7, atol=1e-15)


@pytest.mark.parametrize("plan", ["serial", "parallel"])
def test_runs_repeat_bit_by_bit_and_in_slices(plan):
    """No atomics: the same bits every time, whole or in pieces of 1, 7 and the rest."""
    scene = replace(SCENE, plan=plan, threads=2 if plan == "parallel" else 1)
    whole, again, sliced = (build(scene) for _ in range(3))
    whole.advance(60)
    again.advance(60)
    rows = [sliced.advance(n) for n in (1, 7, 52)]
    np.testing.assert_array_equal(state(whole), state(again))
    np.testing.assert_array_equal(state(whole), state(sliced))
    assert sum(map(len, rows)) == 60 // scene.sample_interval


@pytest.mark.parametrize("method", [pytest.param(method, marks=() if method in ("ugimp", "cpdi") else pytest.mark.slow)
                                    for method in METHODS])
def test_effects_do_not_change_the_physics(method):
    """Measurements read only: the compiler may round otherwise in the other kernel, 1e-16 a step."""
    scene = replace(SCENE, method=method)
    full, bare = build(scene), build(replace(scene, effects=(), estimators=()))
    full.advance(60)
    bare.advance(60)
    assert np.abs(state(full) - state(bare)).max() < 1e-10


def test_grid_crossings_are_counted():
    """The kernel's count equals a count of cell changes from the positions after every step, in x and in y."""
    solver = build(replace(SCENE, cfl=0.2))
    cells, count = None, 0
    for _ in range(120):
        now = np.floor(solver._arrays.position_velocity[:, :2] / SCENE.spacing)
        count += 0 if cells is None else int(np.abs(now - cells).sum())
        cells = now
        solver.advance(1)
    now = np.floor(solver._arrays.position_velocity[:, :2] / SCENE.spacing)
    count += int(np.abs(now - cells).sum())
    assert count > 300
    assert solver._arrays.totals[0] == count


def test_compiling_steps_nothing():
    """Both plans compile without touching the state, so that a rate is not charged for it."""
    for plan, threads in (("serial", 1), ("parallel", 2)):
        solver = build(replace(SCENE, plan=plan, threads=threads))
        before = state(solver).copy()
        solver.compile()
        np.testing.assert_array_equal(state(solver), before)
        assert solver.step == 0


def test_sixty_rebuilds_do_not_grow():
    """A ring of 96 cells holds 1.5 MB: sixty kept would be 90 MB; 20 MB allows for the allocator's habits."""
    def resident() -> int:
        with open("/proc/self/statm") as file:
            return int(file.read().split()[1]) * PAGE

    scene = RingScene(cells=96)
    for k in range(65):
        solver = build(replace(scene, amplitude=0.05 + 0.001 * k))
        solver.advance(2)
        if k == 4:
            before = resident()
    assert solver.bytes * 60 > 60e6
    assert resident() - before < 20e6
