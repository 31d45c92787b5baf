"""The grid of a body's run, and what its clamped and roller sides do to the nodes."""

from typing import NamedTuple

import numpy as np

from solvers.bodies.body import Body
from solvers.bodies.patch import CLAMPED

MARGIN, GHOSTS = 2, 2  # cells around the domain; rows of nodes behind a roller that particles reach


class HeldGrid(NamedTuple):
    """Grid of ``columns`` by ``lines`` nodes, entry line * ``row`` + column, with its lower left node at ``corner``
    (2,) in m. ``hold`` (N, 2) is 0 for components that are held. ``mirrors`` (M, 3) are a node behind a roller, its
    mirror image, and 1 or 0 as x or y changes its sign."""

    corner: np.ndarray
    columns: int
    lines: int
    row: int
    hold: np.ndarray
    mirrors: np.ndarray


def held_grid(body: Body) -> HeldGrid:
    """Returns the grid over a body's domain. Nodes on a clamped side's line and behind it are held; those behind a
    roller get the mirror image of the motion, whose component across is held on the line."""
    low, high = np.array(body.domain, float) * body.cells_per_metre
    first, last = np.floor(low + 1e-9) - MARGIN, np.ceil(high - 1e-9) + MARGIN + 1
    columns, lines = (int(one) + 1 for one in last - first)
    row = max(columns, lines)
    number = np.arange(row * row).reshape(row, row).T  # by column and line
    hold, mirrors = np.ones((row * row, 2)), []
    for line in body.held_lines:
        at = round(line.position * body.cells_per_metre - first[line.axis])
        across = number if line.axis == 0 else number.T
        if line.kind == CLAMPED:
            hold[across[:at + 1] if line.inside > 0 else across[at:]] = 0
            continue
        hold[across[at], line.axis] = 0
        for k in range(1, GHOSTS + 1):
            ghost, image = (across[at + sign * k * line.inside] for sign in (-1, 1))
            mirrors += [(a, b, 1 - line.axis) for a, b in zip(ghost, image, strict=True)]
    return HeldGrid(first * body.spacing, columns, lines, row, hold,
                    np.array(mirrors or np.zeros((0, 3)), np.int32).reshape(-1, 3))
