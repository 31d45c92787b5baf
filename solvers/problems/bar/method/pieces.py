"""The bar cut into pieces, one a particle, that leave no gap: what a particle would stand for without being counted
whole in the cell of its centre.

Piece p lies between the corners p and p + 1, a corner half way between two neighbours, x(X) taken as a cubic through
four: c_p = (9 (x_{p-1} + x_p) - x_{p-2} - x_{p+1})/16. With the method's base function B (the hat, or the quadratic
B-spline) the force of pieces at a node is exact for a stress that is constant in each of them,

    f_i = -sum_p P_p (B_i(c_{p+1}) - B_i(c_p)) = sum over corners of B_i(c_p) (P_p - P_{p-1}),

and so vanishes for a constant stress, wherever the particles are.
"""

import taichi as ti

from solvers.kernels.hoist import untranslated
from solvers.kernels.shapes import bspline, hat


@ti.func
def place(bar: ti.template(), p, on: ti.template()):
    """Where the weights see particle p, from one before the first to one behind the last, a period away."""
    P = bar.particles
    turn = ti.select(p < 0, -1, ti.select(p < P, 0, 1))
    x = 0.0
    if ti.static(on.frozen):
        x = bar.material_position[p - turn * P]
    else:
        x = bar.position[p - turn * P]
    return x + turn


@ti.func
def corner(before_last, last, this, after):
    """The corner between the particles ``last`` and ``this``, from the places of four neighbours."""
    return (9 * (last + this) - before_last - after) / 16


@ti.func
def corner_stencil(bar: ti.template(), x, on: ti.template()):
    """The base functions at a corner: first node, in the padded node arrays, and three weights; of hats the third is 0.

    ``corner_nodes`` says how many there are to look at.
    """
    place = (x - ti.floor(x)) * bar.cells_per_length
    first, left, right, _, _ = hat(place)
    if ti.static(on.method == "bspline"):
        first, left, right, _, _ = bspline(place)
    B = ti.Vector([left, 1 - left - right, right])
    return ti.cast(ti.min(ti.max(first, -1.0), bar.cells), ti.i32) + 1, B  # within the arrays, whatever x is


@untranslated
def corner_nodes(on) -> int:
    """How many nodes a corner meets."""
    return 3 if on.method == "bspline" else 2
