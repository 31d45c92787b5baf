"""What the remedies do to the errors of each cause: the same as to the run, for they are linear with the weights given,
but for the coupling's 1/(1 - G), which is divided exactly. What they take from the reference itself, because the grid
cannot hold it, is the coarse grid's.
"""

import taichi as ti

from solvers.problems.bar.budget.memory import PIECES, STRESS
from solvers.problems.bar.budget.reference import motion, slopes
from solvers.problems.bar.budget.sources import fold_layer, spread_layer
from solvers.problems.bar.method.nodes import EMPTY, GHOSTS, stencil_of
from solvers.problems.bar.method.remedies import MOST_GRADIENT, PASSES
from solvers.scene.causes import CAUSES

COARSE_GRID = list(CAUSES).index("coarse_grid")  # its lane
SCRATCH = 3  # layer of ``cause_errors``, behind those of x, v and F


@ti.func
def in_step(bar: ti.template(), step, now, on: ti.template()):
    """After the remedies' own turn between nodes and particles, of which it takes the nodes' displacement."""
    if step % bar.remedy_interval == 0:
        if ti.static(on.filtered):
            filter_null_space(bar, now, on)
        if ti.static(on.coupled):
            couple_deformation(bar, now, on)


@ti.func
def after_step(bar: ti.template()):
    """Every step's end: take the mean velocity out."""
    P = bar.particles
    mean = ti.Vector([0.0, 0.0, 0.0, 0.0])
    for p in range(P):
        mean += bar.cause_errors[P + p]
    mean = mean / P
    for p in range(P):
        bar.cause_errors[P + p] = bar.cause_errors[P + p] - mean


@ti.func
def filter_null_space(bar: ti.template(), now, on: ti.template()):
    """e_v -= rate (I - S S^+)^2 (e_v + v), v the reference's for the coarse grid."""
    P = bar.particles
    for p in range(P):
        m = motion(bar, p, now, on)
        bar.cause_errors[SCRATCH * P + p] = bar.cause_errors[P + p] + ti.Vector([0.0, m[0] - bar.dt * m[1], 0.0, 0.0])
    for _ in range(2):
        scratch_to_nodes(bar)
        leave_unseen(bar)
    for p in range(P):
        unseen = bar.cause_errors[SCRATCH * P + p]
        if bar.taken_away == COARSE_GRID:  # it has no errors then: this is the reference's part
            bar.velocity[p] += bar.remedy_rate * unseen[COARSE_GRID]
            unseen[COARSE_GRID] = 0.0
        bar.cause_errors[P + p] = bar.cause_errors[P + p] - bar.remedy_rate * unseen


@ti.func
def couple_deformation(bar: ti.template(), now, on: ti.template()):
    """e_F += rate (G_c/((1 - G)(1 - G0)) - e_F), G the run's gradient, G0 = G - sum G_c the reference's; the coarse
    grid has rate (1/(1 - G0) - F0) too."""
    P, M = bar.particles, bar.cells + GHOSTS
    for i in range(M):
        bar.budget_nodes[STRESS * M + i] = ti.Vector([0.0, 0.0, 0.0, 0.0])
    for p in range(P):
        bar.cause_errors[SCRATCH * P + p] = bar.cause_errors[p]
    for _ in range(PASSES):
        scratch_to_nodes(bar)
        for i in range(M):
            bar.budget_nodes[STRESS * M + i] += bar.budget_nodes[PIECES * M + i]
        leave_unseen(bar)
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
            change[COARSE_GRID] += 1 / (1 - G0) - slopes(bar, p, now, on)[0]
            if bar.taken_away == COARSE_GRID:
                bar.deformation_gradient[p] -= bar.remedy_rate * change[COARSE_GRID]
                change[COARSE_GRID] = 0.0
            bar.cause_errors[2 * P + p] = stretch + bar.remedy_rate * change


@ti.func
def scratch_to_nodes(bar: ti.template()):
    """S^+ of the scratch, into the layer that pieces had."""
    P, M = bar.particles, bar.cells + GHOSTS
    for i in range(M):
        bar.budget_nodes[PIECES * M + i] = ti.Vector([0.0, 0.0, 0.0, 0.0])
    for p in range(P):
        S, _ = stencil_of(bar, p)
        i = bar.first_node[p]
        for k in ti.static(range(3)):
            bar.budget_nodes[PIECES * M + i + k] += S[k] * bar.cause_errors[SCRATCH * P + p]
    fold_layer(bar, PIECES * M)
    for i in range(1, bar.cells + 1):
        weight = bar.node_sums[i][0]
        share = 1 / weight if weight > EMPTY else 0.0
        bar.budget_nodes[PIECES * M + i] = share * bar.budget_nodes[PIECES * M + i]
    spread_layer(bar, PIECES * M)


@ti.func
def leave_unseen(bar: ti.template()):
    """Take from the scratch what the nodes have of it."""
    P, M = bar.particles, bar.cells + GHOSTS
    for p in range(P):
        S, _ = stencil_of(bar, p)
        i, unseen = bar.first_node[p], bar.cause_errors[SCRATCH * P + p]
        for k in ti.static(range(3)):
            unseen = unseen - S[k] * bar.budget_nodes[PIECES * M + i + k]
        bar.cause_errors[SCRATCH * P + p] = unseen
