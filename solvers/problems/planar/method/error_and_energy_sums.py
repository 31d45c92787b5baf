"""Samples of a plane body: sums over particles for the norms of the true and the estimated error, and the energy.

Errors are vectors (x, v, a) or tensors (sigma) at a fixed material point, computed minus exact; their sizes are
Euclidean and Frobenius norms. The acceleration is the one that the last step used, so it is compared at that step's
time. ``error_extra`` is the paper's "Err A": the error of the acceleration at the nodes that carry mass.

Sums over particles are Python lists, which Taichi makes one variable per number. On a GPU it stores variables that two
loops share one after another, and a vector after an odd number of integers at an address that CUDA refuses.
"""

import taichi as ti

from solvers.kernels import runtime
from solvers.problems.planar.method.diagnostic_kernels import compute_exact_solution, stress_error, vector_errors
from solvers.problems.planar.method.phases import TOTALS
from solvers.solver.samples import BASE_COLUMNS, ESTIMATOR_COLUMNS, column_index
from solvers.solver.serial_stepping import sample_effects


@ti.func
def squared_frobenius_norm(tensor):
    """Returns the squared Frobenius norm of a symmetric ``tensor`` (xx, xy, yy)."""
    return tensor[0] * tensor[0] + 2 * tensor[1] * tensor[1] + tensor[2] * tensor[2]


@ti.func
def squared_norms(motion, sigma, a):
    """Returns the squared sizes of x, v, sigma and a, from ``motion`` = (x, v), ``sigma`` = (xx, xy, yy) and ``a``."""
    return ti.Vector([motion[0] * motion[0] + motion[1] * motion[1], motion[2] * motion[2] + motion[3] * motion[3],
                      squared_frobenius_norm(sigma), a[0] * a[0] + a[1] * a[1]])


@ti.func
def sample(body: ti.template(), row, step, looks, measures: ti.template(), on: ti.template()):
    """Writes sample ``row`` of the state after ``step`` steps; with ``looks`` also contradictions, which are rarer."""
    sample_sums(body, row, step, measures, on)
    if ti.static(on.soundness):
        if looks:
            measures.record_contradictions(body, row)


@ti.func
def sample_sums(body: ti.template(), row, step, measures: ti.template(), on: ti.template()):
    """Writes sample ``row`` of the state after ``step`` steps: sums over particles, without contradictions."""
    crossings, work = 0.0, 0.0
    for slab in range(body.slabs):
        crossings += body.totals[ti.static(TOTALS) * slab]
        work += body.totals[ti.static(TOTALS) * slab + 1]
    body.samples[row, ti.static(column_index("step"))] = step
    body.samples[row, ti.static(column_index("work"))] = work
    body.samples[row, ti.static(column_index("crossings"))] = crossings
    if ti.static(on.truth):
        compute_exact_solution(body, step, on)
        sample_truth(body, row, step, measures, on)
    if ti.static(len(on.estimators) > 0):
        sample_estimates(body, row, step, on)
    for q in ti.static(range(column_index("neighbour_gap"), column_index("margin") + 1)):
        body.samples[row, q] = ti.math.nan
    if ti.static(on.energy):
        sample_energy(body, row, measures, on)
    sample_effects(body, row, step, measures.samplers, on)


@ti.func
def sample_truth(body: ti.template(), row, step, measures: ti.template(), on: ti.template()):
    """Writes sums of squared true errors to ``row``: of x, v, sigma and, with that diagnostic, a (also at nodes)."""
    squares = [0.0, 0.0, 0.0, 0.0]
    for p in range(body.particles):
        motion, a = vector_errors(body, p, on)
        norms = squared_norms(motion, stress_error(body, p, on), a)
        for q in ti.static(range(4)):
            squares[q] += norms[q]
    for q in ti.static(range(3)):
        body.samples[row, ti.static(column_index("error_x")) + q] = squares[q]
    if ti.static(on.acceleration):
        # Before the first step no acceleration has been computed, and so none can be wrong.
        nodes = measures.node_acceleration_error(body, on)
        body.samples[row, ti.static(column_index("error_a"))] = squares[3] if step > 0 else 0.0
        body.samples[row, ti.static(column_index("error_extra"))] = nodes * body.particles if step > 0 else 0.0


@ti.func
def sample_estimates(body: ti.template(), row, step, on: ti.template()):
    """Writes sums of squares to sample ``row``: of each estimator's errors and their differences from the true ones."""
    if ti.static(runtime.runs_on_cpu()):
        for e in range(ti.static(len(on.estimators))):
            sample_estimate(body, row, step, e, on)
    else:
        for e in ti.static(range(len(on.estimators))):
            sample_estimate(body, row, step, e, on)


@ti.func
def sample_estimate(body: ti.template(), row, step, e, on: ti.template()):
    """Writes sums of squares to ``row``: of estimator number e's errors and their differences from the true ones."""
    squares, missed = [0.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0]
    for p in range(body.particles):
        motion, stress = body.estimate[e * body.particles + p], body.estimate_stress[e * body.particles + p]
        sigma = ti.Vector([stress[0], stress[1], stress[2]])
        a = body.estimate_acceleration[e * body.particles + p]
        norms = squared_norms(motion, sigma, a)
        for q in ti.static(range(4)):
            squares[q] += norms[q]
        if ti.static(on.truth):
            true_motion, true_a = vector_errors(body, p, on)
            if step == 0:  # none has been computed, and so none can be wrong
                true_a = ti.Vector([0.0, 0.0])
            true_sigma = stress_error(body, p, on)
            norms = squared_norms(motion - true_motion, sigma - true_sigma, a - true_a)
            for q in ti.static(range(4)):
                missed[q] += norms[q]
    at = ti.static(len(BASE_COLUMNS)) + ti.static(len(ESTIMATOR_COLUMNS)) * e
    for q in ti.static(range(4)):
        body.samples[row, at + q] = squares[q]
        if ti.static(on.truth and (q < 3 or on.acceleration)):
            body.samples[row, at + 4 + q] = missed[q]


@ti.func
def sample_energy(body: ti.template(), row, measures: ti.template(), on: ti.template()):
    """Writes the particles' kinetic energy and strain energy, in J per metre of thickness, to sample ``row``."""
    kinetic, strain = 0.0, 0.0
    for p in range(body.particles):
        q, mass = body.position_velocity[p], body.mass[p]
        kinetic += 0.5 * mass * (q[2] * q[2] + q[3] * q[3])
        strain += measures.strain_energy(body, p, on)
    body.samples[row, ti.static(column_index("kinetic"))] = kinetic
    body.samples[row, ti.static(column_index("strain"))] = strain
