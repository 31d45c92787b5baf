"""The bound on the vortex's time step along the motion ahead (see ``solvers.scene.step_bound``).

For P = mu (F - F^-T) + lambda ln J F^-T, J = 1, the stiffness between two nodes with gradients g and h of their weights
is V0 [mu (g . b h) I + lambda g h^T + mu h g^T], b = F F^T. Its norm is at most that of |g| |h| in the metric
mu b + (lambda + mu) I. A sheared material is stiff along one direction alone: taken as large along all, as bar and ring
do with their stretches, the bound would be up to four times too strict here. In material form, for frozen weights, the
metric is mu I + (lambda + mu) C^-1. Lattice, grid and motion look the same after a quarter of a turn: a quarter of the
particles is enough, if a node has one number with the three where it then comes to lie. A scene is a ``VortexScene``,
whose file imports this one.
"""

from typing import Any

import numpy as np

from solvers.problems.planar.layout import particle_layout
from solvers.problems.planar.step_bound import body_bound, coarsened
from solvers.problems.vortex import exact
from solvers.scene.step_bound import INSTANTS


def critical_time_step(scene: Any) -> float:
    """The smallest bound, in seconds, over the motion from rest to the largest turn; the other way is its mirror."""
    fine, scene = scene, coarsened(scene)
    layout, instants = particle_layout(scene), np.linspace(0, 0.25 * scene.period, INSTANTS)
    kept = a_quarter(layout.position)
    X, volume, edges = layout.position[kept], layout.volume[kept], layout.edges[kept]
    return min(_at(scene, X, volume, edges, t) for t in instants) * fine.spacing / scene.spacing


def _at(scene: Any, X: np.ndarray, volume: np.ndarray, edges: np.ndarray, t: float) -> float:
    """The bound at the time t of the exact motion, from the particles of a quarter."""
    lam, mu = exact.lame(scene)
    F = exact.deformation_gradient(scene, X, t)
    if scene.frozen:
        x, metric = X, mu * np.eye(2) + (lam + mu) * np.linalg.inv(F.transpose(0, 2, 1) @ F)
        F = np.tile(np.eye(2), (len(X), 1, 1))
    else:
        x, metric = exact.position(scene, X, t), mu * F @ F.transpose(0, 2, 1) + (lam + mu) * np.eye(2)
    metric = metric.reshape(-1, 4)[:, [0, 1, 3]]
    x = x + 0.5 * (scene.cells % 2) * scene.spacing  # nodes are numbered from the middle, or from half a cell beside it

    def number(i: np.ndarray, j: np.ndarray) -> np.ndarray:
        return image_in_a_quarter(i, j, scene.cells)

    return body_bound(scene, x, F, edges, volume, volume, number, metric)


def a_quarter(X: np.ndarray) -> np.ndarray:
    """Which of the particles (P, 2) are at rest in the first quadrant; none is on an axis."""
    return (X[:, 0] > 0) & (X[:, 1] > 0)


def image_in_a_quarter(i: np.ndarray, j: np.ndarray, cells: int) -> np.ndarray:
    """The number of the node that (i, j) falls on by quarters of a turn: the one with i > 0 and j >= 0, both counted in
    halves of a cell from the middle of the grid, which is the middle of a cell where the number of cells is odd."""
    a, b = 2 * i - cells % 2, 2 * j - cells % 2
    crossed = (a * b < 0) | (a == 0)
    return np.abs(np.where(crossed, b, a)) + 4 * cells * np.abs(np.where(crossed, a, b))
