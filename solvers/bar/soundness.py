"""Contradictions within a bar, seen without its exact solution (see ``solvers.soundness``), and the margin of its step.

Neighbours X_p and X_q = X_p + dX should stand dX (F_p + F_q)/2 from each other. What they miss, r_p, is looked at by
itself (apart) and summed up along the bar (torn): (x - X) less the integral of F - 1.
"""

import taichi as ti

from solvers.bar.nodes import EMPTY, fold, stencil_of
from solvers.samples import column


@ti.func
def look(bar: ti.template(), row):
    """Write how far neighbours are apart, the body is adrift and its displacement torn from its deformation, in m."""
    P, dX = bar.particles, bar.volume  # a particle's volume at rest is its length
    squares, worst, place = 0.0, -1.0, 0
    moved = 0.0  # sum of x - X
    gap, gaps, gap_squares = bar.position[0] - bar.material_position[0], 0.0, 0.0
    for p in range(P):
        q = ti.select(p + 1 < P, p + 1, 0)  # the bar is periodic: so is x - X
        here = bar.position[p] - bar.material_position[p]
        there = bar.position[q] - bar.material_position[q]
        miss = there - here - dX * (0.5 * (bar.deformation_gradient[p] + bar.deformation_gradient[q]) - 1)
        squares += miss * miss
        if abs(miss) > worst:
            worst, place = abs(miss), p
        moved += here
        gaps += gap
        gap_squares += gap * gap
        gap += miss
    out = ti.static(bar.samples)
    mean = gaps / P
    out[row, ti.static(column("apart"))] = ti.sqrt(squares / P)
    out[row, ti.static(column("adrift"))] = abs(moved) / P
    out[row, ti.static(column("torn"))] = ti.sqrt(ti.max(0.0, gap_squares / P - mean * mean))
    out[row, ti.static(column("place"))] = place


@ti.func
def step_margin(bar: ti.template(), row):
    """Write dt over the bound of ``solvers.step_bound``, from the stencils and masses of the last step."""
    for i in range(bar.node_stiffness.shape[0]):
        bar.node_stiffness[i] = 0.0
    for p in range(bar.particles):
        _, dS = stencil_of(bar, p)
        i = bar.first_node[p]
        scaled = ti.Vector([0.0, 0.0, 0.0])  # |dS_i|/sqrt(m_i)
        for k in ti.static(range(3)):
            weight = bar.node_sums[i + k][0]  # the sum of S; images hold what fell on them, so look at the node
            node = i + k
            if node < 1:
                weight = bar.node_sums[bar.cells][0]
            if node > bar.cells:
                weight = bar.node_sums[node - bar.cells][0]
            if weight > EMPTY:
                scaled[k] = abs(dS[k]) / ti.sqrt(weight * bar.density * bar.volume)
        F = bar.deformation_gradient[p]
        stiffness = bar.modulus * F * F * bar.volume * scaled.sum()
        for k in ti.static(range(3)):
            bar.node_stiffness[i + k] += stiffness * scaled[k]
    fold(bar.node_stiffness, bar.cells)
    largest = 0.0
    for i in range(1, bar.cells + 1):
        largest = ti.max(largest, bar.node_stiffness[i])
    if largest > 0:
        bar.samples[row, ti.static(column("margin"))] = 0.5 * bar.dt * ti.sqrt(largest)
