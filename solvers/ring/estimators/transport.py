"""Transport on the ring: the paper's estimator in the plane (see ``solvers.planar.estimators.transport``)."""

import taichi as ti

from solvers.estimators.interface import EstimatorHooks
from solvers.planar.estimators import transport
from solvers.ring.phases import TRAITS


@ti.func
def in_step(ring: ti.template(), base, on: ti.template()):
    """Its turn, between the symmetry planes of the ring."""
    transport.in_step(ring, base, TRAITS, on)


HOOKS = EstimatorHooks(memory=transport.MEMORY, allocate=transport.allocate, interval=transport.interval,
                       in_step=in_step, report=transport.report, verdict=transport.verdict)
