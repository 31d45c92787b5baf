"""The kernels of the vortex, and where its particles cannot be."""

import taichi as ti

from solvers.problems.planar.plans.step import kernels
from solvers.problems.vortex.method.phases import TRAITS
from solvers.problems.vortex.method.samples import MEASURES
from solvers.problems.vortex.state import HOOKS, VortexState


@ti.func
def has_escaped(vortex: ti.template(), p):
    """Whether a particle is near the grid's edge."""
    q = vortex.motion[p]
    return not ti.max(ti.abs(q[0]), ti.abs(q[1])) < vortex.farthest


KERNELS = kernels(VortexState, HOOKS, TRAITS, MEASURES, has_escaped)
