"""The errors of each cause, carried on by the run's own step (see the package)."""

import taichi as ti

from solvers.problems.bar.budget import remedies
from solvers.problems.bar.budget.memory import FORCE, VELOCITY
from solvers.problems.bar.budget.reference import moment, motion, slopes
from solvers.problems.bar.budget.sources import particles_to_nodes, update_nodes
from solvers.problems.bar.method.nodes import GHOSTS, spread, stencil_of
from solvers.problems.bar.method.phases import half_width
from solvers.problems.bar.method.pieces import at_corner, piece_length

SHORTEST = 1e-12  # of a piece's length, in cells, by which the slope in it is still divided


@ti.func
def update_grid(bar: ti.template(), t, on: ti.template()):
    """The first half of the budget's step, from time t, when the run's nodes have their new motion."""
    particles_to_nodes(bar, t, moment(bar, t), on)
    update_nodes(bar, t, on)
    if bar.taken_away >= 0:
        spread(bar.node_motion, bar.cells)


@ti.func
def in_step(bar: ti.template(), step, on: ti.template()):
    """The second half, of step number ``step``, when the remedies have had their turn and before particles move."""
    now = moment(bar, (step - 1) * bar.dt)
    if ti.static(on.filtered or on.coupled):
        remedies.in_step(bar, step, now, on)
    nodes_to_particles(bar, now, on)


@ti.func
def after_step(bar: ti.template(), on: ti.template()):
    """Take from the particles what the cause that is taken away has given to them, beside what it gave to nodes."""
    if ti.static(on.centred):
        remedies.after_step(bar)
    if bar.taken_away >= 0:
        for p in range(bar.particles):
            bar.position[p] -= bar.removed[p][0]
            bar.velocity[p] -= bar.removed[p][1]
            bar.deformation_gradient[p] -= bar.removed[p][2]


@ti.func
def nodes_to_particles(bar: ti.template(), now, on: ti.template()):
    """Each cause's errors after the step, with what it gives at the particles:

    coarse grid: the way of v + dt a and a to the nodes and back, and the slope of hats in a piece;
    crossings: the slope that a particle sees, less that in its piece; time step: what symplectic Euler misses.
    """
    P, M, dt = bar.particles, bar.cells + GHOSTS, bar.dt
    left = at_corner(bar, bar.budget_nodes, 0, 0, on)[0]
    for p in range(P):
        S, dS = stencil_of(bar, p)
        i = bar.first_node[p]
        right = at_corner(bar, bar.budget_nodes, 0, p + 1, on)[0]
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
        if abs(length) > SHORTEST * bar.spacing:
            piece_slope = (right - left) / length
            if ti.static(on.pieces):
                slope = piece_slope
                G = (at_corner(bar, bar.budget_nodes, VELOCITY * M, p + 1, on)
                     - at_corner(bar, bar.budget_nodes, VELOCITY * M, p, on)) / length
        left = right
        m, s = motion(bar, p, now, on), slopes(bar, p, now, on)
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
            V, carried = between_corners(bar, p, on)
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
def between_corners(bar: ti.template(), p, on: ti.template()):
    """Where the corners of its domain move a particle: the causes' velocity, and that of the reference."""
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
