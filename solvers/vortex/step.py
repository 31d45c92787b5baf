"""The kernels of the vortex, and when one of its runs has gone bad."""

import taichi as ti

from solvers.planar.step import kernels
from solvers.solver import CRUSHED, ESCAPED, INVERTED
from solvers.vortex.material import determinant
from solvers.vortex.phases import TRAITS
from solvers.vortex.samples import MEASURES
from solvers.vortex.state import HOOKS, VortexState

FLATTEST = 1e-3  # det F below which a particle counts as crushed


@ti.func
def check(vortex: ti.template(), step):
    """Stop a run that has gone bad: det F <= 0, tiny or NaN, or a particle near the grid's edge."""
    flattest, bad = FLATTEST, -1
    for p in range(vortex.particles):
        q, J = vortex.motion[p], determinant(vortex.deformation_gradient[p])
        if not J >= flattest:  # true for NaN too
            flattest, bad = -1e300 if ti.math.isnan(J) else J, p
            vortex.verdict[0] = CRUSHED if J > 0 else INVERTED
        elif not ti.max(ti.abs(q[0]), ti.abs(q[1])) < vortex.farthest and bad < 0:
            bad = p
            vortex.verdict[0] = ESCAPED
    if bad >= 0:
        vortex.verdict[1], vortex.verdict[2] = step, bad


KERNELS = kernels(VortexState, HOOKS, TRAITS, MEASURES, check)
