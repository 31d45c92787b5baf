"""The ring's own part of a step: it lies between two symmetry planes, whose ghosts are mirror images."""

import taichi as ti

from solvers.problems.planar.method.symmetry_planes import symmetry_planes
from solvers.problems.planar.parts import Traits
from solvers.problems.ring.method.material import body_force_on, radial_forces, stress_of, tangent


@ti.func
def has_escaped(ring: ti.template(), p, step):
    """Whether a particle is beyond a plane, or farther from the centre or from where it began than in a sound run."""
    q, X = ring.position_velocity[p], ring.material_position[p]
    inside = q[0] > -ring.spacing and q[1] > -ring.spacing
    return not (inside and q[0] * q[0] + q[1] * q[1] < ring.farthest * ring.farthest and
                (q[0] - X[0]) ** 2 + (q[1] - X[1]) ** 2 < ring.farthest_move ** 2)


@ti.func
def nothing_to_prepare(ring: ti.template(), start, end):
    """The stress needs no more than F."""


TRAITS = Traits(forces=radial_forces, prepare=nothing_to_prepare, body_force_on=body_force_on, stress=stress_of,
                tangent=tangent, **symmetry_planes(True, False)._asdict())
