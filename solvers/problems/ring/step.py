"""The kernels of the ring, and where its particles cannot be."""

import taichi as ti

from solvers.problems.planar.plans.step import kernels
from solvers.problems.ring.method.phases import TRAITS
from solvers.problems.ring.method.samples import MEASURES
from solvers.problems.ring.state import HOOKS, RingState


@ti.func
def has_escaped(ring: ti.template(), p):
    """Whether a particle is beyond a plane, or farther from the centre or from where it began than in a sound run."""
    q, X = ring.motion[p], ring.material_position[p]
    inside = q[0] > -ring.spacing and q[1] > -ring.spacing
    return not (inside and q[0] * q[0] + q[1] * q[1] < ring.farthest * ring.farthest and
                (q[0] - X[0]) ** 2 + (q[1] - X[1]) ** 2 < ring.farthest_move ** 2)


KERNELS = kernels(RingState, HOOKS, TRAITS, MEASURES, has_escaped)
