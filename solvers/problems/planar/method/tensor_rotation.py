"""Rotation of vectors and tensors from an orbit's representative point to its particles."""

import taichi as ti


@ti.func
def rotate_vector(e, x, y):
    """Returns the vector (x, y) rotated by what turns the x axis to the unit vector e."""
    return ti.Vector([x * e[0] - y * e[1], x * e[1] + y * e[0]])


@ti.func
def rotate_tensor(e, xx, xy, yy):
    """Returns a symmetric tensor, as xx, xy, yy, rotated by what turns the x axis to the unit vector e."""
    c, s = e[0], e[1]
    mean, half = 0.5 * (xx + yy), 0.5 * (xx - yy)
    along, across = half * (c * c - s * s) - 2 * xy * c * s, 2 * half * c * s + xy * (c * c - s * s)
    return ti.Vector([mean + along, across, mean - along])
