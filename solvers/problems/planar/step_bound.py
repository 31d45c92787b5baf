"""Weights of the particles of a plane body at their nodes, in numpy, for the bound on its step before it has run."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from solvers.problems.planar.layout import CORNERS, MOST_HALF_WIDTH, box_stretch
from solvers.problems.planar.scene import PlanarScene
from solvers.scene.scene import Scene
from solvers.scene.step_bound import bound, stencil

Links = tuple[np.ndarray, np.ndarray, np.ndarray]  # nodes, weights and sizes of gradients (P, M)
#: From nodes' places in x and y, in cells, to their numbers, 0 or more; images of each other may have the same.
Number = Callable[[np.ndarray, np.ndarray], np.ndarray]
MOST_PARTICLES = 10_000  # that are looked at


def coarsened(scene: PlanarScene) -> PlanarScene:
    """The scene on so few cells that its particles are quickly looked at: a finer one meets the grid in the same ways,
    and its bound is as much shorter as its cells are."""
    while scene.particles > MOST_PARTICLES and scene.cells > scene.FEWEST_CELLS:
        scene = replace(scene, cells=max(scene.cells // 2, scene.FEWEST_CELLS))
    return scene


def body_bound(scene: Scene, x: np.ndarray, F: np.ndarray, edges: np.ndarray, volume: np.ndarray, stiffness: np.ndarray,
               number: Number, metric: np.ndarray | None = None) -> float:
    """The bound in seconds with particles at ``x`` (P, 2), whose deformation gradients are ``F`` (P, 2, 2) and whose
    domains have ``edges`` (P, 4) and a ``volume`` (P,) at rest, and k V = ``stiffness`` (P,)."""
    nodes, S, gradients = corners(scene, x, F.reshape(-1, 4), edges, number, metric) if scene.method == "cpdi" \
        else boxes(scene, x, box_stretch(scene.method, F), number, metric)
    mass = np.bincount(nodes.ravel(), (scene.density * volume[:, None] * S).ravel())
    return bound(nodes, gradients, stiffness, mass)


def boxes(scene: Scene, x: np.ndarray, stretch: np.ndarray, number: Number,
          metric: np.ndarray | None = None) -> Links:
    """Nodes, weights and sizes of gradients (P, 9) of hat and GIMP functions of particles at ``x`` (P, 2), whose boxes
    are ``stretch`` (P, 2) times as wide as at rest, or not where the method is uGIMP. Sizes are those of ``metric``."""
    axes = []
    for axis in range(2):
        half_width = np.full(len(x), 0.5 / scene.ppc)
        if scene.method not in ("mpm", "ugimp"):
            half_width = np.clip(half_width * stretch[:, axis], 1e-6, MOST_HALF_WIDTH)
        first, S, dS = stencil(scene.method, x[:, axis] / scene.spacing, half_width)
        axes.append((first[:, None] + np.arange(3), S, dS / scene.spacing))
    (i, S, dS), (j, R, dR) = axes
    pairs = [a[:, :, None] * b[:, None, :] for a, b in ((S, R), (dS, R), (S, dR))]
    P = len(x)
    nodes = number(i[:, :, None], j[:, None, :])
    return nodes.reshape(P, 9), pairs[0].reshape(P, 9), _sizes(pairs[1], pairs[2], metric).reshape(P, 9)


def corners(scene: Scene, x: np.ndarray, F: np.ndarray, edges: np.ndarray, number: Number,
            metric: np.ndarray | None = None) -> Links:
    """Nodes, weights and sizes of gradients (P, M) of CPDI: corners of a domain may share nodes, where gradients add
    up. ``F`` (P, 4) are the deformation gradients, ``edges`` (P, 4) those of the domains at rest."""
    first = np.stack([F[:, 0] * edges[:, 0] + F[:, 1] * edges[:, 1], F[:, 2] * edges[:, 0] + F[:, 3] * edges[:, 1]], 1)
    second = np.stack([F[:, 0] * edges[:, 2] + F[:, 1] * edges[:, 3], F[:, 2] * edges[:, 2] + F[:, 3] * edges[:, 3]], 1)
    area = (first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0])[:, None]
    places = np.stack([x + a * first + b * second for a, b in CORNERS], axis=1) / scene.spacing  # (P, 4, 2)
    cells = np.floor(places).astype(int)
    start = cells.min(axis=1)
    P, W = len(x), int((cells.max(axis=1) - start).max()) + 2
    S, gradients = np.zeros((P, W, W)), np.zeros((P, W, W, 2))
    for c, (a, b) in enumerate(CORNERS):  # grad of the corner's value: a normal to the opposite diagonal
        normal = np.stack([a * second[:, 1] - b * first[:, 1], b * first[:, 0] - a * second[:, 0]], axis=1) / area
        place, offset = places[:, c] - cells[:, c], cells[:, c] - start
        for i in range(2):
            for j in range(2):
                N = (place[:, 0] if i else 1 - place[:, 0]) * (place[:, 1] if j else 1 - place[:, 1])
                at = (np.arange(P), offset[:, 0] + i, offset[:, 1] + j)
                S[at] += 0.25 * N
                gradients[at] += N[:, None] * normal
    lines = start[:, :, None] + np.arange(W)
    nodes = number(lines[:, 0, :, None], lines[:, 1, None, :])
    return nodes.reshape(P, -1), S.reshape(P, -1), _sizes(gradients[..., 0], gradients[..., 1], metric).reshape(P, -1)


def _sizes(x: np.ndarray, y: np.ndarray, metric: np.ndarray | None) -> np.ndarray:
    """Lengths of gradients (P, M, M), or with a ``metric`` (P, 3), as xx, xy, yy, the root of g . metric g."""
    if metric is None:
        return np.hypot(x, y)
    xx, xy, yy = metric.T[:, :, None, None]
    return np.sqrt(np.maximum(xx * x * x + 2 * xy * x * y + yy * y * y, 0.0))
