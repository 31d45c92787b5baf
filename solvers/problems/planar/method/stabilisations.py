"""Remedies in the plane against breakdown in long motions (see ``solvers.scene.stabilisations``).

As for the bar: the null-space filter of the particles' velocity, and F drawn towards that of their displacements. A
record of a particle, or of a node, is (v_x, v_y, u_x, u_y): both are mapped at once.
"""

import taichi as ti

from solvers.problems.planar.method import cpdi, gimp
from solvers.problems.planar.method.phases import active_particle_count, gather

PASSES = 4  # of the coupling: u_i = sum over l < 4 of (I - S^+ S)^l S^+ (x - X)
LEAST_JACOBIAN = 0.1  # of I - grad u, below which its inverse is meaningless


@ti.func
def in_step(body: ti.template(), step, traits: ti.template(), on: ti.template()):
    """Applies the stabilisations that are due in step number ``step``, after the nodes have moved."""
    if ti.static(on.filtered or on.coupled):
        if step % body.remedy_interval == 0:
            apply_remedies(body, traits, on)


@ti.func
def apply_remedies(body: ti.template(), traits: ti.template(), on: ti.template()):
    """Applies the active ones of v_p -= rate (I - S S^+)^2 v and F += rate ((I - grad u)^-1 - F) to all particles, with
    u_i the nodes' sharpened copy of x - X; S maps nodes to particles, S^+ back."""
    begin_remedies(body, on)
    for pass_number in range(ti.static(PASSES if on.coupled else 1)):
        sharpen(body, pass_number, traits, on)
    end_remedies(body, on)


@ti.func
def begin_remedies(body: ti.template(), on: ti.template()):
    """Writes the particles' records, the part of v that nodes lacked before the step and x - X; zeros the nodes'."""
    for node in range(body.nodes):
        body.node_remedy[node] = ti.Vector([0.0] * 4)
    for p in range(active_particle_count(body)):
        q, X = body.position_velocity[p], body.material_position[p]
        here, _, _ = gather(body, p, body.node_motion, on)
        seen = body.dt * ti.Vector([here[2], here[3]])  # v_i before the step's acceleration
        body.particle_scratch[p] = ti.Vector([q[2] - here[0] + seen[0], q[3] - here[1] + seen[1],
                                              q[0] - X[0], q[1] - X[1]])


@ti.func
def sharpen(body: ti.template(), pass_number, traits: ti.template(), on: ti.template()):
    """Adds what nodes see of the particles' records to the nodes' (of v in pass 0 only), and leaves to the particles
    what is not seen of x - X."""
    scratch_to_nodes(body, traits, on)
    for node in range(body.nodes):
        new = body.node_scratch[node]
        if pass_number > 0:
            new[0], new[1] = 0.0, 0.0
        body.node_remedy[node] = body.node_remedy[node] + new
    if ti.static(on.coupled):
        for p in range(active_particle_count(body)):
            seen, _, _ = gather(body, p, body.node_scratch, on)
            left = body.particle_scratch[p]
            body.particle_scratch[p] = ti.Vector([left[0], left[1], left[2] - seen[2], left[3] - seen[3]])


@ti.func
def end_remedies(body: ti.template(), on: ti.template()):
    """Moves the particles' v and F towards their targets by the share ``remedy_rate`` of the difference."""
    for p in range(active_particle_count(body)):
        here, by_x, by_y = gather(body, p, body.node_remedy, on)
        if ti.static(on.filtered):
            unseen, q = body.particle_scratch[p], body.position_velocity[p]
            body.position_velocity[p] = ti.Vector([q[0], q[1], q[2] - body.remedy_rate * (unseen[0] - here[0]),
                                                   q[3] - body.remedy_rate * (unseen[1] - here[1])])
        if ti.static(on.coupled):
            xx, xy, yx, yy = 1 - by_x[2], -by_y[2], -by_x[3], 1 - by_y[3]
            J = xx * yy - xy * yx
            if J > LEAST_JACOBIAN and xx + yy > 0:
                F = body.deformation_gradient[p]
                target = ti.Vector([yy, -xy, -yx, xx]) / J
                body.deformation_gradient[p] = F + body.remedy_rate * (target - F)


@ti.func
def scratch_to_nodes(body: ti.template(), traits: ti.template(), on: ti.template()):
    """Maps the particles' ``particle_scratch`` to the nodes' ``node_scratch`` by S^+: weighted by mass, folded at
    symmetry planes like a velocity."""
    for node in range(body.nodes):
        body.node_scratch[node] = ti.Vector([0.0] * 4)
    for p in range(active_particle_count(body)):
        carried = body.mass[p] * body.particle_scratch[p]
        if ti.static(on.method == "cpdi"):
            cpdi.scatter(body, p, carried, body.node_scratch, on)
        else:
            gimp.scatter(body, p, carried, body.node_scratch, on)
    traits.fold(body, fold_scratch)
    for j in range(traits.first, body.active):
        for i in range(traits.first, body.active):
            node = j * body.row + i
            mass, sums = body.node_mass[node], body.node_scratch[node]
            values = ti.Vector([0.0] * 4)
            if mass > 0:
                values = traits.pin(body, i, j, sums / mass)
            body.node_scratch[node] = values
    traits.mirror(body, body.node_scratch)


@ti.func
def fold_scratch(body: ti.template(), ghost, image, in_x, in_y):
    """Adds ``node_scratch`` of node ``ghost`` to its ``image``'s, with the signs ``in_x`` and ``in_y`` of vectors."""
    body.node_scratch[image] = body.node_scratch[image] + ti.Vector([in_x, in_y, in_x, in_y]) * body.node_scratch[ghost]
