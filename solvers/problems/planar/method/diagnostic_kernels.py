"""Diagnostics in kernels that use the tables of the exact motion: errors of particles, and angular momentum."""

import taichi as ti

from solvers.problems.planar.method import node_acceleration_errors
from solvers.problems.planar.method.material_laws import cauchy_stress, cauchy_stress_of, strain_energy
from solvers.problems.planar.method.motion_contradictions import make_circle_contradiction_kernel, record_mode_moments
from solvers.problems.planar.method.node_acceleration_errors import make_node_acceleration_error
from solvers.problems.planar.method.phases import TOTALS
from solvers.problems.planar.method.tensor_rotation import rotate_tensor, rotate_vector
from solvers.problems.planar.problem_kernel_functions import ProblemDiagnosticFunctions
from solvers.problems.planar.scene import PlanarScene
from solvers.scene.effects import samplers
from solvers.solver.samples import column_index
from solvers.solver.separable_field_tables import GRID, MODES, MOTION, PRESENT, RANK, compute_time_functions, table_size


@ti.func
def compute_exact_solution(body: ti.template(), step, on: ti.template()):
    """Writes the exact solution at the orbits' points after ``step`` steps to ``exact``, and the functions of time of
    the nodes' acceleration to the tables; accelerations are of one step before, as the method's own."""
    w = body.angular_frequency
    now = w * body.dt * step
    before = ti.max(0.0, now - w * body.dt)
    for number in range(MOTION, GRID + 1):  # one loop, for its code is compiled once
        compute_time_functions(body.tables, body.table_sizes, number, w, now, before)
    rank, modes = table_size(body, MOTION, RANK), table_size(body, MOTION, MODES)
    out = table_size(body, MOTION, PRESENT)
    for k in range(body.orbits):
        motion, a, F = ti.Vector([0.0] * 4), ti.Vector([0.0] * 4), ti.Vector([1.0, 0.0, 0.0, 1.0])
        for n in range(rank):
            at = modes + 2 * (k * rank + n)
            T, u = body.tables[out + n], body.tables[at]
            motion += ti.Vector([T[0] * u[0], T[0] * u[1], T[1] * u[0], T[1] * u[1]])
            a += T[2] * u
            F += T[0] * body.tables[at + 1]
        sigma = cauchy_stress_of(body, F, on)
        body.exact[3 * k], body.exact[3 * k + 1] = motion, a
        body.exact[3 * k + 2] = ti.Vector([sigma[0], sigma[1], sigma[2], 0.0])


@ti.func
def vector_errors(body: ti.template(), p, on: ti.template()):
    """Returns the true errors at particle p: of x (m) and v (m/s) as one vector of four, and of a (m/s^2)."""
    at, e, X, q = 3 * body.orbit[p], body.direction[p], body.material_position[p], body.position_velocity[p]
    f = body.exact[at]
    u, v = rotate_vector(e, f[0], f[1]), rotate_vector(e, f[2], f[3])
    a = ti.Vector([0.0, 0.0])
    if ti.static(on.acceleration):
        g = body.exact[at + 1]
        a = body.acceleration[p] - rotate_vector(e, g[0], g[1])
    return ti.Vector([q[0] - X[0] - u[0], q[1] - X[1] - u[1], q[2] - v[0], q[3] - v[1]]), a


@ti.func
def stress_error(body: ti.template(), p, on: ti.template()):
    """Returns the true error of the Cauchy stress at particle p, as xx, xy, yy in Pa."""
    f = body.exact[3 * body.orbit[p] + 2]
    return cauchy_stress(body, p, on) - rotate_tensor(body.direction[p], f[0], f[1], f[2])


@ti.func
def sample_angular_momentum(body: ti.template(), row, step, on: ti.template()):
    """Writes the particles' angular momentum, and the impulse of the body force's torque so far, to sample ``row``."""
    momentum, torque = 0.0, 0.0
    for p in range(body.particles):
        q = body.position_velocity[p]
        momentum += body.mass[p] * (q[0] * q[3] - q[1] * q[2])
    for slab in range(body.slabs):
        torque += body.totals[ti.static(TOTALS) * slab + 2]
    body.samples[row, ti.static(column_index("spin/momentum", on))] = momentum
    body.samples[row, ti.static(column_index("spin/torque", on))] = torque


def make_diagnostic_functions(kind: type[PlanarScene], first: int) -> ProblemDiagnosticFunctions:
    """Returns the diagnostic functions of the problem with the scene class ``kind``; nodes before ``first`` in a row
    lie beyond a symmetry plane."""
    nodes = node_acceleration_errors.make_circular_acceleration_error(kind, first) if kind.CIRCULAR \
        else make_node_acceleration_error(first if kind.PLANES[1] else 0)
    record_contradictions = make_circle_contradiction_kernel(kind.INNER, kind.OUTER, kind.DIRECTION == "angular") \
        if kind.CIRCULAR else record_mode_moments
    spin = {"spin": sample_angular_momentum} if "spin" in kind.OWN_EFFECTS else {}
    return ProblemDiagnosticFunctions(nodes, strain_energy, record_contradictions, samplers(kind.problem, spin))
