"""The phases of one step in the plane: as the bar's (symplectic Euler, stress last).

Particles are divided into slabs that can run in parallel: each adds to a grid of its own, and the grids are summed, so
that no two threads write to one place and no atomic operation is needed. A serial step has a single slab.
"""

import taichi as ti

from solvers.kernels import runtime
from solvers.problems.planar.method import cpdi, gimp
from solvers.problems.planar.method.stored_weights import BLOCK
from solvers.solver.base import SOUND

EMPTY = 1e-12  # share of a particle's mass below which a node carries nothing
TOTALS = 3  # of a slab, so far: grid crossings, work and impulse of the torque of the body force


@ti.func
def map_and_update_nodes(body: ti.template(), t, traits: ti.template(), on: ti.template()):
    """Runs the first half of a step on one thread, from time t in s: particles to nodes, and the nodes' new motion."""
    traits.forces(body, t, on)
    particles_to_nodes(body, 0, traits, on)
    traits.fold(body, fold_ghost_sums)
    for j in range(traits.first, body.active):
        update_node_row(body, j, traits, on)
    traits.mirror(body, body.node_motion)


@ti.func
def active_particle_count(body: ti.template()):
    """Returns the number of particles to step: all; on a GPU none once the run is unstable, as steps are queued."""
    count = body.particles
    if ti.static(not runtime.runs_on_cpu()):
        count *= 1 - ti.min(body.verdict[0] - SOUND,
                            1)  # a condition would get lost (``solvers.kernels.elementary_functions``)
    return count


@ti.func
def particles_to_nodes(body: ti.template(), slab, traits: ti.template(), on: ti.template()):
    """Clears the grid of slab number ``slab``, stores its particles' weights, and adds mass, momentum and force to the
    grid. Weights have a loop of their own: short enough for a processor to work on several particles at a time."""
    start, end = particle_range(body, body.particles, slab)
    grid = slab * body.nodes
    for j in range(body.active):
        for node in range(grid + j * body.row, grid + j * body.row + body.active):
            body.node_sums[node] = ti.Vector([0.0] * 8)
    map_to_nodes(body, start, end, grid, traits, on)


@ti.func
def map_to_nodes(body: ti.template(), start, end, grid, traits: ti.template(), on: ti.template()):
    """Stores weights of the particles from ``start`` up to ``end``, and adds mass, momentum and force to the cleared
    nodes from number ``grid`` on."""
    if ti.static(not on.frozen):
        find_weights(body, start, end, on)
    traits.prepare(body, start, end, on)
    if ti.static(on.method == "cpdi"):
        cpdi.particles_to_nodes(body, start, end, grid, traits, on)
    else:
        gimp.particles_to_nodes(body, start, end, grid, traits, on)


@ti.func
def find_weights(body: ti.template(), start, end, on: ti.template()):
    """Stores the weights of the particles from ``start``, the first of a block, up to ``end``, for both mappings of
    the step. A CPU computes a block at a time, in which the last particle fills unused places."""
    together = ti.static(BLOCK if runtime.runs_on_cpu() else 1)
    for turn in range(start // together, (end + together - 1) // together):
        some = ti.Vector([ti.min(turn * together + k, end - 1) for k in ti.static(range(together))])
        if ti.static(on.method == "cpdi"):
            cpdi.find_weights(body, some, on)
        else:
            gimp.find_weights(body, some, on)


@ti.func
def nodes_to_particles(body: ti.template(), slab, step, traits: ti.template(), on: ti.template()):
    """Sets v += dt sum S a; x += dt sum S v_i (not the printed eq 24); F <- (I + dt L) F, L = sum v_i grad S, of the
    particles of slab number ``slab`` in step number ``step``, and adds to the slab's ``totals``."""
    start, end = particle_range(body, active_particle_count(body), slab)
    dt, jumps, work, spun = body.dt, 0.0, 0.0, 0.0
    for p in range(start, end):
        here, by_x, by_y = gather(body, p, body.node_motion, on)
        q, F = body.position_velocity[p], body.deformation_gradient[p]
        moved = q + dt * here
        if ti.static(on.velocity == "particle"):
            moved[0], moved[1] = q[0] + dt * moved[2], q[1] + dt * moved[3]
        if ti.static(on.crossings and not on.frozen):
            per = body.cells_per_length
            cells = ti.floor(moved * per) - ti.floor(q * per)
            jump = abs(cells[0]) + abs(cells[1])
            jumps += jump
            body.last_crossing[p] = ti.select(jump > 0, step, body.last_crossing[p])
        if ti.static(on.acceleration):
            body.acceleration[p] = ti.Vector([here[2], here[3]])
        if ti.static(on.energy and on.body_force != "none"):  # the power, with the velocity in the middle of the step
            force = traits.body_force_on(body, p)
            work += dt * (force[0] * (here[0] - 0.5 * dt * here[2]) + force[1] * (here[1] - 0.5 * dt * here[3]))
        if ti.static(on.spin and on.body_force != "none"):
            turning = traits.body_force_on(body, p)
            spun += dt * (q[0] * turning[1] - q[1] * turning[0])
        body.position_velocity[p] = moved
        if ti.static(on.frozen):  # the gradient of S is with respect to X
            body.deformation_gradient[p] = F + dt * ti.Vector([by_x[0], by_y[0], by_x[1], by_y[1]])
        else:  # (L F)_ij = L_ix F_xj + L_iy F_yj, the four entries side by side
            body.deformation_gradient[p] = F + dt * (
                ti.Vector([by_x[0], by_x[0], by_x[1], by_x[1]]) * ti.Vector([F[0], F[1], F[0], F[1]])
                + ti.Vector([by_y[0], by_y[0], by_y[1], by_y[1]]) * ti.Vector([F[2], F[3], F[2], F[3]]))
    total = ti.static(TOTALS) * slab
    body.totals[total] = body.totals[total] + jumps
    body.totals[total + 1] = body.totals[total + 1] + work
    body.totals[total + 2] = body.totals[total + 2] + spun


@ti.func
def gather(body: ti.template(), p, values: ti.template(), on: ti.template()):
    """Returns nodal ``values``, vectors of four, interpolated to particle p, and their x and y derivatives (per m)."""
    here, by_x, by_y = ti.Vector([0.0] * 4), ti.Vector([0.0] * 4), ti.Vector([0.0] * 4)
    if ti.static(on.method == "cpdi"):
        here, by_x, by_y = cpdi.gather(body, p, values, on)
    else:
        here, by_x, by_y = gimp.gather(body, p, values, on)
    return here, by_x, by_y


@ti.func
def jacobian(body: ti.template(), p):
    """Returns det F of particle p."""
    F = body.deformation_gradient[p]
    return F[0] * F[3] - F[1] * F[2]


@ti.func
def slab_range(count, slab, slabs):
    """Returns the start and the end of part number ``slab`` of ``slabs`` equal parts of ``count`` items."""
    return slab * (count // slabs) + ti.min(slab, count % slabs), \
        (slab + 1) * (count // slabs) + ti.min(slab + 1, count % slabs)


@ti.func
def particle_range(body: ti.template(), count, slab):
    """Returns the start and the end of the part of ``count`` particles in slab number ``slab``, in whole blocks."""
    first, last = slab_range((count + BLOCK - 1) // BLOCK, slab, body.slabs)
    return ti.min(first * BLOCK, count), ti.min(last * BLOCK, count)


@ti.func
def sum_slabs_in_row(body: ti.template(), j):
    """Adds row j of all other slabs' grids to that of the first slab's."""
    for node in range(j * body.row, j * body.row + body.active):
        for slab in range(1, body.slabs):
            body.node_sums[node] = body.node_sums[node] + body.node_sums[slab * body.nodes + node]


@ti.func
def fold_ghost_sums(body: ti.template(), ghost, image, in_x, in_y):
    """Adds the sums of node ``ghost`` to those of its mirror ``image``, with signs ``in_x`` and ``in_y`` of vectors."""
    sign = ti.Vector([in_x, in_y, in_x, in_y, 1.0, 1.0, 1.0, 1.0])
    body.node_sums[image] = body.node_sums[image] + sign * body.node_sums[ghost]


@ti.func
def update_node_row(body: ti.template(), j, traits: ti.template(), on: ti.template()):
    """Sets a_i = f_i/m_i and v_i += dt a_i of the nodes in row j; nothing moves across a symmetry plane."""
    least = EMPTY * body.density * body.spacing * body.spacing
    for i in range(traits.first, body.active):
        update_node(body, i, j, least, traits, on)


@ti.func
def update_node(body: ti.template(), i, j, least, traits: ti.template(), on: ti.template()):
    """Sets a and v of node i in row j; with a mass of ``least`` kg/m or less they are zero."""
    node = j * body.row + i
    sums = body.node_sums[node]
    mass = sums[4]
    if ti.static(on.truth or on.margin or on.filtered or on.coupled or len(on.estimators) > 0):
        body.node_mass[node] = mass  # for samples, estimators and remedies
    motion = ti.Vector([0.0, 0.0, 0.0, 0.0])
    if mass > least:
        q = ti.Vector([sums[0], sums[1], sums[2], sums[3]]) / mass
        motion = traits.pin(body, i, j, ti.Vector([q[0] + body.dt * q[2], q[1] + body.dt * q[3], q[2], q[3]]))
    body.node_motion[node] = motion
