"""The vortex's own part of a step: no symmetry planes, for its sectors map onto each other by rotations."""

import taichi as ti

from solvers.problems.planar.method.neo_hookean import prepare, stress, tangent
from solvers.problems.planar.method.symmetry_planes import symmetry_planes
from solvers.problems.planar.parts import Traits
from solvers.problems.vortex.method.material import body_force_on, forces


@ti.func
def has_escaped(vortex: ti.template(), p, step):
    """Whether a particle is near the grid's edge."""
    q = vortex.position_velocity[p]
    return not ti.max(ti.abs(q[0]), ti.abs(q[1])) < vortex.farthest


TRAITS = Traits(forces=forces, prepare=prepare, body_force_on=body_force_on, stress=stress, tangent=tangent,
                **symmetry_planes(False, False)._asdict())
