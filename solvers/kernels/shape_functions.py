"""Shape functions in one dimension, as three-node stencils.

Each function returns the first of three neighbouring nodes, and for the two outer ones, left and right, the weights
and then the gradients in 1/cell. Positions and half widths are in cells (x/h). Weights sum to one and gradients to zero
to round-off, because the middle node takes what the outer two leave (:func:`complete_stencil`).

Sources: hat and GIMP, Bardenhagen & Kober (2004); quadratic B-spline, Steffen, Kirby & Berzins (2008).
"""

import taichi as ti


@ti.func
def complete_stencil(outer_left, outer_right, slope_left, slope_right):
    """Returns the weights and the gradients (vectors of 3 numbers) of a stencil's nodes from those of the outer two:
    partition of unity and its derivative fix the middle one."""
    return (ti.Vector([outer_left, 1 - outer_left - outer_right, outer_right]),
            ti.Vector([slope_left, -slope_left - slope_right, slope_right]))


@ti.func
def hat(position):
    """Returns the stencil (first node, outer weights, outer gradients in 1/cell) of the piecewise linear functions of
    the original MPM at a position in cells. The third node's weight is zero."""
    first = ti.floor(position)
    nothing = 0.0 * position
    return first, 1 - (position - first), nothing, nothing - 1, nothing


@ti.func
def gimp(position, half_width):
    """Returns the stencil (first node, outer weights, outer gradients in 1/cell) of the hat averaged over the domain
    [position - half_width, position + half_width], in cells.

    ``half_width`` is above 0 and at most 1/2, so that the domain meets at most two cells. With a constant half width
    the method is uGIMP, with one that follows F cpGIMP. The average of the hat (1 - s) over the part of the domain in
    the first cell and of (s - 1) over the part in the second gives the outer weights; the gradient is the difference of
    the hat at the domain's two ends over its length."""
    first = ti.floor(position - half_width)
    start = position - half_width - first  # left end of the domain, in [0, 1)
    end = start + 2 * half_width
    uncovered = ti.max(0.0, 1 - end)
    beyond = ti.max(0.0, end - 1)
    per_length = 0.5 / half_width
    rest = 1 - start
    return (first, 0.5 * per_length * (rest * rest - uncovered * uncovered), 0.5 * per_length * beyond * beyond,
            per_length * (uncovered - rest), per_length * beyond)


@ti.func
def bspline(position):
    """Returns the stencil (first node, outer weights, outer gradients in 1/cell), at a position in cells, of quadratic
    B-splines centred on the nodes: the GIMP functions of a domain one cell wide."""
    first = ti.floor(position - 0.5)
    s = position - first - 0.5  # in [0, 1)
    return first, 0.5 * (1 - s) * (1 - s), 0.5 * s * s, s - 1, s


@ti.func
def outer_weights(method: ti.template(), position, half_width):
    """Returns first node, left and right weight, and left and right gradient in 1/cell, of the outer nodes of a
    particle's stencil by a ``method``: "mpm", "ugimp", "cpgimp", "cpgimp-v" or "bspline". ``position`` and
    ``half_width``, in cells, may be vectors, with one entry per direction, for vector instructions."""
    first, left, right, slope_left, slope_right = hat(position)
    if ti.static(method in ("ugimp", "cpgimp", "cpgimp-v")):
        first, left, right, slope_left, slope_right = gimp(position, half_width)
    elif ti.static(method == "bspline"):
        first, left, right, slope_left, slope_right = bspline(position)
    return first, left, right, slope_left, slope_right
