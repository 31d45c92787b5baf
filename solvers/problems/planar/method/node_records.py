"""What a particle gives to nodes: eight numbers, momentum, force, mass and three zeros, a whole vector register."""

import taichi as ti

from solvers.kernels import runtime

NONZERO_ENTRIES = 5  # numbers of a node's record that are not always zero


@ti.func
def contribution_of(body: ti.template(), p, traits: ti.template(), on: ti.template()):
    """What a particle gives to nodes: a node record by weight, V sigma = (xx, xy, yx, yy) by gradient of the weight."""
    q, mass = body.position_velocity[p], body.mass[p]
    force = ti.Vector([0.0, 0.0])
    if ti.static(on.body_force != "none"):
        force = traits.body_force_on(body, p)
    tau = (mass / body.density) * traits.stress(body, p, on)  # V sigma = V0 J sigma
    return ti.Vector([mass * q[2], mass * q[3], force[0], force[1], mass, 0.0, 0.0, 0.0]), tau


@ti.func
def force_record(x, y):
    """The record of a node on which nothing but a force acts."""
    return ti.Vector([0.0, 0.0, x, y, 0.0, 0.0, 0.0, 0.0])


@ti.func
def scatter_add(records: ti.template(), place, record):
    """Add to one of many records: of nodes, as particles do, or of circles.

    On a processor nobody else adds there (slabs have grids of their own), and an atomic addition, which += would be,
    costs three times as much. On a GPU all particles add at once.
    """
    if ti.static(runtime.runs_on_cpu()):
        records[place] = records[place] + record
    else:
        for c in ti.static(range(min(NONZERO_ENTRIES, record.n))):
            ti.atomic_add(records[place][c], record[c])
