"""The bound on the ring's time step along the motion ahead (see ``solvers.step_bound``).

For P = mu (F - F^-T) a change of F by g F with g = v grad S costs mu (g b : g + g^T : g) <= mu (1 + largest eigenvalue
of b = F F^T) |g|^2 per reference volume; in material form, for frozen weights, mu (1 + 1/smallest eigenvalue of b).
"""

from dataclasses import replace

import numpy as np

from solvers.ring import exact
from solvers.ring.layout import CORNERS, GHOSTS, particle_layout
from solvers.ring.scene import RingScene
from solvers.step_bound import INSTANTS, bound, stencil

MOST_PARTICLES = 10_000  # of the ring that is looked at; a finer one meets the grid in the same ways


def least(scene: RingScene) -> float:
    """The smallest bound, in seconds, over the ring's motion from one extreme to the other."""
    fine = scene
    while scene.particles > MOST_PARTICLES and scene.cells > scene.FEWEST_CELLS:
        scene = replace(scene, cells=max(scene.cells // 2, scene.FEWEST_CELLS))
    layout = particle_layout(scene)
    sizes = scene.amplitude * np.linspace(-1, 1, INSTANTS)
    return min(_at(scene, layout, size) for size in sizes) * fine.spacing / scene.spacing


def _at(scene: RingScene, layout, size: float) -> float:
    """The bound where the radial displacement is ``size`` w(R)."""
    X, R = layout.position, layout.radii[layout.radius]
    w, slope, _ = exact.shape(R)
    radial, hoop = 1 + size * slope, 1 + size * w / R
    if scene.frozen:
        x, F, stretch = X, np.tile([1.0, 0.0, 0.0, 1.0], (len(X), 1)), 1 / np.minimum(radial, hoop)
    else:
        c, s = (X / R[:, None]).T
        F = np.stack([radial * c * c + hoop * s * s, (radial - hoop) * c * s, (radial - hoop) * c * s,
                      radial * s * s + hoop * c * c], axis=1)
        x, stretch = X * (1 + size * w / R)[:, None], np.maximum(radial, hoop)
    nodes, S, gradients = _cpdi(scene, x, F, layout.edges) if scene.method == "cpdi" else _boxes(scene, x, F)
    stiffness = 0.5 * scene.modulus * (1 + stretch**2) * layout.volume
    mass = np.bincount(nodes.ravel(), (scene.density * layout.volume[:, None] * S).ravel())
    return bound(nodes, gradients, stiffness, mass)


def _boxes(scene: RingScene, x: np.ndarray, F: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Nodes, weights and sizes of gradients (P, 9) of hat, uGIMP and cpGIMP."""
    axes = []
    for axis, stretch in enumerate((F[:, 0], F[:, 3])):
        half_width = np.full(len(x), 0.5 / scene.ppc)
        if scene.method == "cpgimp":
            half_width = np.clip(half_width * stretch, 1e-6, 0.5)
        first, S, dS = stencil(scene.method, x[:, axis] / scene.spacing, half_width)
        axes.append((np.abs(first[:, None] + np.arange(3)), S, dS / scene.spacing))  # mirrored about the planes
    (i, S, dS), (j, R, dR) = axes
    pairs = [a[:, :, None] * b[:, None, :] for a, b in ((S, R), (dS, R), (S, dR))]
    nodes = i[:, :, None] + (scene.cells + 2 * GHOSTS) * j[:, None, :]
    P = len(x)
    return nodes.reshape(P, 9), pairs[0].reshape(P, 9), np.hypot(pairs[1], pairs[2]).reshape(P, 9)


def _cpdi(scene: RingScene, x: np.ndarray, F: np.ndarray,
          edges: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Nodes, weights and sizes of gradients (P, 25): corners of a domain may share nodes, where gradients add up."""
    first = np.stack([F[:, 0] * edges[:, 0] + F[:, 1] * edges[:, 1], F[:, 2] * edges[:, 0] + F[:, 3] * edges[:, 1]], 1)
    second = np.stack([F[:, 0] * edges[:, 2] + F[:, 1] * edges[:, 3], F[:, 2] * edges[:, 2] + F[:, 3] * edges[:, 3]], 1)
    area = (first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0])[:, None]
    corners = np.stack([x + a * first + b * second for a, b in CORNERS], axis=1) / scene.spacing  # (P, 4, 2)
    cells = np.floor(corners).astype(int)
    start = cells.min(axis=1)
    P, S, gradients = len(x), np.zeros((len(x), 5, 5)), np.zeros((len(x), 5, 5, 2))
    for c, (a, b) in enumerate(CORNERS):  # grad of the corner's value: a normal to the opposite diagonal
        normal = np.stack([a * second[:, 1] - b * first[:, 1], b * first[:, 0] - a * second[:, 0]], axis=1) / area
        place, offset = corners[:, c] - cells[:, c], np.minimum(cells[:, c] - start, 3)
        for i in range(2):
            for j in range(2):
                N = (place[:, 0] if i else 1 - place[:, 0]) * (place[:, 1] if j else 1 - place[:, 1])
                at = (np.arange(P), offset[:, 0] + i, offset[:, 1] + j)
                S[at] += 0.25 * N
                gradients[at] += N[:, None] * normal
    lines = np.abs(start[:, :, None] + np.arange(5))  # mirrored about the planes
    nodes = lines[:, 0, :, None] + (scene.cells + 2 * GHOSTS) * lines[:, 1, None, :]
    return nodes.reshape(P, 25), S.reshape(P, 25), np.hypot(*np.moveaxis(gradients, 3, 0)).reshape(P, 25)
