"""What a newcomer adds first, from outside: an estimator that the ring alone has, which overstates every error, and an
effect with a number that the bar alone has. See ``tests/solvers/scene/test_outside.py``."""

import numpy as np
import taichi as ti

from solvers.scene.effects import Effect, Number
from solvers.scene.effects import register as register_effect
from solvers.scene.estimator_hooks import EstimatorHooks
from solvers.scene.registry import Estimator, register
from solvers.solver.samples import column


@ti.func
def report(ring: ti.template(), base, step, on: ti.template()):
    for p in range(ring.particles):
        ring.estimate[base + p] = ti.Vector([1.0, 0.0, 0.0, 0.0])  # m: many amplitudes


@ti.func
def sample_strain(bar: ti.template(), row, step, on: ti.template()):
    largest = 0.0
    for p in range(bar.particles):
        largest = ti.max(largest, abs(bar.deformation_gradient[p] - 1))
    bar.samples[row, ti.static(column("strain/size", on))] = largest


register(Estimator("loud", "says that every particle is a metre off", colour="#a0a0a0", hooks={"ring": EstimatorHooks(
    memory={}, allocate=lambda scene: {}, interval=lambda scene: 1, report=report)}))
register_effect(Effect(
    "strain", "largest strain", "follow the largest strain so far", columns=("size",), samplers={"bar": sample_strain},
    numbers=(Number("largest", lambda series: np.max(series["strain/size"])),
             Number("samples", lambda series: len(series["time"]), kind=int))))
