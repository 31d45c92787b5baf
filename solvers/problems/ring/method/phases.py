"""The ring's own part of a step: it lies between two symmetry planes, whose ghosts are mirror images."""

import taichi as ti

from solvers.problems.planar.parts import Traits
from solvers.problems.ring.method.material import body_force_on, radial_forces, stress_of, tangent

GHOSTS = 2  # rows of nodes beyond each symmetry plane


@ti.func
def fold(ring: ti.template(), fold_pair: ti.template()):
    """Add what fell beyond a symmetry plane to its mirror image, the component across the plane with odd sign.

    Setting it to zero instead costs up to a factor 2.5 in accuracy. ``fold_pair(ring, ghost, image, in_x, in_y)`` adds
    a node's values, with these signs, to those of its image.
    """
    for j in range(ring.active):
        for i in ti.static(range(GHOSTS)):
            fold_pair(ring, j * ring.row + i, j * ring.row + 2 * GHOSTS - i, -1.0, 1.0)
    for i in range(ring.active):
        for j in ti.static(range(GHOSTS)):
            fold_pair(ring, j * ring.row + i, (2 * GHOSTS - j) * ring.row + i, 1.0, -1.0)


@ti.func
def pin(ring: ti.template(), i, j, record):
    """Nothing moves across a symmetry plane: the record of node (i, j) without the components that would."""
    pinned = record
    if i == GHOSTS:
        pinned[0], pinned[2] = 0.0, 0.0
    if j == GHOSTS:
        pinned[1], pinned[3] = 0.0, 0.0
    return pinned


@ti.func
def mirror(ring: ti.template(), values: ti.template()):
    """Copy the nodes' values, two vectors each, to their images beyond the planes: odd in what points across one."""
    for j in range(GHOSTS, ring.active):
        for i in ti.static(range(GHOSTS)):
            values[j * ring.row + i] = ti.Vector([-1.0, 1.0, -1.0, 1.0]) * values[j * ring.row + 2 * GHOSTS - i]
    for i in range(ring.active):
        for j in ti.static(range(GHOSTS)):
            values[j * ring.row + i] = ti.Vector([1.0, -1.0, 1.0, -1.0]) * values[(2 * GHOSTS - j) * ring.row + i]


@ti.func
def image(ring: ti.template(), node):
    """The node that a ghost is the mirror image of; any other is its own."""
    i, j = node % ring.row, node // ring.row
    i, j = ti.select(i < GHOSTS, 2 * GHOSTS - i, i), ti.select(j < GHOSTS, 2 * GHOSTS - j, j)
    return j * ring.row + i


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
                tangent=tangent, first=GHOSTS, fold=fold, pin=pin, mirror=mirror, image=image)
