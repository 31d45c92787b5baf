"""What a newcomer adds first, from outside, in one file: an estimator of the bar alone, which says that there is no
error; one of the ring alone, which overstates every error; and an effect with a number that the bar alone has. See
``tests/solvers/estimators/test_extension.py``.

The bar's keeps an array and a number of its own, counts in them, and doubts itself if they do not hold what it put
there.
"""

import numpy as np
import taichi as ti

from solvers.kernels.dtypes import real, reals
from solvers.scene.effects import Effect, Number
from solvers.scene.effects import register as register_effect
from solvers.scene.estimator_hooks import EstimatorHooks
from solvers.scene.estimator_registry import Estimator, register
from solvers.solver.samples import column_index


@ti.func
def count(bar: ti.template(), base, step, on: ti.template()):
    for p in range(bar.particles):
        bar.zero_counts[p] = bar.zero_counts[p] + bar.zero_one
        bar.estimate[base + p] = ti.Vector([0.0, 0.0, 0.0, 0.0])


def verdict(scene, memory):
    counts = memory["zero_counts"][:scene.particles]
    return None if np.all(counts == counts[0]) else "not valid here: its memory is not its own"


@ti.func
def overstate(ring: ti.template(), base, step, on: ti.template()):
    for p in range(ring.particles):
        ring.estimate[base + p] = ti.Vector([1.0, 0.0, 0.0, 0.0])  # m: many amplitudes


@ti.func
def sample_strain(bar: ti.template(), row, step, on: ti.template()):
    largest = 0.0
    for p in range(bar.particles):
        largest = ti.max(largest, abs(bar.deformation_gradient[p] - 1))
    bar.samples[row, ti.static(column_index("strain/size", on))] = largest


register(Estimator(
    "zero", "says that there is no error", colour="#606060", dashes=(1, 3), symbol="X",
    hooks={"bar": EstimatorHooks(memory={"zero_one": real, "zero_counts": reals},
                                 allocate=lambda scene: {"zero_one": 1.0, "zero_counts": np.zeros(scene.particles)},
                                 interval=lambda scene: 1, after_step=count, verdict=verdict)}))
register(Estimator("loud", "says that every particle is a metre off", colour="#a0a0a0", hooks={"ring": EstimatorHooks(
    memory={}, allocate=lambda scene: {}, interval=lambda scene: 1, report=overstate)}))
register_effect(Effect(
    "strain", "largest strain", "follow the largest strain so far", columns=("size",), samplers={"bar": sample_strain},
    numbers=(Number("largest", lambda series: np.max(series["strain/size"])),
             Number("samples", lambda series: len(series["time"]), kind=int))))
