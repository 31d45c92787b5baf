"""The ring's remedies (see ``solvers.remedies``): what a scene may call for against breakdown in long motions.

As the bar's: the null-space filter on the particles' velocity, and F drawn towards that of their displacements.
A record of a particle, or of a node, is (v_x, v_y, u_x, u_y): both are mapped at once.
"""

import taichi as ti

from solvers.ring import cpdi, gimp
from solvers.ring.layout import GHOSTS
from solvers.ring.phases import fold, gather, mirror

PASSES = 4  # of the coupling: u_i = sum over l < 4 of (I - S^+ S)^l S^+ (x - X)
LEAST_JACOBIAN = 0.1  # of I - grad u, below which its inverse says nothing


@ti.func
def in_step(ring: ti.template(), step, on: ti.template()):
    """The turn of the remedies between nodes and particles; ``step`` counts this step too."""
    if ti.static(on.filtered or on.coupled):
        if step % ring.remedy_interval == 0:
            turn(ring, on)


@ti.func
def turn(ring: ti.template(), on: ti.template()):
    """v_p -= rate (I - S S^+)^2 v; F += rate ((I - grad u)^-1 - F) with u_i the sharpened copy of x - X."""
    for node in range(ring.nodes):
        ring.node_remedy[node] = ti.Vector([0.0] * 4)
    for p in range(ring.particles):
        q, X = ring.motion[p], ring.material_position[p]
        here, _, _ = gather(ring, p, ring.node_motion, on)
        seen = ring.dt * ti.Vector([here[2], here[3]])  # v_i before the step's acceleration
        ring.particle_scratch[p] = ti.Vector([q[2] - here[0] + seen[0], q[3] - here[1] + seen[1],
                                              q[0] - X[0], q[1] - X[1]])
    for pass_number in range(ti.static(PASSES if on.coupled else 1)):
        scratch_to_nodes(ring, on)
        for node in range(ring.nodes):
            new = ring.node_scratch[node]
            if pass_number > 0:
                new[0], new[1] = 0.0, 0.0
            ring.node_remedy[node] = ring.node_remedy[node] + new
        if ti.static(on.coupled):
            for p in range(ring.particles):
                seen, _, _ = gather(ring, p, ring.node_scratch, on)
                left = ring.particle_scratch[p]
                ring.particle_scratch[p] = ti.Vector([left[0], left[1], left[2] - seen[2], left[3] - seen[3]])
    for p in range(ring.particles):
        here, by_x, by_y = gather(ring, p, ring.node_remedy, on)
        if ti.static(on.filtered):
            unseen, q = ring.particle_scratch[p], ring.motion[p]
            ring.motion[p] = ti.Vector([q[0], q[1], q[2] - ring.remedy_rate * (unseen[0] - here[0]),
                                        q[3] - ring.remedy_rate * (unseen[1] - here[1])])
        if ti.static(on.coupled):
            xx, xy, yx, yy = 1 - by_x[2], -by_y[2], -by_x[3], 1 - by_y[3]
            J = xx * yy - xy * yx
            if J > LEAST_JACOBIAN and xx + yy > 0:
                F = ring.deformation_gradient[p]
                target = ti.Vector([yy, -xy, -yx, xx]) / J
                ring.deformation_gradient[p] = F + ring.remedy_rate * (target - F)


@ti.func
def scratch_to_nodes(ring: ti.template(), on: ti.template()):
    """S^+ of the particles' records: weighted by mass, folded at the symmetry planes like a velocity."""
    for node in range(ring.nodes):
        ring.node_scratch[node] = ti.Vector([0.0] * 4)
    for p in range(ring.particles):
        carried = ring.mass[p] * ring.particle_scratch[p]
        if ti.static(on.method == "cpdi"):
            cpdi.scatter(ring, p, carried, ring.node_scratch)
        else:
            gimp.scatter(ring, p, carried, ring.node_scratch)
    fold(ring, fold_scratch)
    for j in range(GHOSTS, ring.active):
        for i in range(GHOSTS, ring.active):
            node = j * ring.row + i
            mass, sums = ring.node_mass[node], ring.node_scratch[node]
            values = ti.Vector([0.0] * 4)
            if mass > 0:
                values = sums / mass
                if i == GHOSTS:
                    values[0], values[2] = 0.0, 0.0
                if j == GHOSTS:
                    values[1], values[3] = 0.0, 0.0
            ring.node_scratch[node] = values
    mirror(ring, ring.node_scratch, (-1.0, 1.0, -1.0, 1.0), (1.0, -1.0, 1.0, -1.0))


@ti.func
def fold_scratch(ring: ti.template(), ghost, image, in_x, in_y):
    ring.node_scratch[image] = ring.node_scratch[image] + ti.Vector([in_x, in_y, in_x, in_y]) * ring.node_scratch[ghost]
