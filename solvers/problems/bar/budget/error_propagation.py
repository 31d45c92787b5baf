"""Propagation of each cause's errors by the run's own step (see the package), and their norms in a sample.

Remedies act on the errors as on the run, for they are linear with given weights, except for the coupling's 1/(1 - G),
which is divided exactly. What they remove from the reference counts as coarse grid.
"""

import taichi as ti

from solvers.problems.bar.budget import reference_motion
from solvers.problems.bar.budget.budget_arrays import FORCE, PIECES, STRESS, VELOCITY
from solvers.problems.bar.budget.error_sources import particles_to_nodes, update_nodes
from solvers.problems.bar.budget.reference_motion import reference_motion_at, reference_time_factors
from solvers.problems.bar.method import periodic_nodes
from solvers.problems.bar.method.error_and_energy_sums import exact_time_factors, true_error
from solvers.problems.bar.method.gapless_pieces import interpolate_at_corner, piece_length
from solvers.problems.bar.method.periodic_nodes import EMPTY, GHOSTS, stencil_of
from solvers.problems.bar.method.phases import half_width
from solvers.problems.bar.method.stabilisations import MOST_GRADIENT, PASSES
from solvers.scene.error_causes import CAUSES, FIELDS
from solvers.solver.samples import BUDGET, column_index

COARSE_GRID = list(CAUSES).index("coarse_grid")  # its lane
SCRATCH = 3  # layer of ``cause_errors``, behind those of x, v and F
MIN_PIECE_LENGTH = 1e-12  # of a piece's length, in cells, by which the slope in it is still divided
COLUMNS_PER_FIELD = len(BUDGET) // len(FIELDS)  # columns


@ti.func
def update_grid(bar: ti.template(), t, on: ti.template()):
    """Runs the first half of the budget's step, from time t in s, when the run's nodes have their new motion: the
    errors of each cause at the nodes, in ``bar.budget_nodes``. ``on``: compile-time options."""
    particles_to_nodes(bar, t, reference_time_factors(bar, t), on)
    update_nodes(bar, t, on)
    if bar.taken_away >= 0:
        periodic_nodes.copy_to_periodic_images(bar.node_motion, bar.cells)


@ti.func
def in_step(bar: ti.template(), step, on: ti.template()):
    """Runs the budget's second half of step ``step``, after remedies, before particles move. ``on``: kernel options."""
    now = reference_time_factors(bar, (step - 1) * bar.dt)
    if ti.static(on.filtered or on.coupled):  # after their own turn, of which the coupling takes the displacement
        if step % bar.remedy_interval == 0:
            if ti.static(on.filtered):
                filter_null_space(bar, now, on)
            if ti.static(on.coupled):
                couple_deformation_to_positions(bar, now, on)
    nodes_to_particles(bar, now, on)


@ti.func
def correct_particles_after_step(bar: ti.template(), on: ti.template()):
    """Subtracts from x, v and F what the removed cause, if any, contributed in this step. ``on``: kernel options."""
    if ti.static(on.centred):
        subtract_mean_velocity(bar)
    if bar.taken_away >= 0:
        for p in range(bar.particles):
            bar.position[p] -= bar.removed[p][0]
            bar.velocity[p] -= bar.removed[p][1]
            bar.deformation_gradient[p] -= bar.removed[p][2]


@ti.func
def nodes_to_particles(bar: ti.template(), now, on: ti.template()):
    """Updates each cause's errors in ``bar.cause_errors`` by the step, with the sources at the particles; ``now`` are
    the :func:`reference_time_factors`. ``on``: compile-time options.

    Coarse grid: the transfer of v + dt a and a to the nodes and back, and the slope of hats in a piece; crossings: the
    slope at a particle, minus that in its piece; time step: the error of symplectic Euler.
    """
    P, M, dt = bar.particles, bar.cells + GHOSTS, bar.dt
    left = interpolate_at_corner(bar, bar.budget_nodes, 0, 0, on)[0]
    for p in range(P):
        S, dS = stencil_of(bar, p)
        i = bar.first_node[p]
        right = interpolate_at_corner(bar, bar.budget_nodes, 0, p + 1, on)[0]
        back, slope = ti.Vector([0.0, 0.0, 0.0, 0.0]), 0.0
        A, V, G = 0.0 * back, 0.0 * back, 0.0 * back
        for k in ti.static(range(3)):
            reference = bar.budget_nodes[i + k]
            velocity = bar.budget_nodes[VELOCITY * M + i + k]
            back += S[k] * reference
            slope += dS[k] * reference[0]
            A += S[k] * bar.budget_nodes[FORCE * M + i + k]
            V += S[k] * velocity
            G += dS[k] * velocity
        piece_slope, length = slope, piece_length(bar, p)
        if abs(length) > MIN_PIECE_LENGTH * bar.spacing:
            piece_slope = (right - left) / length
            if ti.static(on.pieces):
                slope = piece_slope
                G = (interpolate_at_corner(bar, bar.budget_nodes, VELOCITY * M, p + 1, on)
                     - interpolate_at_corner(bar, bar.budget_nodes, VELOCITY * M, p, on)) / length
        left = right
        m, s = reference_motion_at(bar, p, now, on), reference_motion.reference_gradients_at(bar, p, now, on)
        F, F0, stretch = bar.deformation_gradient[p], s[0], bar.cause_errors[2 * P + p]
        stretched = F * G + slope * stretch
        if ti.static(on.frozen):
            F0, stretched = 1.0, G
        give_x = ti.Vector([0.0, dt * (back[0] - m[0]), 0.0, m[2]])
        give_v = ti.Vector([0.0, dt * (back[1] - m[1]), 0.0, m[3]])
        give_F = ti.Vector([dt * F0 * (slope - piece_slope), dt * (F0 * piece_slope - s[1]), 0.0, s[2]])
        if ti.static(on.velocity == "particle"):
            give_x[1] = dt * give_v[1]
            V = bar.cause_errors[P + p] + dt * A
        if ti.static(on.velocity == "corners"):
            V, carried = corner_velocities(bar, p, on)
            give_x[1] = dt * (carried - m[0])
        if bar.taken_away >= 0:
            for c in ti.static(range(4)):
                if bar.taken_away == c:
                    bar.removed[p] = ti.Vector([give_x[c], give_v[c], give_F[c], 0.0])
                    give_x[c], give_v[c], give_F[c] = 0.0, 0.0, 0.0
        bar.cause_errors[p] += dt * V + give_x
        bar.cause_errors[P + p] += dt * A + give_v
        bar.cause_errors[2 * P + p] += dt * stretched + give_F


@ti.func
def corner_velocities(bar: ti.template(), p, on: ti.template()):
    """Returns the mean velocity in m/s at the two ends of particle p's domain: the error of it by cause (4,), and the
    reference's. ``on``: compile-time options."""
    reach, M = half_width(bar, bar.deformation_gradient[p], on) * bar.spacing, bar.cells + GHOSTS
    velocity, reference = ti.Vector([0.0, 0.0, 0.0, 0.0]), 0.0
    for side in ti.static((-1, 1)):
        x = bar.position[p] + side * reach
        s = (x - ti.floor(x)) * bar.cells_per_length
        i = ti.cast(ti.min(ti.max(ti.floor(s), 0.0), bar.cells), ti.i32)
        for k in ti.static(range(2)):
            weight = 0.5 * (s - i if k else 1 - (s - i))
            velocity += weight * bar.budget_nodes[VELOCITY * M + i + 1 + k]
            reference += weight * bar.budget_nodes[i + 1 + k][0]
    return velocity, reference


@ti.func
def subtract_mean_velocity(bar: ti.template()):
    """Subtracts from each cause's velocity errors their mean, at the end of every step."""
    P = bar.particles
    mean = ti.Vector([0.0, 0.0, 0.0, 0.0])
    for p in range(P):
        mean += bar.cause_errors[P + p]
    mean = mean / P
    for p in range(P):
        bar.cause_errors[P + p] = bar.cause_errors[P + p] - mean


@ti.func
def filter_null_space(bar: ti.template(), now, on: ti.template()):
    """Filters velocity errors of each cause: e_v -= rate (I - S S^+)^2 (e_v + v), v the reference's for the coarse
    grid; else 0. ``now`` are the :func:`reference_time_factors` of the step. ``on``: compile-time options."""
    P = bar.particles
    for p in range(P):
        m = reference_motion_at(bar, p, now, on)
        bar.cause_errors[SCRATCH * P + p] = bar.cause_errors[P + p] + ti.Vector([0.0, m[0] - bar.dt * m[1], 0.0, 0.0])
    for _ in range(2):
        scratch_to_nodes(bar)
        subtract_nodal_part(bar)
    for p in range(P):
        unseen = bar.cause_errors[SCRATCH * P + p]
        if bar.taken_away == COARSE_GRID:  # it has no errors then: this is the reference's part
            bar.velocity[p] += bar.remedy_rate * unseen[COARSE_GRID]
            unseen[COARSE_GRID] = 0.0
        bar.cause_errors[P + p] = bar.cause_errors[P + p] - bar.remedy_rate * unseen


@ti.func
def couple_deformation_to_positions(bar: ti.template(), now, on: ti.template()):
    """Couples each cause's errors of F to those of x: e_F += rate (G_c/((1 - G)(1 - G0)) - e_F), G the run's du/dx, G0
    = G - sum G_c the reference's; the coarse grid adds rate (1/(1 - G0) - F0). ``on``: compile-time options."""
    P, M = bar.particles, bar.cells + GHOSTS
    for i in range(M):
        bar.budget_nodes[STRESS * M + i] = ti.Vector([0.0, 0.0, 0.0, 0.0])
    for p in range(P):
        bar.cause_errors[SCRATCH * P + p] = bar.cause_errors[p]
    for _ in range(PASSES):
        scratch_to_nodes(bar)
        for i in range(M):
            bar.budget_nodes[STRESS * M + i] += bar.budget_nodes[PIECES * M + i]
        subtract_nodal_part(bar)
    for p in range(P):
        _, dS = stencil_of(bar, p)
        i, G = bar.first_node[p], 0.0
        parts = ti.Vector([0.0, 0.0, 0.0, 0.0])
        for k in ti.static(range(3)):
            G += dS[k] * bar.node_displacement[i + k]
            parts += dS[k] * bar.budget_nodes[STRESS * M + i + k]
        if G < MOST_GRADIENT:
            G0, stretch = G - parts.sum(), bar.cause_errors[2 * P + p]
            change = parts / ((1 - G) * (1 - G0)) - stretch
            change[COARSE_GRID] += 1 / (1 - G0) - reference_motion.reference_gradients_at(bar, p, now, on)[0]
            if bar.taken_away == COARSE_GRID:
                bar.deformation_gradient[p] -= bar.remedy_rate * change[COARSE_GRID]
                change[COARSE_GRID] = 0.0
            bar.cause_errors[2 * P + p] = stretch + bar.remedy_rate * change


@ti.func
def scratch_to_nodes(bar: ti.template()):
    """Maps the scratch layer of ``bar.cause_errors`` by S^+ to nodes, the layer ``PIECES`` of ``bar.budget_nodes``."""
    P, M = bar.particles, bar.cells + GHOSTS
    for i in range(M):
        bar.budget_nodes[PIECES * M + i] = ti.Vector([0.0, 0.0, 0.0, 0.0])
    for p in range(P):
        S, _ = stencil_of(bar, p)
        i = bar.first_node[p]
        for k in ti.static(range(3)):
            bar.budget_nodes[PIECES * M + i + k] += S[k] * bar.cause_errors[SCRATCH * P + p]
    periodic_nodes.add_periodic_images(bar.budget_nodes, bar.cells, PIECES * M)
    for i in range(1, bar.cells + 1):
        weight = bar.node_sums[i][0]
        share = 1 / weight if weight > EMPTY else 0.0
        bar.budget_nodes[PIECES * M + i] = share * bar.budget_nodes[PIECES * M + i]
    periodic_nodes.copy_to_periodic_images(bar.budget_nodes, bar.cells, PIECES * M)


@ti.func
def subtract_nodal_part(bar: ti.template()):
    """Subtracts from the scratch layer of ``bar.cause_errors`` its part at the nodes (:func:`scratch_to_nodes`)."""
    P, M = bar.particles, bar.cells + GHOSTS
    for p in range(P):
        S, _ = stencil_of(bar, p)
        i, unseen = bar.first_node[p], bar.cause_errors[SCRATCH * P + p]
        for k in ti.static(range(3)):
            unseen = unseen - S[k] * bar.budget_nodes[PIECES * M + i + k]
        bar.cause_errors[SCRATCH * P + p] = unseen


@ti.func
def sample_budget_sums(bar: ti.template(), row, step, on: ti.template()):
    """Writes sums over particles of e^2, e_c e and e_c^2, e the error of x, v or F and e_c that of a cause, to a row of
    ``bar.samples`` after ``step`` steps; F is relative to the bar at rest. ``on``: compile-time options."""
    out = ti.static(bar.samples)
    P = bar.particles
    now = exact_time_factors(bar, step, on)
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
        at = ti.static(column_index(BUDGET[0], on) + COLUMNS_PER_FIELD * f)
        out[row, at] = unit * unit * square
        for c in ti.static(range(4)):
            out[row, at + 1 + c] = unit * unit * shared[c]
            out[row, at + 5 + c] = unit * unit * own[c]
