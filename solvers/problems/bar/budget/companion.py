"""The companion as the reference of a budget, where the exact solution is not looked at: what it does in a step, at the
particles.

The first half of a step needs the reference where the step begins, the sources of the time step where it ends, and
there the companion is at the end of the step. So they are given here, and what the next step begins with is kept.
"""

import taichi as ti

from solvers.estimators import companion as shared

TIME_STEP = 3  # its lane


@ti.func
def after_step(bar: ti.template(), step):
    """At the end of step number ``step``, when the companion has been there: what symplectic Euler has missed of it."""
    fill_elements(bar, step)
    n, P, dt = bar.companion_counts[shared.ORDER] + 1, bar.particles, bar.dt
    for p in range(P):
        at = ti.Vector([0.0, 0.0, 0.0, 0.0])
        rate = 0.0
        first = bar.companion_element[p] * n
        for k in range(n):
            at += bar.companion_basis[p * n + k] * bar.reference_elements[first + k]
            rate += bar.companion_basis[p * n + k] * bar.reference_rates[first + k]
        was, slope = bar.reference_motion[p], bar.reference_slopes[p]
        u, v, a, F = at[0], at[1], at[2], 1 + at[3]
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
def fill_elements(bar: ti.template(), step):
    """u, v, a and u_X at the points of each element after ``step`` steps, and the slope of v + dt a: cubic Hermite
    polynomials in the interval that the companion took last, of (u, v) and of (v, a)."""
    n, N, k = bar.companion_counts[shared.ORDER] + 1, bar.companion_counts[shared.NODES], \
        bar.companion_counts[shared.INTERVAL]
    H = k * bar.dt
    s = (step - ((step - 1) // k) * k) / ti.cast(k, ti.f64)
    left = 1 - s
    value = ti.Vector([(1 + 2 * s) * left * left, s * left * left * H, s * s * (3 - 2 * s), -s * s * left * H])
    slope = ti.Vector([6 * s * (s - 1) / H, 3 * s * s - 4 * s + 1, -6 * s * (s - 1) / H, 3 * s * s - 2 * s])
    for e in range(bar.companion_counts[shared.ACROSS]):
        for i in range(n):
            node = e * (n - 1) + i
            old, new = bar.companion_nodes[shared.START * N + node], bar.companion_nodes[shared.END * N + node]
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
