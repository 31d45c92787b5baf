"""Contradictions within a bar, seen without its exact solution (see ``solvers.solver.soundness``).

Neighbours X_p and X_q = X_p + dX should stand dX (F_p + F_q)/2 from each other. What they miss, r_p, is looked at by
itself (``neighbour_gap``) and summed up along the bar (``displacement_mismatch``): (x - X) less the integral of F - 1.
Sums with sin(2 pi X) and sin(4 pi X) are held against ``solvers.problems.bar.exact_solution.displacement_moments``.
"""

import taichi as ti

from solvers.solver.samples import column_index


@ti.func
def record_contradictions(bar: ti.template(), row, drift):
    """Writes to a row of ``bar.samples`` the contradictions in m (the gaps between neighbours, the drift of the body
    beyond the expected ``drift``, the mismatch of displacement and deformation) and sums of displacements."""
    P, dX = bar.particles, bar.volume  # a particle's volume at rest is its length
    squares, worst, place = 0.0, -1.0, 0
    moved = 0.0  # sum of x - X
    motion, first, second = 0.0, 0.0, 0.0  # sums of u^2, u sin(2 pi X), u sin(4 pi X)
    gap, gaps, gap_squares = bar.position[0] - bar.material_position[0] - drift, 0.0, 0.0
    for p in range(P):
        q = ti.select(p + 1 < P, p + 1, 0)  # the bar is periodic: so is x - X
        here = bar.position[p] - bar.material_position[p]
        there = bar.position[q] - bar.material_position[q]
        miss = there - here - dX * (0.5 * (bar.deformation_gradient[p] + bar.deformation_gradient[q]) - 1)
        squares += miss * miss
        if abs(miss) > worst:
            worst, place = abs(miss), p
        moved += here
        u, angle = here - drift, 2 * ti.math.pi * bar.material_position[p]
        motion += u * u
        first += u * ti.sin(angle)
        second += u * ti.sin(2 * angle)
        gaps += gap
        gap_squares += gap * gap
        gap += miss
    out = ti.static(bar.samples)
    mean = gaps / P
    out[row, ti.static(column_index("neighbour_gap"))] = ti.sqrt(squares / P)
    out[row, ti.static(column_index("mean_drift"))] = abs(moved / P - drift)
    out[row, ti.static(column_index("displacement_mismatch"))] = ti.sqrt(ti.max(0.0, gap_squares / P - mean * mean))
    out[row, ti.static(column_index("place"))] = place
    out[row, ti.static(column_index("motion_square"))] = motion
    out[row, ti.static(column_index("motion_0"))] = first
    out[row, ti.static(column_index("motion_1"))] = second
