"""The automatic step against the longest one that runs stand, on random settings: how much of it is taken."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from solvers.problems.bar.scene import BarScene
from solvers.problems.ring.scene import RingScene
from solvers.problems.vortex.scene import VortexScene
from solvers.running.run import run
from solvers.scene.remedies import FROZEN
from solvers.scene.scene import Scene
from solvers.scene.step_bound import of_scene

WIDEST = 2.5  # times the automatic step: where the search begins from above
HALVINGS = 7  # of the search: its end is within 0.9 and 1.1 per cent
MOST_WORK = 8e6  # particles times steps of one run, so that a hundred settings take minutes


def settings(seed: int) -> Iterator[Scene]:
    """Random scenes at large and small motion, by every method, of all problems in turn."""
    random = np.random.default_rng(seed)
    while True:
        for draw in (_bar, _ring, _vortex):
            scene = draw(random)
            if scene.particles * scene.steps < MOST_WORK:
                yield replace(scene, estimators=(), effects=("truth", "soundness"))


def _common(random: np.random.Generator, methods: tuple[str, ...], periods: tuple[float, float]) -> dict:
    return {"method": str(random.choice(methods)), "dt": "auto", "periods": random.uniform(*periods),
            "remedies": (FROZEN,) if random.random() < 0.15 else ()}


def _bar(random: np.random.Generator) -> Scene:
    common = _common(random, BarScene.choices("method"), (0.8, 2.5))
    return BarScene(**common, cells=int(random.integers(8, 60)), ppc=int(random.integers(2, 7)),
                    amplitude=10 ** random.uniform(-3, -0.84), modulus=10 ** random.uniform(-1, 5),
                    linearity_preserving=not common["remedies"] and random.random() < 0.3)


def _ring(random: np.random.Generator) -> Scene:
    return RingScene(**_common(random, RingScene.choices("method"), (0.8, 2)), cells=int(random.integers(10, 30)),
                     ppc=int(random.integers(1, 4)), amplitude=10 ** random.uniform(-3, -0.6),
                     layout=str(random.choice(["polar", "cartesian"])))


def _vortex(random: np.random.Generator) -> Scene:
    return VortexScene(**_common(random, VortexScene.choices("method"), (0.4, 1)), cells=int(random.integers(14, 36)),
                       ppc=int(random.integers(2, 4)), amplitude=10 ** random.uniform(-2, 0.05),
                       poisson_ratio=random.uniform(0, 0.45), frequency=10 ** random.uniform(-0.5, 0.5),
                       layout=str(random.choice(["polar", "polar", "cartesian"])))


def stands(scene: Scene, times: float) -> bool:
    """Whether a scene with the automatic step runs with one so many times as long."""
    return run(replace(scene, dt=times * scene.time_step), prices=False).status == "ok"


def taken(scene: Scene) -> float:
    """The part that the automatic step is of the longest that the run stands, by bisection."""
    low, high = 0.25, WIDEST
    for _ in range(HALVINGS):
        middle = math.sqrt(low * high)
        low, high = (middle, high) if stands(scene, middle) else (low, middle)
    return 1 / math.sqrt(low * high)


def limited_by_their_step(seed: int) -> Iterator[Scene]:
    """Those of the settings that run well with a quarter of the step: within a tenth of the amplitude. With hat
    functions that cross cells in the plane it is luck with any step (``StepBound.certain``): they are left out."""
    for scene in settings(seed):
        if of_scene(scene).certain and stands(scene, 0.25):
            result = run(replace(scene, dt=0.25 * scene.time_step), prices=False)
            if result.error["x"]["max"] < 0.1 * scene.motion_amplitude:
                yield scene


def test_the_automatic_step_is_most_of_what_a_run_stands():
    """Three settings here, a hundred among the slow ones."""
    scenes = limited_by_their_step(seed=1)
    for _ in range(3):
        scene = next(scenes)
        assert stands(scene, 1.0) and not stands(scene, 1 / 0.55)


@pytest.mark.slow
def test_the_automatic_step_on_a_hundred_settings(capsys):
    """None breaks with it, and it is .7 to .9 of the longest step in eight of ten. Measured here and with another seed:
    least .40, a tenth below .70, a quarter below .74, a half .79, three quarters .84, nine tenths .87, most .96."""
    scenes = limited_by_their_step(seed=2026)
    found = []
    for _ in range(100):
        scene = next(scenes)
        found.append((taken(scene), stands(scene, 1.0), scene))
        with capsys.disabled():
            print(f"{found[-1][0]:.3f} {found[-1][1]} {scene.problem} {scene.method} {scene.cells} x {scene.ppc},",
                  f"A {scene.amplitude:.4f} {' '.join(scene.remedies)} {getattr(scene, 'layout', '')}", flush=True)
    shares = np.array([share for share, _, _ in found])
    with capsys.disabled():
        print("least, 10, 25, 50, 75, 90 %, most:", np.quantile(shares, [0, 0.1, 0.25, 0.5, 0.75, 0.9, 1]).round(3))
    assert all(held for _, held, _ in found) and shares.max() < 1
    assert np.quantile(shares, 0.1) > 0.65 and 0.75 < np.median(shares) < 0.85
