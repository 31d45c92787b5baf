"""The phases of one step of the ring: as the bar's (symplectic Euler, stress last), between symmetry planes.

Particles are cut into slabs that can run side by side: each adds to a grid of its own, and the grids are summed, so
that no two threads ever write to one place and no atomic operation is needed. A serial step is one of a single slab.
"""

import taichi as ti

from solvers.ring import cpdi, gimp
from solvers.ring.layout import GHOSTS
from solvers.ring.material import radial_forces

EMPTY = 1e-12  # share of a particle's mass below which a node carries nothing


@ti.func
def update_grid(ring: ti.template(), t, on: ti.template()):
    """The first half of a step on one thread, from time t: particles to nodes, and the nodes' new motion."""
    radial_forces(ring, t, on)
    particles_to_nodes(ring, 0, on)
    fold(ring, fold_sums)
    for j in range(GHOSTS, ring.active):
        update_nodes(ring, j, on)
    mirror_motion(ring)


@ti.func
def particles_to_nodes(ring: ti.template(), slab, on: ti.template()):
    """Clear the slab's grid, find its particles' weights, and add mass, momentum and force to the grid.

    Weights have a loop of their own: short enough for a processor to work on several particles at a time.
    """
    start, end = slab_range(ring.particles, slab, ring.slabs)
    grid = slab * ring.nodes
    for j in range(ring.active):
        for node in range(grid + j * ring.row, grid + j * ring.row + ring.active):
            ring.node_sums[node] = ti.Vector([0.0] * 8)
    if ti.static(not on.frozen):
        find_weights(ring, start, end, on)
    if ti.static(on.method == "cpdi"):
        cpdi.particles_to_nodes(ring, start, end, grid, on)
    else:
        gimp.particles_to_nodes(ring, start, end, grid, on)


@ti.func
def find_weights(ring: ti.template(), start, end, on: ti.template()):
    """Keep the weights of the particles from ``start`` to ``end`` for both mappings of the step."""
    if ti.static(on.method == "cpdi"):
        for p in range(start, end):
            cpdi.find_weights(ring, p, on)
    else:
        for p in range(start, end):
            gimp.find_weights(ring, p, on)


@ti.func
def nodes_to_particles(ring: ti.template(), slab, step, on: ti.template()):
    """v += dt sum S a; x += dt sum S v_i (not the printed eq 24); F <- (I + dt L) F with L = sum v_i grad S."""
    start, end = slab_range(ring.particles, slab, ring.slabs)
    dt, jumps, work = ring.dt, 0.0, 0.0
    for p in range(start, end):
        here, by_x, by_y = gather(ring, p, ring.node_motion, on)
        q, F = ring.motion[p], ring.deformation_gradient[p]
        moved = q + dt * here
        if ti.static(on.velocity == "particle"):
            moved[0], moved[1] = q[0] + dt * moved[2], q[1] + dt * moved[3]
        if ti.static(on.crossings and not on.frozen):
            per = ring.cells_per_length
            cells = ti.floor(moved * per) - ti.floor(q * per)
            jump = abs(cells[0]) + abs(cells[1])
            jumps += jump
            ring.last_crossing[p] = ti.select(jump > 0, step, ring.last_crossing[p])
        if ti.static(on.acceleration):
            ring.acceleration[p] = ti.Vector([here[2], here[3]])
        if ti.static(on.energy and on.body_force != "none"):  # the power, with the velocity in the middle of the step
            push = ring.mass[p] * ring.radial_force[ring.radius[p]] * ring.direction[p]
            work += dt * (push[0] * (here[0] - 0.5 * dt * here[2]) + push[1] * (here[1] - 0.5 * dt * here[3]))
        ring.motion[p] = moved
        if ti.static(on.frozen):  # the gradient of S is with respect to X
            ring.deformation_gradient[p] = F + dt * ti.Vector([by_x[0], by_y[0], by_x[1], by_y[1]])
        else:  # (L F)_ij = L_ix F_xj + L_iy F_yj, the four entries side by side
            ring.deformation_gradient[p] = F + dt * (
                ti.Vector([by_x[0], by_x[0], by_x[1], by_x[1]]) * ti.Vector([F[0], F[1], F[0], F[1]])
                + ti.Vector([by_y[0], by_y[0], by_y[1], by_y[1]]) * ti.Vector([F[2], F[3], F[2], F[3]]))
    ring.totals[2 * slab] = ring.totals[2 * slab] + jumps
    ring.totals[2 * slab + 1] = ring.totals[2 * slab + 1] + work


@ti.func
def gather(ring: ti.template(), p, values: ti.template(), on: ti.template()):
    """The nodes' values, four numbers, at the particle and their derivatives in x and y, with the method's weights."""
    here, by_x, by_y = ti.Vector([0.0] * 4), ti.Vector([0.0] * 4), ti.Vector([0.0] * 4)
    if ti.static(on.method == "cpdi"):
        here, by_x, by_y = cpdi.gather(ring, p, values, on)
    else:
        here, by_x, by_y = gimp.gather(ring, p, values)
    return here, by_x, by_y


@ti.func
def slab_range(count, slab, slabs):
    """The part of ``count`` things that is the slab's."""
    return slab * (count // slabs) + ti.min(slab, count % slabs), \
        (slab + 1) * (count // slabs) + ti.min(slab + 1, count % slabs)


@ti.func
def sum_slabs(ring: ti.template(), j):
    """Add the slabs' grids in row j to the first one's."""
    for node in range(j * ring.row, j * ring.row + ring.active):
        for slab in range(1, ring.slabs):
            ring.node_sums[node] = ring.node_sums[node] + ring.node_sums[slab * ring.nodes + node]


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
def fold_sums(ring: ti.template(), ghost, image, in_x, in_y):
    sign = ti.Vector([in_x, in_y, in_x, in_y, 1.0, 1.0, 1.0, 1.0])
    ring.node_sums[image] = ring.node_sums[image] + sign * ring.node_sums[ghost]


@ti.func
def update_nodes(ring: ti.template(), j, on: ti.template()):
    """a_i = f_i/m_i and v_i += dt a_i in row j; nothing moves across a symmetry plane."""
    least = EMPTY * ring.density * ring.spacing * ring.spacing
    for i in range(GHOSTS, ring.active):
        node = j * ring.row + i
        sums = ring.node_sums[node]
        mass = sums[4]
        if ti.static(on.truth or on.margin or on.filtered or on.coupled or len(on.estimators) > 0):
            ring.node_mass[node] = mass  # for samples, estimators and remedies
        motion = ti.Vector([0.0, 0.0, 0.0, 0.0])
        if mass > least:
            q = ti.Vector([sums[0], sums[1], sums[2], sums[3]]) / mass
            motion = ti.Vector([q[0] + ring.dt * q[2], q[1] + ring.dt * q[3], q[2], q[3]])
            if i == GHOSTS:
                motion[0], motion[2] = 0.0, 0.0
            if j == GHOSTS:
                motion[1], motion[3] = 0.0, 0.0
        ring.node_motion[node] = motion


@ti.func
def mirror(ring: ti.template(), values: ti.template(), in_x: ti.template(), in_y: ti.template()):
    """Copy the nodes' values, with the signs of either plane, to their images beyond the symmetry planes."""
    for j in range(GHOSTS, ring.active):
        for i in ti.static(range(GHOSTS)):
            values[j * ring.row + i] = ti.Vector(in_x) * values[j * ring.row + 2 * GHOSTS - i]
    for i in range(ring.active):
        for j in ti.static(range(GHOSTS)):
            values[j * ring.row + i] = ti.Vector(in_y) * values[(2 * GHOSTS - j) * ring.row + i]


@ti.func
def mirror_motion(ring: ti.template()):
    """The same for v and a."""
    mirror(ring, ring.node_motion, (-1.0, 1.0, -1.0, 1.0), (1.0, -1.0, 1.0, -1.0))
