"""Symmetry planes at the lower, or at both, ends of x and y: nodes beyond them are mirror images."""

from typing import Any, NamedTuple

import taichi as ti

from solvers.problems.planar.scene import GHOSTS


class SymmetryPlanes(NamedTuple):
    """Those parts of ``solvers.problems.planar.parts.Traits`` that the planes decide."""

    first: int
    fold: Any
    pin: Any
    mirror: Any
    image: Any


def symmetry_planes(low: bool, high: bool) -> SymmetryPlanes:
    """With planes at the lower ends, and at the upper ends too where there are lower ones; or with no plane at all."""
    G = GHOSTS if low else 0

    @ti.func
    def fold(body: ti.template(), fold_pair: ti.template()):
        """Add what fell beyond a plane to its mirror image, the component across the plane with odd sign.

        Setting it to zero instead costs up to a factor 2.5 in accuracy. ``fold_pair(body, ghost, image, in_x, in_y)``
        adds a node's values, with these signs, to those of its image.
        """
        end = body.row - 1
        if ti.static(low):
            for j in range(body.active):
                for k in ti.static(range(G)):
                    fold_pair(body, j * body.row + k, j * body.row + 2 * G - k, -1.0, 1.0)
                    if ti.static(high):
                        fold_pair(body, j * body.row + end - k, j * body.row + end - 2 * G + k, -1.0, 1.0)
            for i in range(body.active):
                for k in ti.static(range(G)):
                    fold_pair(body, k * body.row + i, (2 * G - k) * body.row + i, 1.0, -1.0)
                    if ti.static(high):
                        fold_pair(body, (end - k) * body.row + i, (end - 2 * G + k) * body.row + i, 1.0, -1.0)

    @ti.func
    def pin(body: ti.template(), i, j, record):
        """The record of node (i, j) without the components that would move it across a plane."""
        pinned, last = record, body.row - 1 - G
        if ti.static(low):
            if i == G or (ti.static(high) and i == last):
                pinned[0], pinned[2] = 0.0, 0.0
            if j == G or (ti.static(high) and j == last):
                pinned[1], pinned[3] = 0.0, 0.0
        return pinned

    @ti.func
    def mirror(body: ti.template(), values: ti.template()):
        """Copy the nodes' values, two vectors each, to their images beyond the planes: odd in what points across."""
        end = body.row - 1
        if ti.static(low):
            for j in range(G, body.active):
                for k in ti.static(range(G)):
                    values[j * body.row + k] = ti.Vector([-1.0, 1.0, -1.0, 1.0]) * values[j * body.row + 2 * G - k]
                    if ti.static(high):
                        values[j * body.row + end - k] = \
                            ti.Vector([-1.0, 1.0, -1.0, 1.0]) * values[j * body.row + end - 2 * G + k]
            for i in range(body.active):
                for k in ti.static(range(G)):
                    values[k * body.row + i] = ti.Vector([1.0, -1.0, 1.0, -1.0]) * values[(2 * G - k) * body.row + i]
                    if ti.static(high):
                        values[(end - k) * body.row + i] = \
                            ti.Vector([1.0, -1.0, 1.0, -1.0]) * values[(end - 2 * G + k) * body.row + i]

    @ti.func
    def image(body: ti.template(), node):
        """The node that a ghost is the mirror image of; any other is its own."""
        own = node
        if ti.static(low):
            i, j, last = node % body.row, node // body.row, body.row - 1 - G
            i, j = ti.select(i < G, 2 * G - i, i), ti.select(j < G, 2 * G - j, j)
            if ti.static(high):
                i, j = ti.select(i > last, 2 * last - i, i), ti.select(j > last, 2 * last - j, j)
            own = j * body.row + i
        return own

    return SymmetryPlanes(G, fold, pin, mirror, image)
