"""The budget's reference in a step at a particle: the exact solution, computed from X and the time alone, or, where it
is not used, the companion. A typed motion is stored like the companion.

The first half of a step needs the reference at its start, the time step's sources at its end, and the companion is
there only after it. So ``add_companion_time_step_error`` adds the sources then, and stores the start of the next step.
"""

import taichi as ti

from solvers.estimators import companion_solution
from solvers.problems.bar.budget.budget_arrays import stores_reference
from solvers.problems.bar.method.error_and_energy_sums import typed_motion_at
from solvers.scene.error_causes import CAUSES
from solvers.solver.separable_field_tables import MODES, MOTION, PRESENT, RANK, compute_time_functions, table_size

TIME_STEP = list(CAUSES).index("time_step")  # its lane


@ti.func
def reference_time_factors(bar: ti.template(), t):
    """Returns factors of the reference in a step from time t in s on (5,): of u; v + dt a; a; and of symplectic Euler's
    errors of u and v, to be multiplied by the amplitude of u at a particle."""
    w, dt = bar.angular_frequency, bar.dt
    s0, c0, s1, c1 = ti.sin(w * t), ti.cos(w * t), ti.sin(w * (t + dt)), ti.cos(w * (t + dt))
    fast, bend = w * c0 - dt * w * w * s0, -w * w * s0
    return ti.Vector([s0, fast, bend, dt * fast - (s1 - s0), dt * bend - w * (c1 - c0)])


@ti.func
def reference_motion_at(bar: ti.template(), p, now, on: ti.template()):
    """Returns particle p's reference (4,): v + dt a, a, and symplectic Euler's errors of u and v in the step, 0 if
    added after it; ``now`` are the :func:`reference_time_factors`. ``on``: compile-time options."""
    known = ti.Vector([bar.drift_velocity, 0.0, 0.0, 0.0])
    if ti.static(stores_reference(on)):
        known = bar.reference_motion[p]
    elif ti.static(on.motion == "vibrate"):
        size = bar.amplitude * bar.sine[p]
        known = ti.Vector([size * now[1], size * now[2], size * now[3], size * now[4]])
    return known


@ti.func
def reference_gradients_at(bar: ti.template(), p, now, on: ti.template()):
    """Returns particle p's reference (3,): F, the slope of v + dt a along X in 1/s, and symplectic Euler's error of F
    in the step, 0 if added after it; ``now`` are the :func:`reference_time_factors`. ``on``: compile-time options."""
    known = ti.Vector([1.0, 0.0, 0.0])
    if ti.static(stores_reference(on)):
        kept = bar.reference_slopes[p]
        known = ti.Vector([kept[0], kept[1], 0.0])
    elif ti.static(on.motion == "vibrate"):
        size = 2 * ti.math.pi * bar.amplitude * bar.cosine[p]
        known = ti.Vector([1 + size * now[0], size * now[1], size * now[3]])
    return known


@ti.func
def add_companion_time_step_error(bar: ti.template(), step):
    """Adds symplectic Euler's errors in step ``step`` to ``bar.cause_errors``, with the companion at the step's end."""
    _evaluate_at_element_points(bar, step)
    n = bar.companion_counts[companion_solution.ORDER] + 1
    for p in range(bar.particles):
        at = ti.Vector([0.0, 0.0, 0.0, 0.0])
        rate = 0.0
        first = bar.companion_element[p] * n
        for k in range(n):
            at += bar.companion_basis[p * n + k] * bar.reference_elements[first + k]
            rate += bar.companion_basis[p * n + k] * bar.reference_rates[first + k]
        _store_reference(bar, p, at[0], at[1], at[2], 1 + at[3], rate)


@ti.func
def add_typed_time_step_error(bar: ti.template(), step):
    """Adds symplectic Euler's errors in step number ``step`` to ``bar.cause_errors``, for a typed motion."""
    angle = bar.angular_frequency * bar.dt * step
    compute_time_functions(bar.tables, bar.table_sizes, MOTION, bar.angular_frequency, angle, angle)
    rank, modes = table_size(bar, MOTION, RANK), table_size(bar, MOTION, MODES)
    out = table_size(bar, MOTION, PRESENT)
    for p in range(bar.particles):
        known, rate = typed_motion_at(bar, p), 0.0
        for k in range(rank):
            T = bar.tables[out + k]
            rate += (T[1] + bar.dt * T[2]) * bar.tables[modes + p * rank + k][1]
        _store_reference(bar, p, known[0], known[1], known[2], 1 + known[3], rate)


@ti.func
def _store_reference(bar: ti.template(), p, u, v, a, F, rate):
    """Stores particle p's reference u, v, a, F and ``rate``, the slope of v + dt a along X in 1/s, for the next step,
    and adds the time step's error in this one."""
    dt, P = bar.dt, bar.particles
    was, slope = bar.reference_motion[p], bar.reference_slopes[p]
    missed = ti.Vector([dt * was[0] - (u - slope[2]), dt * was[1] - (v - (was[0] - dt * was[1])),
                        dt * slope[1] - (F - slope[0])])
    if bar.taken_away == TIME_STEP:
        bar.position[p] -= missed[0]
        bar.velocity[p] -= missed[1]
        bar.deformation_gradient[p] -= missed[2]
    else:
        for f in ti.static(range(3)):
            bar.cause_errors[f * P + p] += ti.Vector([0.0, 0.0, 0.0, missed[f]])
    bar.reference_motion[p] = ti.Vector([v + dt * a, a, 0.0, 0.0])
    bar.reference_slopes[p] = ti.Vector([F, rate, u, 0.0])


@ti.func
def _evaluate_at_element_points(bar: ti.template(), step):
    """Computes the companion's u, v, a and u_X at each element's points after ``step`` steps, in
    ``bar.reference_elements``, and the slope of v + dt a, in ``bar.reference_rates``: cubic Hermite polynomials of (u,
    v) and of (v, a) in its last interval."""
    n, N, k = bar.companion_counts[companion_solution.ORDER] + 1, bar.companion_counts[companion_solution.NODES], \
        bar.companion_counts[companion_solution.INTERVAL]
    H = k * bar.dt
    s = (step - ((step - 1) // k) * k) / ti.cast(k, ti.f64)
    left = 1 - s
    value = ti.Vector([(1 + 2 * s) * left * left, s * left * left * H, s * s * (3 - 2 * s), -s * s * left * H])
    slope = ti.Vector([6 * s * (s - 1) / H, 3 * s * s - 4 * s + 1, -6 * s * (s - 1) / H, 3 * s * s - 2 * s])
    for e in range(bar.companion_counts[companion_solution.ACROSS]):
        for i in range(n):
            node = e * (n - 1) + i
            old, new = (bar.companion_nodes[companion_solution.START * N + node],
                        bar.companion_nodes[companion_solution.END * N + node])
            u = value[0] * old[0] + value[1] * old[2] + value[2] * new[0] + value[3] * new[2]
            v = value[0] * old[2] + value[1] * old[4] + value[2] * new[2] + value[3] * new[4]
            a = slope[0] * old[2] + slope[1] * old[4] + slope[2] * new[2] + slope[3] * new[4]
            bar.reference_elements[e * n + i] = ti.Vector([u, v, a, 0.0])
        for i in range(n):
            stretch, rate = 0.0, 0.0
            for j in range(n):
                point, D = bar.reference_elements[e * n + j], bar.companion_matrices[i * n + j][0]
                stretch += D * point[0]
                rate += D * (point[1] + bar.dt * point[2])
            bar.reference_elements[e * n + i] += ti.Vector([0.0, 0.0, 0.0, stretch])
            bar.reference_rates[e * n + i] = rate
