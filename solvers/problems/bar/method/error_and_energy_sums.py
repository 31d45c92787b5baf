"""The bar's samples: sums over particles for the norms of the true and the estimated error, and the energy.

True errors are at fixed X: computed minus exact. The acceleration is the one that the last step used, so it is
compared at that step's time, one step before the others'.
"""

import taichi as ti

from solvers.problems.bar.method import motion_contradictions
from solvers.scene.typed_motion_scene import TYPED
from solvers.solver.samples import BASE_COLUMNS, ESTIMATOR_COLUMNS, column_index
from solvers.solver.separable_field_tables import MODES, MOTION, PRESENT, RANK, compute_time_functions, table_size


@ti.func
def true_error(bar: ti.template(), p, now, on: ti.template()):
    """Returns particle p's errors (4,), computed minus exact, of x, v, sigma = E(F - 1) and a in SI; ``now`` is from
    :func:`exact_time_factors`. ``on``: compile-time options."""
    moved, v, a = now[3], bar.drift_velocity, 0.0
    strain = bar.deformation_gradient[p] - 1
    if ti.static(on.acceleration):
        a = bar.acceleration[p]
    if ti.static(on.motion == "vibrate"):
        u, w = bar.amplitude * bar.sine[p], bar.angular_frequency
        moved, v = u * now[0], u * w * now[1]
        strain -= 2 * ti.math.pi * bar.amplitude * bar.cosine[p] * now[0]
        if ti.static(on.acceleration):
            a += w * w * u * now[2]
    if ti.static(on.motion == TYPED):
        known = typed_motion_at(bar, p)
        moved, v = known[0], known[1]
        strain -= known[3]
        a -= now[2] * known[2]
    return ti.Vector([bar.position[p] - bar.material_position[p] - moved, bar.velocity[p] - v, bar.modulus * strain, a])


@ti.func
def logarithmic_stress_error(bar: ti.template(), p, now, on: ti.template()):
    """Returns particle p's error in Pa of the stress by the rate form sigma' = E L, which is E ln F (Table 1); NaN
    where F <= 0. ``now`` is from :func:`exact_time_factors`. ``on``: compile-time options."""
    error = ti.log(bar.deformation_gradient[p])
    if ti.static(on.motion == "patch"):
        error *= bar.unstretched  # E L since the start, of which the modulus here is the stretched one
    elif ti.static(on.motion == TYPED):
        error -= typed_motion_at(bar, p)[3]
    else:
        error -= 2 * ti.math.pi * bar.amplitude * bar.cosine[p] * now[0]
    return bar.modulus * error


@ti.func
def typed_motion_at(bar: ti.template(), p):
    """Returns u, v, a of the step before, and F - 1 (4,) in SI of a typed motion at particle p; for p = P the means."""
    rank, modes = table_size(bar, MOTION, RANK), table_size(bar, MOTION, MODES)
    out = table_size(bar, MOTION, PRESENT)
    known = ti.Vector([0.0, 0.0, 0.0, 0.0])
    for k in range(rank):
        T, M = bar.tables[out + k], bar.tables[modes + p * rank + k]
        known += ti.Vector([T[0] * M[0], T[1] * M[0], T[2] * M[0], T[0] * M[1]])
    return known


@ti.func
def exact_time_factors(bar: ti.template(), step, on: ti.template()):
    """Returns four factors of the exact solution: sin w t and cos w t after ``step`` steps, sin w t one before, and the
    displacement of the whole bar in m. For a typed motion the third is 1, but 0 at the start, when no acceleration has
    been computed. ``on``: compile-time options."""
    angle = bar.angular_frequency * bar.dt * step
    before = ti.max(0.0, angle - bar.angular_frequency * bar.dt)  # at the start both a are 0
    moved, used = bar.drift_velocity * bar.dt * step, ti.sin(before)
    if ti.static(on.motion == TYPED):
        compute_time_functions(bar.tables, bar.table_sizes, MOTION, bar.angular_frequency, angle, before)
        moved, used = typed_motion_at(bar, bar.particles)[0], ti.select(step > 0, 1.0, 0.0)
    return ti.Vector([ti.sin(angle), ti.cos(angle), used, moved])


@ti.func
def write_sample_row(bar: ti.template(), row, step, looks, on: ti.template()):
    """Writes sums over particles after ``step`` steps to a row of ``bar.samples``; if ``looks``, also
    contradictions. ``on``: compile-time options."""
    out = ti.static(bar.samples)
    out[row, ti.static(column_index("step"))] = step
    out[row, ti.static(column_index("work"))] = bar.totals[1]
    out[row, ti.static(column_index("crossings"))] = bar.totals[0]
    now = exact_time_factors(bar, step, on)
    if ti.static(on.truth):
        squares = ti.Vector([0.0, 0.0, 0.0, 0.0])
        extra = 0.0
        for p in range(bar.particles):
            e = true_error(bar, p, now, on)
            squares += e * e
            extra += logarithmic_stress_error(bar, p, now, on) ** 2
        for q in ti.static(range(3 + on.acceleration)):  # what is off stays NaN
            out[row, ti.static(column_index("error_x")) + q] = squares[q]
        out[row, ti.static(column_index("error_extra"))] = extra
    for e in range(ti.static(len(on.estimators))):
        squares, missed = ti.Vector([0.0, 0.0, 0.0, 0.0]), ti.Vector([0.0, 0.0, 0.0, 0.0])
        for p in range(bar.particles):
            estimate = bar.estimate[e * bar.particles + p]
            squares += estimate * estimate
            if ti.static(on.truth):
                d = estimate - true_error(bar, p, now, on)
                missed += d * d
        for q in ti.static(range(4)):
            at = ti.static(len(BASE_COLUMNS)) + ti.static(len(ESTIMATOR_COLUMNS)) * e + q
            out[row, at] = squares[q]
            if ti.static(on.truth and (q < 3 or on.acceleration)):
                out[row, at + 4] = missed[q]
    for q in ti.static(range(column_index("neighbour_gap"), column_index("margin") + 1)):
        out[row, q] = ti.math.nan
    if ti.static(on.soundness):
        if looks:
            motion_contradictions.record_contradictions(bar, row, now[3])
    if ti.static(on.energy):
        kinetic, strain = 0.0, 0.0
        for p in range(bar.particles):
            kinetic += bar.velocity[p] ** 2
            strain += (bar.deformation_gradient[p] - bar.unstretched) ** 2
        out[row, ti.static(column_index("kinetic"))] = 0.5 * bar.density * bar.volume * kinetic
        out[row, ti.static(column_index("strain"))] = 0.5 * bar.modulus * bar.volume * strain
