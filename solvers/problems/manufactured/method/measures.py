"""What kernels know of a manufactured problem: its force and its exact solution, from the tables of its body."""

from typing import Any, NamedTuple

import taichi as ti

from solvers.problems.manufactured.method.body import FORCE, GRID, MOTION
from solvers.problems.planar.method import neo_hookean
from solvers.problems.planar.method.field_tables import (
    FACTS,
    MODES,
    PRESENT,
    RANK,
    find_functions,
    find_pair_functions,
    pair_sum,
)
from solvers.problems.planar.method.neo_hookean import cauchy_stress, cauchy_stress_of, strain_energy, stress, tangent
from solvers.problems.planar.method.soundness import look_at_neighbours
from solvers.problems.planar.method.symmetry_planes import symmetry_planes
from solvers.problems.planar.parts import Measures, Traits
from solvers.scene import balance
from solvers.scene.effects import samplers
from solvers.solver.samples import column


@ti.func
def find_forces(body: ti.template(), t, on: ti.template()):
    """The functions of time of the body force."""
    if ti.static(on.body_force != "none"):
        find_pair_functions(body.tables, body.table_sizes, FORCE, body.angular_frequency * t)


@ti.func
def prepare(body: ti.template(), start, end):
    """lambda ln J and the body force per mass of the particles from ``start`` to ``end``."""
    neo_hookean.prepare(body, start, end)
    for p in range(start, end):
        body.particle_force[p] = pair_sum(body.tables, body.table_sizes, FORCE, p)


@ti.func
def body_force_on(body: ti.template(), p):
    """The body force on a particle, in N."""
    return body.mass[p] * body.particle_force[p]


@ti.func
def exact_at_step(body: ti.template(), step):
    """Find the functions of time of motion and nodes' acceleration at the step."""
    now = body.angular_frequency * body.dt * step
    before = ti.max(0.0, now - body.angular_frequency * body.dt)
    for number in ti.static((MOTION, GRID)):
        find_functions(body.tables, body.table_sizes, number, body.angular_frequency, now, before)
    return 0.0


@ti.func
def fact(body: ti.template(), number: ti.template(), which: ti.template()):
    """Of the sizes of a table."""
    return body.table_sizes[ti.static(FACTS * number + which)]


@ti.func
def vector_errors(body: ti.template(), p, now, on: ti.template()):
    """Errors of x and v as one vector of four, and of a, at particle p."""
    X, q = body.material_position[p], body.position_velocity[p]
    rank, modes, out = fact(body, MOTION, RANK), fact(body, MOTION, MODES), fact(body, MOTION, PRESENT)
    motion, a = ti.Vector([q[0] - X[0], q[1] - X[1], q[2], q[3]]), ti.Vector([0.0, 0.0])
    if ti.static(on.acceleration):
        a = body.acceleration[p]
    for k in range(rank):
        u, T = body.tables[modes + 2 * (p * rank + k)], body.tables[out + k]
        motion = motion - ti.Vector([T[0] * u[0], T[0] * u[1], T[1] * u[0], T[1] * u[1]])
        if ti.static(on.acceleration):
            a = a - ti.Vector([T[2] * u[0], T[2] * u[1]])
    return motion, a


@ti.func
def stress_error(body: ti.template(), p, now):
    """Error of the Cauchy stress, as xx, xy, yy."""
    F, rank = ti.Vector([1.0, 0.0, 0.0, 1.0]), fact(body, MOTION, RANK)
    modes, out = fact(body, MOTION, MODES), fact(body, MOTION, PRESENT)
    for k in range(rank):
        F += body.tables[out + k][0] * body.tables[modes + 2 * (p * rank + k) + 1]
    return cauchy_stress(body, p) - cauchy_stress_of(body, F)


@ti.func
def look(body: ti.template(), row):
    """Write how far neighbours are from where they should stand, and the moments of the displacement with the modes of
    the exact motion: see ``ManufacturedScene.balanced_motion``."""
    look_at_neighbours(body, row)
    squares, sums = 0.0, ti.Vector([0.0] * balance.MODES)
    rank, modes = fact(body, MOTION, RANK), fact(body, MOTION, MODES)
    for p in range(body.particles):
        X, q = body.material_position[p], body.position_velocity[p]
        u = ti.Vector([q[0] - X[0], q[1] - X[1]])
        squares += u[0] * u[0] + u[1] * u[1]
        for k in ti.static(range(balance.MODES)):
            if k < rank:
                m = body.tables[modes + 2 * (p * rank + k)]
                sums[k] += u[0] * m[0] + u[1] * m[1]
    body.samples[row, ti.static(column("motion_square"))] = squares
    for k in ti.static(range(balance.MODES)):
        body.samples[row, ti.static(column("motion_0")) + k] = sums[k]
    body.samples[row, ti.static(column("out_of_shape"))] = 0.0  # no symmetry within the body is known


class Kernels(NamedTuple):
    """What is made of a kind of symmetry planes."""

    traits: Traits
    measures: Measures
    has_escaped: Any


def kernels_between(problem: str, low: bool, high: bool) -> Kernels:
    """For bodies between planes at the lower ends of x and y, at both ends, or at none, of a problem
    by its name."""
    planes = symmetry_planes(low, high)

    @ti.func
    def has_escaped(body: ti.template(), p, step):
        """Whether a particle is a cell beyond a plane, or too far away."""
        q = body.position_velocity[p]
        least = -body.spacing if ti.static(low) else -body.farthest
        return not (q[0] > least and q[1] > least and q[0] < body.farthest and q[1] < body.farthest)

    @ti.func
    def node_acceleration_error(body: ti.template(), now, on: ti.template()):
        """Mean squared error of the nodes' acceleration against the exact one at the place of the node."""
        total, count, rank = 0.0, 0, fact(body, GRID, RANK)
        modes, out = fact(body, GRID, MODES), fact(body, GRID, PRESENT)
        last = body.row - 1 - ti.static(planes.first if high else 0)
        for node in range(body.nodes):
            i, j = node % body.row, node // body.row
            if i >= planes.first and j >= planes.first and i <= last and j <= last and body.node_mass[node] > 0:
                motion = body.node_motion[node]
                miss = ti.Vector([motion[2], motion[3]])
                for k in range(rank):
                    a = body.tables[modes + node * rank + k]
                    miss = miss - body.tables[out + k][3] * ti.Vector([a[0], a[1]])
                total += miss[0] * miss[0] + miss[1] * miss[1]
                count += 1
        return total / ti.max(count, 1)

    traits = Traits(forces=find_forces, prepare=prepare, body_force_on=body_force_on, stress=stress,
                    tangent=tangent, **planes._asdict())
    measures = Measures(exact_at_step, vector_errors, stress_error, node_acceleration_error, strain_energy, look,
                        samplers(problem, {}))
    return Kernels(traits, measures, has_escaped)
