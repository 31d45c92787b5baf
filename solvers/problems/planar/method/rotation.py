"""Vectors and tensors of an orbit's point, turned to the particle that it stands for."""

import taichi as ti


@ti.func
def rotate_vector(e, x, y):
    """A vector (x, y) where the x axis has become e."""
    return ti.Vector([x * e[0] - y * e[1], x * e[1] + y * e[0]])


@ti.func
def rotate_tensor(e, xx, xy, yy):
    """A symmetric tensor where the x axis has become e, as xx, xy, yy."""
    c, s = e[0], e[1]
    mean, half = 0.5 * (xx + yy), 0.5 * (xx - yy)
    along, across = half * (c * c - s * s) - 2 * xy * c * s, 2 * half * c * s + xy * (c * c - s * s)
    return ti.Vector([mean + along, across, mean - along])
