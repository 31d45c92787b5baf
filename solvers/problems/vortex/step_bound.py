"""The bound on the vortex's time step along the motion ahead (see ``solvers.scene.step_bound``).

For the circles: the stiffness between two nodes with gradients g and h of their weights is V0 [mu (g . b h) I + lambda
g h^T + mu h g^T], b = F F^T, J = 1. Its norm is at most that of |g| |h| in the metric mu b + (lambda + mu) I. A sheared
material is stiff along one direction alone: taken as large along all, as the ring does with its stretches, the bound
would be up to four times too strict here. In material form, for frozen weights, the metric is mu I + (lambda + mu)
C^-1.

Lattice, grid and motion look the same after a quarter of a turn: a quarter of the particles is enough, if a node has
one number with the three where it then comes to lie, and velocities are turned with it. A scene is a ``VortexScene``,
whose file imports this one.
"""

from typing import Any

import numpy as np

from solvers.problems.planar.layout import particle_layout
from solvers.problems.planar.step_bound import Body, Images, body_bound
from solvers.problems.vortex import exact
from solvers.scene.step_bound import StepBound

#: What becomes of v_x and v_y by quarters of a turn: a sign.
SIGNS = np.array([[1.0, -1.0, -1.0, 1.0], [1.0, 1.0, -1.0, -1.0]])


def critical_time_step(scene: Any) -> StepBound:
    """The longest step along the motion from rest to the largest turn; the other way is its mirror."""
    return body_bound(scene, body_of)


def body_of(scene: Any) -> Body:
    """What of the vortex its bound is made of: a quarter of it."""
    layout, (lam, mu) = particle_layout(scene), exact.lame(scene)
    kept = (layout.position > 0).all(axis=1)  # at rest in the first quadrant; none is on an axis
    X, volume = layout.position[kept], layout.volume[kept]
    middle = 0.5 * (scene.cells % 2) * scene.spacing  # nodes are numbered from there, or from half a cell beside it

    def deformed(part: float) -> tuple[np.ndarray, np.ndarray]:
        t = 0.25 * scene.period * part
        x = X if scene.frozen else exact.position(scene, X, t)
        return x + middle, exact.deformation_gradient(scene, X, t)

    def stiff(F: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        metric = mu * np.eye(2) + (lam + mu) * np.linalg.inv(F.transpose(0, 2, 1) @ F) if scene.frozen \
            else mu * F @ F.transpose(0, 2, 1) + (lam + mu) * np.eye(2)
        return volume, metric.reshape(-1, 4)[:, [0, 1, 3]]

    F = deformed(1.0)[1]
    stretch = float(np.sqrt(np.linalg.eigvalsh(F @ F.transpose(0, 2, 1)).max()))
    return Body(volume, layout.edges[kept], deformed, (lam, mu), 0.25 * scene.period, stretch,
                lambda i, j: images_in_a_quarter(i, j, scene.cells), lambda number: (np.zeros(len(number), bool),) * 2,
                stiff)


def images_in_a_quarter(i: np.ndarray, j: np.ndarray, cells: int) -> Images:
    """The node that (i, j) falls on by quarters of a turn: the one with i > 0 and j >= 0, both counted in halves of a
    cell from the middle of the grid, which is the middle of a cell where the number of cells is odd."""
    a, b = 2 * i - cells % 2, 2 * j - cells % 2
    turns = np.select([(a > 0) & (b >= 0), (a <= 0) & (b > 0), (a < 0) & (b <= 0)], [0, 1, 2], 3)
    crossed = turns % 2 == 1
    number = np.abs(np.where(crossed, b, a)) + 4 * cells * np.abs(np.where(crossed, a, b))
    return Images(number, SIGNS[0][turns], SIGNS[1][turns], crossed)
