"""Transport on the vortex: the paper's estimator in the plane (see
``solvers.problems.planar.estimators.transport``)."""

import taichi as ti

from solvers.problems.planar.estimators import transport
from solvers.problems.vortex.method.phases import TRAITS
from solvers.scene.estimator_hooks import EstimatorHooks


@ti.func
def in_step(vortex: ti.template(), base, on: ti.template()):
    """Its turn; the vortex has no symmetry planes."""
    transport.in_step(vortex, base, TRAITS, on)


HOOKS = EstimatorHooks(memory=transport.MEMORY, allocate=transport.allocate, interval=transport.interval,
                       in_step=in_step, report=transport.report, verdict=transport.verdict)
