"""The budget's columns of a sample: of each field sums over particles of e^2, of e_c e and of e_c^2, where e is
the true error, or what the companion says of it."""

import taichi as ti

from solvers.problems.bar.method.samples import exact_now, true_error
from solvers.scene.causes import FIELDS
from solvers.solver.samples import BUDGET, column

EACH_FIELD = len(BUDGET) // len(FIELDS)  # columns


@ti.func
def sample(bar: ti.template(), row, step, on: ti.template()):
    """Write them; F is counted from the bar at rest."""
    out = ti.static(bar.samples)
    P = bar.particles
    now = exact_now(bar, step)
    base = 0
    if ti.static(not on.truth):
        base = ti.static(on.estimators.index("companion")) * P
    for f in ti.static(range(3)):
        unit = 1.0
        if ti.static(f == 2):
            unit = 1 / bar.unstretched
        square = 0.0
        shared, own = ti.Vector([0.0, 0.0, 0.0, 0.0]), ti.Vector([0.0, 0.0, 0.0, 0.0])
        for p in range(P):
            e = 0.0
            if ti.static(on.truth):
                e = true_error(bar, p, now, on)[f]
            else:
                e = bar.estimate[base + p][f]
            if ti.static(f == 2):
                e /= bar.modulus
            causes = bar.cause_errors[f * P + p]
            square += e * e
            shared += e * causes
            own += causes * causes
        at = ti.static(column(BUDGET[0], on) + EACH_FIELD * f)
        out[row, at] = unit * unit * square
        for c in ti.static(range(4)):
            out[row, at + 1 + c] = unit * unit * shared[c]
            out[row, at + 5 + c] = unit * unit * own[c]
