"""Where the ring's particles begin, what they weigh and which domain they stand for."""

from dataclasses import dataclass

import numpy as np

from solvers.ring.exact import INNER, OUTER
from solvers.ring.scene import RingScene, polar_counts

CORNERS = ((-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5))  # of a CPDI domain, in its edges from its middle
GHOSTS = 2  # rows of nodes beyond each symmetry plane
MOST_HALF_WIDTH = 0.5  # of a box, in cells: it meets at most two cells, so that three nodes suffice


@dataclass(frozen=True)
class Layout:
    """P particles. ``edges`` are the domain's two edge vectors r1 and r2, as (r1x, r1y, r2x, r2y).

    ``radius[p]`` is the index of the particle's material radius in ``radii``: what depends on R alone is computed
    once a radius and not once a particle.
    """

    position: np.ndarray  # (P, 2)
    volume: np.ndarray  # (P,), per unit thickness
    edges: np.ndarray  # (P, 4)
    radii: np.ndarray  # (K,)
    radius: np.ndarray  # (P,) int32
    neighbours: np.ndarray  # the next particles on the lattice in its two directions, -1 for none (P, 2)


def particle_layout(scene: RingScene) -> Layout:
    """The scene's layout: "polar" lattices fill the ring exactly, "cartesian" ones leave a staircase at its rim."""
    return _polar(scene) if scene.layout == "polar" else _cartesian(scene)


def half_edges(scene: RingScene, F: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """Half the edge vectors (P, 2, 2) in metres, a row each, of the particles' domains as the method sees them where
    the deformation gradients are ``F`` (P, 2, 2); ``edges`` (P, 4) are those of the layout. No domain: zeros."""
    if scene.method == "cpdi":
        rest = 0.5 * edges.reshape(-1, 2, 2)
        return rest if scene.frozen else np.einsum("pij,pej->pei", F, rest)
    at_rest = 0.5 / scene.ppc
    width = np.full((len(F), 2), 0.0 if scene.method == "mpm" else at_rest)
    if scene.method == "cpgimp" and not scene.frozen:
        width = np.clip(at_rest * F[:, [0, 1], [0, 1]], 1e-6, MOST_HALF_WIDTH)
    return scene.spacing * width[:, :, None] * np.eye(2)


def _polar(scene: RingScene) -> Layout:
    around, across = polar_counts(scene.cells, scene.ppc)
    d_angle, d_radius = 0.5 * np.pi / around, (OUTER - INNER) / across
    radii = INNER + (np.arange(across) + 0.5) * d_radius
    angle, radius = (g.ravel() for g in np.meshgrid((np.arange(around) + 0.5) * d_angle, np.arange(across),
                                                    indexing="ij"))
    R, c, s = radii[radius], np.cos(angle), np.sin(angle)
    edges = np.stack([R * d_angle * s, -R * d_angle * c, d_radius * c, d_radius * s], axis=1)
    return Layout(np.stack([R * c, R * s], axis=1), R * d_radius * d_angle, edges, radii, radius.astype(np.int32),
                  _neighbours(np.arange(around * across).reshape(around, across)))


def _cartesian(scene: RingScene) -> Layout:
    side = scene.spacing / scene.ppc
    line = (np.arange(int(np.ceil(OUTER / side))) + 0.5) * side
    y, x = (g.ravel() for g in np.meshgrid(line, line, indexing="ij"))
    R = np.hypot(x, y)
    kept = (R >= INNER) & (R <= OUTER)
    x, y = x[kept], y[kept]
    radii, radius = np.unique(R[kept].round(12), return_inverse=True)
    edges = np.tile([side, 0.0, 0.0, side], (len(x), 1))
    number = np.where(kept, np.cumsum(kept) - 1, -1).reshape(len(line), len(line))
    return Layout(np.stack([x, y], axis=1), np.full(len(x), side**2), edges, radii, radius.astype(np.int32),
                  _neighbours(number))


def _neighbours(number: np.ndarray) -> np.ndarray:
    """Of a lattice of particles' numbers, -1 where there is none: the next in either direction (P, 2)."""
    wide = np.pad(number, ((0, 1), (0, 1)), constant_values=-1)
    return np.stack([wide[1:, :-1], wide[:-1, 1:]], axis=2)[number >= 0]
