"""What may help a broken run, and what is said of it after a trial: only what really ends as ok is said to hold."""

from dataclasses import replace

import pytest

from solvers.problems.bar.scene import BarScene
from solvers.problems.ring import RingScene
from solvers.problems.vortex import VortexScene
from solvers.running.cure_trials import try_cures
from solvers.running.cures import candidate_cures
from solvers.running.run import run
from solvers.scene.kernel_options import kernel_key

LOOKS = ("truth", "soundness")
ONE_EACH = BarScene(ppc=1, periods=2, cfl=0.2, estimators=(), effects=LOOKS)
RING = RingScene(method="ugimp", ppc=1, cells=16, amplitude=0.1, periods=3, cfl=0.3, estimators=(), effects=LOOKS)
BROKEN = [ONE_EACH, replace(ONE_EACH, ppc=4, method="mpm", amplitude=0.1, cfl=0.3),
          replace(ONE_EACH, ppc=4, cfl=1.5, amplitude=0.1), replace(ONE_EACH, motion="patch", ppc=2.5, method="mpm"),
          RING, VortexScene(method="ugimp", cells=16, layout="cartesian", ppc=2, estimators=(), effects=LOOKS)]
NAMES = ["one a cell", "hats", "long steps", "patch test", "ring", "vortex"]


@pytest.mark.parametrize("scene", [*BROKEN, replace(RING, layout="cartesian", velocity="particle")],
                         ids=[*NAMES, "staircase"])
def test_what_may_help_is_a_scene_the_cheapest_first(scene):
    """By work, of those with the same kernels; a smaller amplitude and an earlier end, another question, come last."""
    cures = candidate_cures(scene, "neighbour_gap", 0.5 * scene.end_time)
    assert cures == candidate_cures(scene, "neighbour_gap", 0.5 * scene.end_time) and len(cures) > 5
    scenes = [replace(scene, **cure.change) for cure in cures]
    assert len({*scenes, scene}) == len(scenes) + 1 and len({cure.text for cure in cures}) == len(cures)
    last = [k for k, cure in enumerate(cures) if cure.change.keys() & {"amplitude", "periods"}]
    assert last == [*range(len(cures))][-len(last):] and scenes[-1].end_time < 0.5 * scene.end_time
    work = [one.particles * one.steps for cure, one in zip(cures, scenes, strict=True)
            if cure.change.keys() <= {"ppc", "cells", "layout", "dt", "cfl"}]
    assert work == sorted(work)


def test_what_was_found_and_a_step_that_is_too_long_decide():
    drifts, parts = (candidate_cures(ONE_EACH, found, 1.0) for found in ("mean_drift", "displacement_mismatch"))
    assert {"remedies": ["zero-drift"]} in [cure.change for cure in drifts]
    assert {"remedies": ["coupled-deformation"]} in [cure.change for cure in parts]
    *changes, _ = (cure.change for cure in candidate_cures(replace(ONE_EACH, cfl=1.5), "", 1.0))
    assert all(change["dt"] == "auto" for change in changes) and {"cfl": None, "dt": "auto"} in changes
    nearly = replace(ONE_EACH, cfl=None, dt=0.99 * ONE_EACH.step_bound)
    assert not any("dt" in cure.change for cure in candidate_cures(nearly, "", 1.0))


@pytest.mark.parametrize("scene", BROKEN, ids=NAMES)
def test_what_is_said_to_hold_does(scene, simulate):
    """By another run. Nothing is tried before: a run alone says what may help, and never a cause."""
    result = simulate(scene)
    assert result.status != "ok" and "may help (not tried)" in result.reason and "is the cause" not in result.reason
    assert not any(cure.tried or cure.held for cure in result.advice)
    tried = try_cures(result, seconds=60.0)
    *failed, held = (cure for cure in tried.advice if cure.tried)
    assert held.held and f"; with {held.text} it holds (tried)" in tried.reason
    assert [run(replace(scene, **cure.change), mid_run=False).status == "ok" for cure in (held, *failed[:1])] \
        == [True, *(False for _ in failed[:1])]


def test_time_and_ctrl_c_end_the_trials(simulate):
    """What was tried until then is known; a run that is ok is not tried; two that hold may be asked for."""
    result, tries = simulate(BROKEN[1]), []

    def stop(part: float, change: str) -> None:
        tries.append(change)
        if change != tries[0]:
            raise KeyboardInterrupt

    assert try_cures(result, seconds=1e-9).advice == result.advice
    stopped = try_cures(result, 60.0, on_progress=stop)
    assert [cure.text for cure in stopped.advice if cure.tried] == tries[:1] != []
    assert "no change that was tried holds: " + tries[0] + "; " in stopped.reason
    assert sum(cure.held for cure in try_cures(result, 60.0, enough=2).advice) == 2
    slow = replace(result, seconds=replace(result.seconds, compile=100.0))  # longer than the time that there is
    changed = [replace(result.scene, **cure.change) for cure in try_cures(slow, 60.0, enough=9).advice if cure.tried]
    assert changed and {kernel_key(scene) for scene in changed} == {kernel_key(result.scene)}
    sound = simulate(replace(ONE_EACH, ppc=2))
    assert sound.advice == () and try_cures(sound) is sound


def test_what_is_known_of_a_motion_is_said_beside_the_advice(simulate):
    unstable = simulate(replace(RING, amplitude=0.2))
    assert "the ring's own motion is unstable (parametric resonance) and no remedy helps; " in unstable.reason
