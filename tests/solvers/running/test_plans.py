"""How a step in the plane is spread over threads changes no more than the order of its sums: a rounding a step."""

import functools
from dataclasses import replace

import numpy as np
import pytest

from solvers.problems.ring import RingScene
from solvers.problems.vortex import VortexScene
from solvers.running.run import build
from solvers.scene.scene import Scene
from solvers.solver import samples

STEPS = 60
PARTICLES = ("position", "velocity", "deformation_gradient")
RING = RingScene(estimators=("transport",))
VORTEX = VortexScene(cells=16, ppc=2, estimators=())
BOTH = ("null-space-filter", "coupled-deformation")
PLANS = {"serial": {"plan": "serial"}, "parallel": {"plan": "parallel", "threads": 2}}
#: One of each kind of mapping, of each estimator and of the remedies; the slow ones repeat what others show.
SCENES = {"cpdi": RING, "ugimp": replace(RING, method="ugimp"), "vortex": VORTEX,
          "remedies": replace(RING, method="ugimp", remedies=BOTH, estimators=()),
          "companion": replace(RING, method="ugimp", estimators=("companion",))}
SLOW = {"recovered": replace(RING, method="ugimp", estimators=("recovered",)), "cpgimp": replace(RING, method="cpgimp"),
        "mpm": replace(RING, method="mpm"), "vortex of boxes": replace(VORTEX, method="ugimp"),
        "two-grid": replace(RING, estimators=("two-grid",)),
        "companion of the vortex": replace(VORTEX, cells=24, method="ugimp", estimators=("companion",))}


@functools.cache
def ended(scene: Scene) -> tuple[str, dict[str, np.ndarray]]:
    """The plan of a run, and after some steps its particles, estimates and samples by name."""
    solver = build(scene)
    rows = np.concatenate([solver.measure(), solver.advance(STEPS), solver.measure()])
    shot = solver.snapshot()
    assert solver.sound
    particles = {name: getattr(shot, name) for name in PARTICLES}
    return f"{solver.plan} {solver.threads}", {
        **particles, **shot.estimate, **samples.read_rows(rows, scene, len(shot.position))}


@pytest.mark.parametrize("scene", [*(pytest.param(scene, id=name) for name, scene in SCENES.items()),
                                   *(pytest.param(scene, id=name, marks=pytest.mark.slow)
                                     for name, scene in SLOW.items())])
@pytest.mark.parametrize("plan", PLANS)  # all that are serial first: another number of threads restarts Taichi
def test_plans_agree(plan, scene):
    """Rounding (1e-16 of the largest number) a step: measured 2e-15 of x, v and F, and 1e-9 of what is next to nothing
    itself. What else is but rounding, a motion around the ring's centre, and the worst of many neighbours are not held
    against each other."""
    expected = ended(replace(scene, **PLANS["serial"]))[1]
    found_plan, found = ended(replace(scene, **PLANS[plan]))
    assert found_plan == {"serial": "serial 1", "parallel": "parallel 2"}[plan]
    assert found["crossings"][-1] == expected["crossings"][-1]
    for name, values in expected.items():
        if name != "place" and not name.startswith("motion_"):
            near, size = 1e-13 if name in PARTICLES else 1e-7, np.nanmax(np.abs(values), initial=0.0)
            np.testing.assert_allclose(found[name], values, rtol=0, atol=near * size, err_msg=name)
    assert np.ptp(expected["work"]) > 0


@pytest.mark.parametrize("plan", PLANS)
def test_compiling_steps_nothing(plan):
    """So that a rate is not charged for it; the margin of the step, which is compiled too, has scratch of its own."""
    solver = build(replace(RING, **PLANS[plan]))
    before = solver.state()[1]
    solver.compile()
    assert solver.step == 0
    for name in ("position_velocity", "deformation_gradient", "acceleration", "estimate", "totals"):
        np.testing.assert_array_equal(solver.state()[1][name], before[name], err_msg=name)
