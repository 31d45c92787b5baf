"""Rebuilding a scene is what a slider does: it must neither grow memory nor compile."""

import gc
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from solvers.problems.bar.scene import BarScene
from solvers.problems.bar.serial_step_kernel import KERNELS
from solvers.problems.bar.solver import BarSolver
from solvers.scene.scene import Scene

PAGE = 4096
#: The smallest scene's arrays take 7e4 bytes: 600 kept would be 42 MB, so 5 MB means that nothing is kept.
MOST_GROWTH = 5e6


def resident_bytes() -> int:
    """Memory of this process now, not its peak, which earlier tests may have raised."""
    gc.collect()
    return int(Path("/proc/self/statm").read_text().split()[1]) * PAGE


def random_scene(rng: np.random.Generator) -> Scene:
    """Same switches, all numbers different."""
    return BarScene(cells=int(rng.integers(4, 400)), ppc=int(rng.integers(1, 6)),
                 amplitude=float(rng.uniform(0.001, 0.1)), modulus=float(rng.uniform(1, 100)),
                 density=float(rng.uniform(1, 10)), cfl=float(rng.uniform(0.01, 0.1)))


@pytest.mark.slow
def test_600_rebuilds_leave_memory_flat_and_compile_nothing():
    """After 100 to warm up, 600 scenes of any size: growth below 5 MB, no kernel added, below 50 ms of work each."""
    rng, kernel, slowest = np.random.default_rng(0), KERNELS.advance._primal, []
    for n in range(700):
        if n == 100:
            before, compiled = resident_bytes(), len(kernel.compiled_kernels)
        begun = time.thread_time()
        solver = BarSolver(random_scene(rng))
        assert solver.bytes > 7e4
        solver.advance(2)
        slowest.append(time.thread_time() - begun)
    assert resident_bytes() - before < MOST_GROWTH
    assert len(kernel.compiled_kernels) == compiled
    assert np.median(slowest[100:]) < 0.05


def test_a_new_switch_compiles_once():
    """The counter above does count: another choice of effects adds a kernel, the same choice again does not."""
    kernel = KERNELS.advance._primal
    scene = BarScene(effects=("energy", "crossings"), body_force="none", velocity="particle")
    counts = [len(kernel.compiled_kernels)]
    for variant in (scene, scene, replace(scene, cells=17)):
        BarSolver(variant).advance(1)
        counts.append(len(kernel.compiled_kernels))
    assert counts[1] == counts[0] + 1 and counts[1] == counts[2] == counts[3]
