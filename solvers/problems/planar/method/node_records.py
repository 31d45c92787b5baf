"""Node records, the sums of particles' contributions: momentum, force, mass and three zeros, one vector register."""

import taichi as ti

from solvers.kernels import runtime

NONZERO_ENTRIES = 5  # numbers of a node's record that are not always zero


@ti.func
def particle_contribution(body: ti.template(), p, traits: ti.template(), on: ti.template()):
    """Returns particle p's contribution to nodes: the record (momentum, force, mass, zeros) to multiply by a weight,
    and V sigma = (xx, xy, yx, yy), in J per metre of thickness, to multiply by its gradient."""
    q, mass = body.position_velocity[p], body.mass[p]
    force = ti.Vector([0.0, 0.0])
    if ti.static(on.body_force != "none"):
        force = traits.body_force_on(body, p)
    tau = (mass / body.density) * traits.stress(body, p, on)  # V sigma = V0 J sigma
    return ti.Vector([mass * q[2], mass * q[3], force[0], force[1], mass, 0.0, 0.0, 0.0]), tau


@ti.func
def force_record(x, y):
    """Returns the record (8,) of a node with only a force (x, y)."""
    return ti.Vector([0.0, 0.0, x, y, 0.0, 0.0, 0.0, 0.0])


@ti.func
def scatter_add(records: ti.template(), place, record):
    """Adds the vector ``record`` to entry ``place`` of the array ``records``: of nodes, or of circles.

    On a CPU no other thread adds there (slabs have grids of their own), and an atomic addition, as by +=, would cost
    three times as much. On a GPU all particles add at once.
    """
    if ti.static(runtime.runs_on_cpu()):
        records[place] = records[place] + record
    else:
        for c in ti.static(range(min(NONZERO_ENTRIES, record.n))):
            ti.atomic_add(records[place][c], record[c])
