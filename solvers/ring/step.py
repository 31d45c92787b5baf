"""The kernels of the ring, and when one of its runs has gone bad."""

import taichi as ti

from solvers.planar.step import kernels
from solvers.ring.phases import TRAITS
from solvers.ring.samples import MEASURES
from solvers.ring.state import HOOKS, RingState
from solvers.solver import CRUSHED, ESCAPED, INVERTED

FLATTEST = 1e-3  # det F below which a particle counts as crushed


@ti.func
def check(ring: ti.template(), step):
    """Stop a run that has gone bad: det F <= 0, tiny or NaN, or a particle outside of where the ring can be."""
    flattest, bad = FLATTEST, -1
    for p in range(ring.particles):
        q, X, F = ring.motion[p], ring.material_position[p], ring.deformation_gradient[p]
        J = F[0] * F[3] - F[1] * F[2]
        inside = q[0] > -ring.spacing and q[1] > -ring.spacing
        if not J >= flattest:  # true for NaN too
            flattest, bad = -1e300 if ti.math.isnan(J) else J, p
            ring.verdict[0] = CRUSHED if J > 0 else INVERTED
        elif not (inside and q[0] * q[0] + q[1] * q[1] < ring.farthest * ring.farthest and
                  (q[0] - X[0]) ** 2 + (q[1] - X[1]) ** 2 < ring.farthest_move ** 2) and bad < 0:
            bad = p
            ring.verdict[0] = ESCAPED
    if bad >= 0:
        ring.verdict[1], ring.verdict[2] = step, bad


KERNELS = kernels(RingState, HOOKS, TRAITS, MEASURES, check)
