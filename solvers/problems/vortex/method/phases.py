"""The vortex's own part of a step: no symmetry planes, for its sectors map onto each other by rotations."""

import taichi as ti

from solvers.problems.planar.method.neo_hookean import prepare, stress, tangent
from solvers.problems.planar.parts import Traits
from solvers.problems.vortex.method.material import body_force_on, forces


@ti.func
def no_ghosts(vortex: ti.template(), what: ti.template()):
    """There is nothing to fold or to mirror."""


@ti.func
def free(vortex: ti.template(), i, j, record):
    """No node is held."""
    return record


@ti.func
def itself(vortex: ti.template(), node):
    """No node is another one's image."""
    return node


@ti.func
def has_escaped(vortex: ti.template(), p, step):
    """Whether a particle is near the grid's edge."""
    q = vortex.position_velocity[p]
    return not ti.max(ti.abs(q[0]), ti.abs(q[1])) < vortex.farthest


TRAITS = Traits(forces=forces, prepare=prepare, body_force_on=body_force_on, stress=stress, tangent=tangent, first=0,
                fold=no_ghosts, pin=free, mirror=no_ghosts, image=itself)
