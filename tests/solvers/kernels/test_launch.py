"""A kept launch does what Taichi's own does, on arrays as they are then, and lets go before Taichi ends."""

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from solvers.kernels import runtime
from solvers.problems.bar.scene import BarScene
from solvers.problems.bar.serial_step_kernel import KERNELS
from solvers.problems.ring import RingScene
from solvers.running.run import build
from solvers.solver.base import STEP

BAR = BarScene(cells=10, ppc=2, periods=1, estimators=("companion",), effects=("truth", "estimate", "crossings"))
RING = RingScene(cells=12, periods=1)


def test_it_is_the_launch_that_taichi_makes():
    """The same steps, taken by kept launches and by Taichi's own, to the bit; also after numbers were put into an
    array."""
    kept, plain = build(BAR), build(BAR)
    kept.advance(7)
    kept.advance(5)
    assert kept._stepping._advance._kept is not None
    for start, steps in ((0, 7), (7, 5)):
        KERNELS.advance(start, steps, STEP, plain._stepping.pack, plain._switches)
    for name, values in kept._arrays.members().items():
        np.testing.assert_array_equal(values, plain._arrays.members()[name], err_msg=name)
    for solver in (kept, plain):
        solver._arrays.velocity[:] = 0.25
    kept.advance(1)
    KERNELS.advance(12, 1, STEP, plain._stepping.pack, plain._switches)
    np.testing.assert_array_equal(kept._arrays.velocity, plain._arrays.velocity)


def test_nothing_is_kept_when_taichi_starts_anew():
    """With other threads: the old solver's launches let go first, or the process would die when they do."""
    solver = build(replace(RING, plan="serial"))
    solver.advance(3)
    launch = solver._stepping._advance
    assert launch._kept is not None
    other = build(replace(RING, plan="parallel", threads=2))
    assert launch._kept is None
    other.advance(3)
    step = other._stepping._step
    assert step._kept is not None
    again = build(replace(RING, plan="serial"))
    again.advance(3)
    launch = again._stepping._advance
    assert step._kept is None and launch._kept is not None and launch in runtime.holders


@pytest.mark.parametrize("scene", ["BarScene(cells=8, effects=(), estimators=())",
                                   "RingScene(cells=8, effects=(), estimators=(), plan='parallel', threads=2)"])
def test_a_process_that_keeps_launches_ends_well(scene):
    code = ("from solvers.problems.bar.scene import BarScene\nfrom solvers.problems.ring import RingScene\n"
            f"from solvers.running.run import build\nsolver = build({scene})\nsolver.advance(5)\nsolver.measure()\n")
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")
