"""Transport on the vortex: the paper's estimator in the plane (see ``solvers.planar.estimators.transport``)."""

import taichi as ti

from solvers.estimators.interface import EstimatorHooks
from solvers.planar.estimators import transport
from solvers.vortex.phases import TRAITS


@ti.func
def in_step(vortex: ti.template(), base, on: ti.template()):
    """Its turn; the vortex has no symmetry planes."""
    transport.in_step(vortex, base, TRAITS, on)


HOOKS = EstimatorHooks(memory=transport.MEMORY, allocate=transport.allocate, interval=transport.interval,
                       in_step=in_step, report=transport.report, verdict=transport.verdict)
