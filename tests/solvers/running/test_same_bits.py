"""Looking at a run changes no bit of it, and neither does how its steps are asked for; and a run repeats to the bit.
How a step in the plane is spread over threads changes no more than the order of its sums: a rounding a step."""

import functools
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest

from solvers.problems.bar.scene import BarScene
from solvers.problems.ring import RingScene
from solvers.problems.vortex import VortexScene
from solvers.running.repeated_step_timing import estimator_shares
from solvers.running.run import build
from solvers.scene.scene import Scene
from solvers.solver import samples

STEPS = 84
PARTICLES = ("position", "velocity", "deformation_gradient")
KINDS = {kind.problem: kind for kind in (BarScene, RingScene, VortexScene)}
#: Each watched by all estimators that hold there.
SCENES = {
    "bar": BarScene(cells=20, linearity_preserving=True, amplitude=2.5e-4, periods=1, sample_every=7,
                    estimators=BarScene.choices("estimators")),
    "ring": RingScene(sample_every=7, periods=0.25, estimators=RingScene.choices("estimators")),
    "vortex": VortexScene(cells=24, amplitude=0.25, cfl=0.2, t_end=0.3, sample_every=7,
                          estimators=VortexScene.choices("estimators")),
}
SCENES["ring in slabs"] = replace(SCENES["ring"], plan="parallel", threads=2, estimators=("transport",))


class Way(NamedTuple):
    """Of taking the same steps: what of the scene is another, how many at a time, and what is done between them."""

    changes: dict
    slices: tuple[int, ...] = (STEPS,)
    frames: bool = False
    prices: bool = False
    apart: tuple[str, ...] = ()  # estimators whose own steps follow the samples'


WAYS = {"again": Way({}), "in slices": Way({}, (1, 7, 13, 40, 23)), "with frames": Way({}, (7,) * 12, frames=True),
        "sampled often": Way({"sample_every": 3}, apart=("transport", "two-grid")),
        "priced": Way({}, (40, 44), prices=True), "by nobody": Way({"estimators": ()}),
        "without truth": Way({"effects": ("estimate", "acceleration")}),
        **{f"by {name} alone": Way({"estimators": (name,)}) for name in BarScene.choices("estimators")}}
#: Compile longer than they run: in the plane one estimator has to do, in the vortex, which has the ring's, none.
SLOW = {("ring", "by transport alone"), ("ring", "by recovered alone"), ("ring", "by two-grid alone"),
        ("ring", "without truth"), *(("vortex", name) for name, way in WAYS.items() if "effects" in way.changes),
        *(("vortex", name) for name, way in WAYS.items() if way.changes.get("estimators"))}
PAIRS = [(problem, name) for problem, scene in SCENES.items() for name, way in WAYS.items()
         if (set(way.changes.get("estimators", ())) <= set(scene.estimators) and problem != "ring in slabs")
         or name in ("again", "in slices")]

Arrays = dict[str, np.ndarray]


def ended(scene: Scene, way: Way) -> tuple[Arrays, Arrays]:
    """What particles and estimates are after the steps, and all samples, by name; what is off is left out."""
    scene = replace(scene, **way.changes)
    solver, rows = build(scene), []
    for steps in way.slices:
        rows.append(solver.advance(steps))
        if way.frames:
            solver.snapshot()
        if way.prices:
            shares = estimator_shares(solver)
            assert set(shares) == set(scene.active_estimators) and all(0 <= part < 1 for part in shares.values())
    assert solver.sound and solver.step == STEPS
    shot = solver.snapshot()
    state = {**{name: getattr(shot, name) for name in (*PARTICLES, "last_crossing", "error")}, **shot.estimate}
    series = samples.read_rows(np.concatenate(rows), scene, len(shot.position))
    return ({name: values for name, values in state.items() if values is not None},
            {name: values for name, values in series.items() if values.any() and not np.isnan(values).all()})


@functools.cache
def plain(problem: str) -> tuple[Arrays, Arrays]:
    return ended(SCENES[problem], Way({}))


@pytest.mark.parametrize(("problem", "way"), [
    pytest.param(*pair, marks=pytest.mark.slow if pair in SLOW else ()) for pair in PAIRS])
def test_looking_changes_no_bit(problem, way):
    """Particles, estimates and, where both are taken at the same steps, samples. So one run serves for the bounds of
    all estimators (``tests/solvers/estimators/test_accuracy.py``)."""
    (one, series), (other, other_series) = plain(problem), ended(SCENES[problem], WAYS[way])
    assert problem == "ring in slabs" or len(SCENES[problem].active_estimators) > 2
    if len(series["time"]) == len(other_series["time"]):
        one, other = one | series, other | other_series
    for name in (one.keys() & other.keys()) - {*WAYS[way].apart}:
        np.testing.assert_array_equal(other[name], one[name], err_msg=name)
    assert other.keys() >= {*PARTICLES, *WAYS[way].changes.get("estimators", ())}


@pytest.mark.parametrize("changes", [
    {"problem": "bar", "method": "mpm", "amplitude": 0.05}, {"problem": "bar", "method": "bspline", "amplitude": 0.05,
                                                             "linearity_preserving": True},
    {"problem": "ring"}, {"problem": "vortex", "cells": 24},
    *(pytest.param(changes, marks=pytest.mark.slow) for changes in (
        {"problem": "bar", "method": "ugimp"}, {"problem": "bar", "method": "cpgimp"},
        *({"problem": "ring", "method": method} for method in ("mpm", "ugimp", "cpgimp")),
        {"problem": "vortex", "cells": 24, "method": "ugimp"}))], ids=str)
def test_effects_change_nothing(changes):
    """All that is computed beside the method on, and nothing: of the bar the same bits; in the plane, whose compiler
    may round otherwise in the other kernel, 1e-16 a step and what becomes of that."""
    scene = KINDS[changes["problem"]](**changes)
    found = []
    for one in (scene, replace(scene, effects=(), estimators=())):
        solver = build(one)
        solver.advance(STEPS)
        found.append(solver.snapshot())
    for name in PARTICLES:
        watched, bare = (getattr(shot, name) for shot in found)
        most = 0.0 if scene.problem == "bar" else 1e-11 * np.abs(bare).max()
        np.testing.assert_allclose(watched, bare, rtol=0, atol=most, err_msg=name)


RING = RingScene(estimators=("transport",))
VORTEX = VortexScene(cells=16, ppc=2, estimators=())
PLANS = {"serial": {"plan": "serial"}, "parallel": {"plan": "parallel", "threads": 2}}
#: One of each kind of mapping, of each estimator and of the remedies; the slow ones repeat what others show.
SPREAD = {"cpdi": RING, "ugimp": replace(RING, method="ugimp"), "vortex": VORTEX,
          "remedies": replace(RING, method="ugimp", remedies=("null-space-filter", "coupled-deformation"),
                              estimators=()),
          "companion": replace(RING, method="ugimp", estimators=("companion",))}
SLOWLY_SPREAD = {
    "recovered": replace(RING, method="ugimp", estimators=("recovered",)), "cpgimp": replace(RING, method="cpgimp"),
    "mpm": replace(RING, method="mpm"), "vortex of boxes": replace(VORTEX, method="ugimp"),
    "two-grid": replace(RING, estimators=("two-grid",)),
    "companion of the vortex": replace(VORTEX, cells=24, method="ugimp", estimators=("companion",))}


@functools.cache
def planned(scene: Scene, plan: str) -> Arrays:
    particles, series = ended(scene, Way(PLANS[plan]))
    return particles | series


@pytest.mark.parametrize("scene", [*(pytest.param(scene, id=name) for name, scene in SPREAD.items()),
                                   *(pytest.param(scene, id=name, marks=pytest.mark.slow)
                                     for name, scene in SLOWLY_SPREAD.items())])
@pytest.mark.parametrize("plan", PLANS)  # all that are serial first: another number of threads restarts Taichi
def test_plans_agree(plan, scene):
    """Rounding (1e-16 of the largest number) a step: measured 2e-15 of x, v and F, and 1e-9 of what is next to nothing
    itself. What else is but rounding, a motion around the ring's centre, and the worst of many neighbours are not held
    against each other."""
    expected, found = planned(scene, "serial"), planned(scene, plan)
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
    assert (solver.plan, solver.threads) == (plan, PLANS[plan].get("threads", 1))
    before = solver.state()[1]
    solver.compile()
    assert solver.step == 0
    for name in ("position_velocity", "deformation_gradient", "acceleration", "estimate", "totals"):
        np.testing.assert_array_equal(solver.state()[1][name], before[name], err_msg=name)
