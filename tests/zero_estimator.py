"""An estimator from outside: "zero", which says of every bar that it has no error. See
``tests/solvers/estimators/test_extension.py``.

It keeps an array and a number of its own, counts in them, and doubts itself if they do not hold what it put there.
"""

import numpy as np
import taichi as ti

from solvers.kernels.kinds import real, reals
from solvers.scene.estimator_hooks import EstimatorHooks
from solvers.scene.registry import Estimator, register


@ti.func
def after_step(bar: ti.template(), base, step, on: ti.template()):
    for p in range(bar.particles):
        bar.zero_counts[p] = bar.zero_counts[p] + bar.zero_one
        bar.estimate[base + p] = ti.Vector([0.0, 0.0, 0.0, 0.0])


def verdict(scene, memory):
    counts = memory["zero_counts"][:scene.particles]
    return None if np.all(counts == counts[0]) else "not valid here: its memory is not its own"


register(Estimator(
    "zero", "says that there is no error", colour="#606060", dashes=(1, 3), symbol="X",
    hooks={"bar": EstimatorHooks(
        memory={"zero_one": real, "zero_counts": reals},
        allocate=lambda scene: {"zero_one": 1.0, "zero_counts": np.zeros(scene.particles)},
        interval=lambda scene: 1, after_step=after_step, verdict=verdict)}))
