"""The bar cut into pieces without gaps, one per particle, which are not counted whole in the cell of their centre.

Piece p lies between the corners p and p + 1, a corner half way between two neighbours, x(X) taken as a cubic through
four: c_p = (9 (x_{p-1} + x_p) - x_{p-2} - x_{p+1})/16. With the method's base function B (the hat, or the quadratic
B-spline) the force of pieces at a node is exact for a stress that is constant in each of them,

    f_i = -sum_p P_p (B_i(c_{p+1}) - B_i(c_p)) = sum over corners of B_i(c_p) (P_p - P_{p-1}),

and so vanishes for a constant stress, wherever the particles are.

The error budget defines crossings by it. As a remedy it replaces the method: the forces of pieces by
their own stress, and for the velocity gradient the mean over the piece,

    L_p = sum_i v_i (B_i(c_{p+1}) - B_i(c_p))/(c_{p+1} - c_p),

the transpose of that force, so that the work of the nodes is what the pieces store as far as their length is F V0.
Mass, momentum and the motion of particles keep the method's weights. (F += dt (c_{p+1} - c_p) L_p/V0 stores it to
the last digit and is not better: over 100 periods both lose the same, and F deviates from x sooner.)
"""

import taichi as ti

from solvers.kernels.scalar_hoisting import mark_untranslated_by_taichi
from solvers.kernels.shape_functions import bspline, hat


@ti.func
def mapping_position(bar: ti.template(), p, on: ti.template()):
    """Returns where weights of particle p are evaluated, in m: x, or X if frozen. ``on``: compile-time options."""
    x = 0.0
    if ti.static(on.frozen):
        x = bar.material_position[p]
    else:
        x = bar.position[p]
    return x


@ti.func
def periodically_extended_position(bar: ti.template(), p, on: ti.template()):
    """Returns the position in m at which weights are evaluated of particle p; for p = -2, -1, P and P + 1, beyond the
    ends, of that particle's image one period away. ``on``: compile-time options."""
    P = bar.particles
    turn = ti.select(p < 0, -1, ti.select(p < P, 0, 1))
    return mapping_position(bar, p - turn * P, on) + turn


@ti.func
def corner_between_particles(before_last, last, this, after):
    """Returns the corner between the particles ``last`` and ``this`` from the positions of four neighbours, in m."""
    return (9 * (last + this) - before_last - after) / 16


@ti.func
def corner_stencil(bar: ti.template(), x, on: ti.template()):
    """Returns the base functions at a corner x in m: the first node's index in the padded arrays, and three weights, of
    which :func:`nodes_per_corner` matter; the third is 0 for hats. ``on``: compile-time options."""
    place = (x - ti.floor(x)) * bar.cells_per_length
    first, left, right, _, _ = hat(place)
    if ti.static(on.method == "bspline"):
        first, left, right, _, _ = bspline(place)
    B = ti.Vector([left, 1 - left - right, right])
    return ti.cast(ti.min(ti.max(first, -1.0), bar.cells), ti.i32) + 1, B  # within the arrays, whatever x is


@mark_untranslated_by_taichi
def nodes_per_corner(on) -> int:
    """Returns how many base functions a corner meets: 3 for B-splines, 2 for hats. ``on``: compile-time options."""
    return 3 if on.method == "bspline" else 2


@ti.func
def store_piece_corners(bar: ti.template(), on: ti.template()):
    """Stores the left corner of every piece with its base functions in ``bar.corners``. ``on``: compile-time options.

    Those near the ends have neighbours a period away and come first, so that the loop over all others has no choices in
    it and several go at once: the remedy then costs a third of what it did.
    """
    P = bar.particles
    for k in ti.static(range(3)):
        p = ti.select(k < 2, k, P - 1)
        around = ti.Vector([periodically_extended_position(bar, p + j, on) for j in ti.static(range(-2, 2))])
        store_corner_stencil(bar, p, corner_between_particles(around[0], around[1], around[2], around[3]), on)
    for p in range(2, P - 1):
        corner = corner_between_particles(mapping_position(bar, p - 2, on), mapping_position(bar, p - 1, on),
                                          mapping_position(bar, p, on), mapping_position(bar, p + 1, on))
        store_corner_stencil(bar, p, corner, on)


@ti.func
def store_corner_stencil(bar: ti.template(), p, x, on: ti.template()):
    """Stores x in m as piece p's left corner, with base functions, in ``bar.corners``. ``on``: compile-time options."""
    i, B = corner_stencil(bar, x, on)
    bar.corners[p] = ti.Vector([B[0], B[1], i, x])


@ti.func
def stored_corner_stencil(bar: ti.template(), p):
    """Returns the stored left corner of piece p: first node, in the padded node arrays, three base functions, of which
    two are stored because they add up to one, and its position in m."""
    kept = bar.corners[p]
    return ti.cast(kept[2], ti.i32), ti.Vector([kept[0], kept[1], 1 - kept[0] - kept[1]]), kept[3]


@ti.func
def add_piece_forces_to_nodes(bar: ti.template(), on: ti.template()):
    """Adds the forces in N by the pieces' stress to ``bar.node_sums``, as third component. ``on``: kernel options."""
    before = bar.deformation_gradient[bar.particles - 1]
    for p in range(bar.particles):
        F = bar.deformation_gradient[p]
        i, B, _ = stored_corner_stencil(bar, p)
        for k in ti.static(range(nodes_per_corner(on))):
            bar.node_sums[i + k][2] += B[k] * (bar.modulus * (F - before))
        before = F


@ti.func
def sum_piece_lengths_at_nodes(bar: ti.template(), on: ti.template()):
    """Adds B_i(c_p) (x_p - x_{p-1}) in m to ``bar.node_moments``: linearity preservation's length of pieces, in place
    of sum D r; the force of a constant stress, sum D, is 0. ``on``: compile-time options."""
    last = periodically_extended_position(bar, -1, on)
    for p in range(bar.particles):
        this = periodically_extended_position(bar, p, on)
        i, B, _ = stored_corner_stencil(bar, p)
        for k in ti.static(range(nodes_per_corner(on))):
            bar.node_moments[i + k][1] += B[k] * (this - last)
        last = this


@ti.func
def interpolate_at_corner(bar: ti.template(), values: ti.template(), first, p, on: ti.template()):
    """Returns nodal ``values``, vectors whose layer begins at ``first``, interpolated at the left corner of piece p;
    the corner p = P is the first again. ``on``: compile-time options."""
    i, B, _ = stored_corner_stencil(bar, ti.select(p < bar.particles, p, 0))
    seen = B[0] * values[first + i]
    for k in ti.static(range(1, nodes_per_corner(on))):
        seen += B[k] * values[first + i + k]
    return seen


@ti.func
def update_piece_gradients(bar: ti.template(), on: ti.template()):
    """Sets F <- (1 + dt L) F for every piece, L its velocity gradient in 1/s, in ``bar.deformation_gradient``. ``on``:
    compile-time options."""
    left = interpolate_at_corner(bar, bar.node_motion, 0, 0, on)[0]
    for p in range(bar.particles):
        right = interpolate_at_corner(bar, bar.node_motion, 0, p + 1, on)[0]
        bar.deformation_gradient[p] *= 1 + bar.dt * (right - left) / piece_length(bar, p)
        left = right


@ti.func
def piece_length(bar: ti.template(), p):
    """Returns the length of piece p, c_{p+1} - c_p, in m."""
    end = bar.corners[0][3] + 1
    if p + 1 < bar.particles:
        end = bar.corners[p + 1][3]
    return end - bar.corners[p][3]
