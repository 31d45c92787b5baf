"""A step in the plane taken apart: weights and their gradients, from the arrays that the step has left."""

import numpy as np

from solvers.problems.planar.layout import CORNERS
from solvers.problems.planar.state import WatchedBody
from solvers.scene.scene import Scene


def nodes_of(scene: Scene, a: WatchedBody) -> np.ndarray:
    """The nodes (P, M) of each particle, some perhaps several times."""
    row = a.row
    if scene.method == "cpdi":
        return (a.corner_nodes[:, :, None] + np.array([0, 1, row, row + 1])).reshape(len(a.corner_nodes), 16)
    return a.first_node[:, None] + (row * np.arange(3)[:, None] + np.arange(3)).ravel()


def weights_of(scene: Scene, a: WatchedBody, edges: np.ndarray, some: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """S (c, M) and its gradient (c, M, 2) of ``some`` particles (c,), whose half edges are in ``edges`` (P, 2, 2)."""
    return _corner_weights(a, edges, some) if scene.method == "cpdi" else _stencil_weights(a, some)


def _stencil_weights(a: WatchedBody, some: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    w = a.weights[some].reshape(-1, 4, 2)  # left, right and their slopes, each in x and y
    S = np.stack([w[:, 0], 1 - w[:, 0] - w[:, 1], w[:, 1]], axis=1)
    dS = np.stack([w[:, 2], -w[:, 2] - w[:, 3], w[:, 3]], axis=1)
    (x, y), (by_x, by_y) = np.moveaxis(S, 2, 0), np.moveaxis(dS, 2, 0)

    def product(along_y: np.ndarray, along_x: np.ndarray) -> np.ndarray:
        return np.einsum("pj,pi->pji", along_y, along_x).reshape(-1, 9)

    return product(y, x), np.stack([product(y, by_x), product(by_y, x)], axis=2)


def _corner_weights(a: WatchedBody, edges: np.ndarray, some: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """S = 1/4 sum N(corner); the gradient takes N at opposite corners with opposite signs."""
    x, y = a.weights[some, :4], a.weights[some, 4:]
    N = np.stack([(1 - x) * (1 - y), x * (1 - y), (1 - x) * y, x * y], axis=2)  # (c, corner, node)
    # A linear f has f(corner) = f(x) + c_1 f'r_1 + c_2 f'r_2, and so grad f = inverse of the edges, times sum c f.
    along = np.einsum("ce,pcn->pecn", np.array(CORNERS), N)
    slope = np.einsum("pde,pecn->pcnd", np.linalg.inv(2 * edges[some]), along)
    return 0.25 * N.reshape(-1, 16), slope.reshape(-1, 16, 2)
