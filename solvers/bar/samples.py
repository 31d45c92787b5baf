"""The bar's samples: sums over particles for the norms of the true and the estimated error, and the energy.

True errors are at fixed X: computed minus exact. The acceleration is the one that the last step used, so it is
compared at that step's time, one step before the others'.
"""

import taichi as ti

from solvers.bar import soundness
from solvers.samples import BASE, EACH, column


@ti.func
def true_error(bar: ti.template(), p, sin_t, cos_t, sin_before, on: ti.template()):
    """Errors of x, v, sigma = E(F - 1) and a at particle p."""
    w = bar.angular_frequency
    u = bar.amplitude * bar.sine[p]
    stretch = 2 * ti.math.pi * bar.amplitude * bar.cosine[p] * sin_t  # exact F - 1
    a = 0.0
    if ti.static(on.acceleration):
        a = bar.acceleration[p] + w * w * u * sin_before
    return ti.Vector([bar.position[p] - bar.material_position[p] - u * sin_t, bar.velocity[p] - u * w * cos_t,
                      bar.modulus * (bar.deformation_gradient[p] - 1 - stretch), a])


@ti.func
def logarithmic_stress_error(bar: ti.template(), p, sin_t):
    """Error of the stress that the rate form sigma' = E L integrates to, E ln F (Table 1); NaN where F <= 0."""
    stretch = 2 * ti.math.pi * bar.amplitude * bar.cosine[p] * sin_t
    return bar.modulus * (ti.log(bar.deformation_gradient[p]) - stretch)


@ti.func
def sample(bar: ti.template(), row, step, looks, on: ti.template()):
    """Write one row of sums; with ``looks`` also contradictions, which are looked for more rarely."""
    out = ti.static(bar.samples)
    out[row, ti.static(column("step"))] = step
    out[row, ti.static(column("work"))] = bar.totals[1]
    out[row, ti.static(column("crossings"))] = bar.totals[0]
    angle = bar.angular_frequency * bar.dt * step
    sin_t, cos_t = ti.sin(angle), ti.cos(angle)
    sin_before = ti.sin(ti.max(0.0, angle - bar.angular_frequency * bar.dt))  # at the start both a are 0
    if ti.static(on.truth):
        squares = ti.Vector([0.0, 0.0, 0.0, 0.0])
        extra = 0.0
        for p in range(bar.particles):
            e = true_error(bar, p, sin_t, cos_t, sin_before, on)
            squares += e * e
            extra += logarithmic_stress_error(bar, p, sin_t) ** 2
        for q in ti.static(range(3 + on.acceleration)):  # what is off stays NaN
            out[row, ti.static(column("error_x")) + q] = squares[q]
        out[row, ti.static(column("error_extra"))] = extra
    for e in range(ti.static(len(on.estimators))):
        squares, missed = ti.Vector([0.0, 0.0, 0.0, 0.0]), ti.Vector([0.0, 0.0, 0.0, 0.0])
        for p in range(bar.particles):
            estimate = bar.estimate[e * bar.particles + p]
            squares += estimate * estimate
            if ti.static(on.truth):
                d = estimate - true_error(bar, p, sin_t, cos_t, sin_before, on)
                missed += d * d
        for q in ti.static(range(4)):
            at = ti.static(len(BASE)) + ti.static(len(EACH)) * e + q
            out[row, at] = squares[q]
            if ti.static(on.truth and (q < 3 or on.acceleration)):
                out[row, at + 4] = missed[q]
    for q in ti.static(range(column("apart"), column("margin") + 1)):
        out[row, q] = ti.math.nan
    if ti.static(on.soundness):
        if looks:
            soundness.look(bar, row)
    if ti.static(on.energy):
        kinetic, strain = 0.0, 0.0
        for p in range(bar.particles):
            kinetic += bar.velocity[p] ** 2
            strain += (bar.deformation_gradient[p] - 1) ** 2
        out[row, ti.static(column("kinetic"))] = 0.5 * bar.density * bar.volume * kinetic
        out[row, ti.static(column("strain"))] = 0.5 * bar.modulus * bar.volume * strain
