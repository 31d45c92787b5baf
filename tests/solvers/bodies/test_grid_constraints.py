"""The grid of a body's run: which nodes are held, and which are mirrored."""

import dataclasses

import numpy as np
import pytest

from solvers.bodies.body_file import library_text, parse_body
from solvers.bodies.grid_constraints import GHOSTS, constrained_grid
from tests.solvers.bodies import exact_bodies

BEAM = parse_body(library_text("cantilever"))


def node_places(grid, spacing):
    """The places (N, 2) in m of all nodes, by entry."""
    entry = np.arange(grid.row**2)
    return grid.corner + spacing * np.stack([entry % grid.row, entry // grid.row], axis=1)


@pytest.mark.parametrize("at", [0.0, 4.0])
def test_nodes_on_a_clamped_line_and_behind_it_are_held(at):
    """All of them, and no others; the clamped side is the beam's left or right one."""
    sides = ("free", "free", "free", "clamped") if at == 0 else ("free", "clamped", "free", "free")
    body = dataclasses.replace(BEAM, patches=(dataclasses.replace(BEAM.patches[0], sides=sides),))
    grid = constrained_grid(body)
    x = node_places(grid, body.spacing)[:, 0]
    behind = x < 1e-9 if at == 0 else x > at - 1e-9
    assert (grid.hold == np.where(behind, 0, 1)[:, None]).all() and 0 < behind.sum() < len(x)


def test_nodes_behind_rollers_mirror_those_inside():
    """Of a unit square: across x = 0, y = 0, x = 1 and y = 1, and only the component across changes its sign."""
    body = exact_bodies.square()
    grid = constrained_grid(body)
    X = node_places(grid, body.spacing)
    ghost, image, in_x = grid.mirrors.T
    assert len(grid.mirrors) == 4 * GHOSTS * grid.row
    for ghosts, images, axis in ((X[ghost[in_x == 1]], X[image[in_x == 1]], 0),
                                 (X[ghost[in_x == 0]], X[image[in_x == 0]], 1)):
        line = np.round(ghosts[:, axis])  # the nearer of 0 and 1
        assert images[:, axis] == pytest.approx(2 * line - ghosts[:, axis])
        assert images[:, 1 - axis] == pytest.approx(ghosts[:, 1 - axis])
    for axis in (0, 1):
        assert (grid.hold[:, axis] == 0).sum() == 2 * grid.row
        assert set(np.round(X[grid.hold[:, axis] == 0, axis], 12)) == {0.0, 1.0}
