"""Transport on the ring: the paper's estimator in the plane (see ``solvers.problems.planar.estimators.transport``)."""

import taichi as ti

from solvers.problems.planar.estimators import transport
from solvers.problems.ring.method.phases import TRAITS
from solvers.scene.estimator_hooks import EstimatorHooks


@ti.func
def in_step(ring: ti.template(), base, on: ti.template()):
    """Its turn, between the symmetry planes of the ring."""
    transport.in_step(ring, base, TRAITS, on)


HOOKS = EstimatorHooks(memory=transport.MEMORY, allocate=transport.allocate, interval=transport.interval,
                       in_step=in_step, report=transport.report, verdict=transport.verdict)
