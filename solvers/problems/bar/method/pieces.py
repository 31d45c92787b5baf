"""The bar cut into pieces, one a particle, that leave no gap: what a particle would stand for without being counted
whole in the cell of its centre.

Piece p lies between the corners p and p + 1, a corner half way between two neighbours, x(X) taken as a cubic through
four: c_p = (9 (x_{p-1} + x_p) - x_{p-2} - x_{p+1})/16. With the method's base function B (the hat, or the quadratic
B-spline) the force of pieces at a node is exact for a stress that is constant in each of them,

    f_i = -sum_p P_p (B_i(c_{p+1}) - B_i(c_p)) = sum over corners of B_i(c_p) (P_p - P_{p-1}),

and so vanishes for a constant stress, wherever the particles are.

The budget of errors takes from it what is called a crossing. As a remedy it is the method: the forces of pieces by
their own stress, and for the velocity gradient the mean over the piece,

    L_p = sum_i v_i (B_i(c_{p+1}) - B_i(c_p))/(c_{p+1} - c_p),

the transpose of that force, so that the work of the nodes is what the pieces store as far as their length is F V0.
Mass, momentum and the motion of particles keep the method's weights. (F += dt (c_{p+1} - c_p) L_p/V0 stores it to
the last digit and is not better: over 100 periods both lose the same, and F parts from x sooner.)
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


@ti.func
def corners_to_nodes(bar: ti.template(), on: ti.template()):
    """Find the corners and their base functions, and let the pieces' stress pull at the nodes."""
    P = bar.particles
    before_last, last, this = place(bar, -2, on), place(bar, -1, on), place(bar, 0, on)
    stress_before = bar.modulus * (bar.deformation_gradient[P - 1] - bar.unstretched)
    for p in range(P):
        after = place(bar, p + 1, on)
        stress = bar.modulus * (bar.deformation_gradient[p] - bar.unstretched)
        x = corner(before_last, last, this, after)
        i, B = corner_stencil(bar, x, on)
        bar.corner_node[p] = i
        bar.corner_weights[p] = ti.Vector([B[0], B[1], B[2], x])
        pull = ti.Vector([0.0, 0.0, stress - stress_before, 0.0])
        for k in ti.static(range(corner_nodes(on))):
            bar.node_sums[i + k] += B[k] * pull
        before_last, last, this, stress_before = last, this, after, stress


@ti.func
def gather_lengths(bar: ti.template(), on: ti.template()):
    """Nodal sums of B_i(c_p) (x_p - x_{p-1}): the length that linearity preservation has of pieces, in the place of
    sum D r; the force of a constant stress, sum D, is 0."""
    last = place(bar, -1, on)
    for p in range(bar.particles):
        this = place(bar, p, on)
        i, B = bar.corner_node[p], bar.corner_weights[p]
        for k in ti.static(range(corner_nodes(on))):
            bar.node_moments[i + k] += ti.Vector([0.0, B[k] * (this - last), 0.0, 0.0])
        last = this


@ti.func
def at_corner(bar: ti.template(), values: ti.template(), first, p, on: ti.template()):
    """The nodes' ``values``, vectors of which the layer begins at ``first``, at the left corner of piece p; behind the
    last piece a period begins again."""
    turned = ti.select(p < bar.particles, p, 0)
    i, B = first + bar.corner_node[turned], bar.corner_weights[turned]
    seen = B[0] * values[i]
    for k in ti.static(range(1, corner_nodes(on))):
        seen += B[k] * values[i + k]
    return seen


@ti.func
def stretch_pieces(bar: ti.template(), on: ti.template()):
    """F <- (1 + dt L) F of every piece."""
    left = at_corner(bar, bar.node_motion, 0, 0, on)[0]
    for p in range(bar.particles):
        right = at_corner(bar, bar.node_motion, 0, p + 1, on)[0]
        bar.deformation_gradient[p] *= 1 + bar.dt * (right - left) / piece_length(bar, p)
        left = right


@ti.func
def piece_length(bar: ti.template(), p):
    """c_{p+1} - c_p."""
    end = bar.corner_weights[0][3] + 1
    if p + 1 < bar.particles:
        end = bar.corner_weights[p + 1][3]
    return end - bar.corner_weights[p][3]
