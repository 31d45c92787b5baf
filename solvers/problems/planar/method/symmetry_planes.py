"""Symmetry planes at the lower, or at both, ends of x and y: nodes beyond them are mirror images."""

from typing import Any

import taichi as ti

from solvers.problems.planar.scene import GHOSTS


def make_symmetry_plane_kernels(low: bool, high: bool) -> dict[str, Any]:
    """Returns the members of ``solvers.problems.planar.problem_kernel_functions.ProblemStepFunctions``, by name, that
    depend on planes: at the lower ends of x and y if ``low``, and then at the upper ends if ``high``."""
    G = GHOSTS if low else 0
    ghosts = tuple((side, k) for k in range(G) for side in ((0, 1) if high else (0,)))  # the lower end, and the upper

    @ti.func
    def row_from_end(body: ti.template(), side: ti.template(), k):
        """Returns the index of the k-th row or column from the lower (``side`` = 0) or upper end."""
        return k if ti.static(side == 0) else body.row - 1 - k

    @ti.func
    def fold(body: ti.template(), fold_pair: ti.template()):
        """Adds values of nodes beyond a plane to their mirror images, the component across the plane with odd sign:
        setting that to zero instead costs up to a factor 2.5 in accuracy. ``fold_pair(body, ghost, image, in_x, in_y)``
        adds one node's, with these signs, to its image's."""
        if ti.static(low):
            for j in range(body.active):
                for side, k in ti.static(ghosts):
                    ghost, image = row_from_end(body, side, k), row_from_end(body, side, 2 * G - k)
                    fold_pair(body, j * body.row + ghost, j * body.row + image, -1.0, 1.0)
            for i in range(body.active):
                for side, k in ti.static(ghosts):
                    ghost, image = row_from_end(body, side, k), row_from_end(body, side, 2 * G - k)
                    fold_pair(body, ghost * body.row + i, image * body.row + i, 1.0, -1.0)

    @ti.func
    def pin(body: ti.template(), i, j, record):
        """Returns node (i, j)'s ``record`` (two vectors) without the components that would move it across a plane."""
        pinned, last = record, body.row - 1 - G
        if ti.static(low):
            if i == G or (ti.static(high) and i == last):
                pinned[0], pinned[2] = 0.0, 0.0
            if j == G or (ti.static(high) and j == last):
                pinned[1], pinned[3] = 0.0, 0.0
        return pinned

    @ti.func
    def mirror(body: ti.template(), values: ti.template()):
        """Copies nodal ``values``, two vectors each, to their images beyond planes, odd in the component across."""
        if ti.static(low):
            for j in range(G, body.active):
                for side, k in ti.static(ghosts):
                    ghost, image = row_from_end(body, side, k), row_from_end(body, side, 2 * G - k)
                    values[j * body.row + ghost] = ti.Vector([-1.0, 1.0, -1.0, 1.0]) * values[j * body.row + image]
            for i in range(body.active):
                for side, k in ti.static(ghosts):
                    ghost, image = row_from_end(body, side, k), row_from_end(body, side, 2 * G - k)
                    values[ghost * body.row + i] = ti.Vector([1.0, -1.0, 1.0, -1.0]) * values[image * body.row + i]

    @ti.func
    def image(body: ti.template(), node):
        """Returns the number of the node that ``node``, beyond a plane, is the mirror image of; or ``node`` itself."""
        own = node
        if ti.static(low):
            i, j, last = node % body.row, node // body.row, body.row - 1 - G
            i, j = ti.select(i < G, 2 * G - i, i), ti.select(j < G, 2 * G - j, j)
            if ti.static(high):
                i, j = ti.select(i > last, 2 * last - i, i), ti.select(j > last, 2 * last - j, j)
            own = j * body.row + i
        return own

    return {"first": G, "fold": fold, "pin": pin, "mirror": mirror, "image": image}
