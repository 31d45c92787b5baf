"""The mesh of the companion on the ring, and how to read it at the particles: set-up only, in numpy."""

import functools
import math

import numpy as np

from solvers.estimators.companion import LAYERS, highest_frequency
from solvers.estimators.spectral import Elements
from solvers.problems.planar.layout import particle_layout
from solvers.problems.ring.exact import INNER, OUTER
from solvers.problems.ring.scene import RingScene

#: Up to so many cells: elements across, elements around, order p.
MESHES = ((40, (1, 2, 4)), (72, (2, 3, 4)), (128, (2, 3, 5)), (math.inf, (3, 4, 6)))

def mesh(cells: int) -> tuple[Elements, Elements]:
    """Elements across the ring and around it: few, for the solve must cost little beside the particles.

    Chosen on the free ring, which unlike the manufactured one is no polynomial in R: the velocity's pointwise distance
    from an independent solution stays below 0.01 with CPDI at 24 to 96 cells.
    """
    across, around, order = next(sizes for most, sizes in MESHES if cells <= most)
    return Elements(INNER, OUTER, across, order), Elements(0.0, 0.5 * np.pi, around, order)


def read_particles(scene: RingScene, radial: Elements, angular: Elements) -> tuple[np.ndarray, np.ndarray]:
    """``companion_basis`` and ``companion_places``: how to read the companion at the particles.

    The basis is values and derivatives of the p + 1 polynomials at every material radius, then at every angle. The
    places begin with a line for each radius and one more, (where its particles begin, first node of its element, 0, 0),
    and then have the particles, radius by radius: (particle, first node of its element on an arc, its basis, 0).
    """
    layout = particle_layout(scene)
    angles, angle = np.unique(np.arctan2(layout.position[:, 1], layout.position[:, 0]).round(12), return_inverse=True)
    (outward, *at_radius), (around, *at_angle) = radial.locate(layout.radii), angular.locate(angles)
    K, order = len(layout.radii), np.argsort(layout.radius, kind="stable")
    places = np.zeros((K + 1 + len(order), 4), np.int32)
    places[:K + 1, 0] = K + 1 + np.searchsorted(layout.radius[order], np.arange(K + 1))
    places[:K, 1] = outward * radial.order * len(angular.nodes)
    places[K + 1:, 0] = order
    places[K + 1:, 1] = LAYERS * len(radial.nodes) * len(angular.nodes) + around[angle[order]] * angular.order
    places[K + 1:, 2] = (K + angle[order]) * (angular.order + 1)
    return np.concatenate([np.stack(at, axis=2).reshape(-1, 2) for at in (at_radius, at_angle)]), places


def directions(angular: Elements) -> np.ndarray:
    """e_R at the angles of the nodes (row, 2), exact on the symmetry planes."""
    e = np.stack([np.cos(angular.nodes), np.sin(angular.nodes)], axis=1)
    e[0], e[-1] = (1, 0), (0, 1)
    return e


def masses(radial: Elements, angular: Elements) -> np.ndarray:
    """w_i R_i of the nodes (radii, row): their masses, for a density of 1."""
    return np.outer(radial.assembled_weights * radial.nodes, angular.assembled_weights)


def free(radial: Elements, angular: Elements) -> np.ndarray:
    """1 where a component of a node can move and 0 where a symmetry plane holds it (radii, row, 2)."""
    moves = np.ones((len(radial.nodes), len(angular.nodes), 2))
    moves[:, 0, 1] = moves[:, -1, 0] = 0
    return moves


@functools.cache
def unit_frequency(radial: Elements, angular: Elements) -> float:
    """The highest frequency of the ring at rest for a wave speed of 1 m/s, in 1/s: P = (grad u + grad u^T)/2."""
    node = np.broadcast_arrays(radial.of_node[:, None, :, None], angular.of_node[None, :, None, :])
    R, e = radial.nodes[node[0]][..., None], directions(angular)[node[1]]
    t = np.stack([-e[..., 1], e[..., 0]], axis=-1)
    weight = np.outer(radial.weights, angular.weights)[..., None] * R
    inverse_mass = free(radial, angular) / masses(radial, angular)[..., None]

    def accelerations(u: np.ndarray) -> np.ndarray:
        out = np.einsum("ik,abkjc->abijc", radial.derivative, u[tuple(node)])
        along = np.einsum("jk,abikc->abijc", angular.derivative, u[tuple(node)]) / R
        gradient = out[..., :, None] * e[..., None, :] + along[..., :, None] * t[..., None, :]
        P = 0.5 * weight[..., None] * (gradient + np.swapaxes(gradient, -1, -2))
        pull = np.einsum("ki,abkjd,abkjcd->abijc", radial.derivative, e, P) \
            + np.einsum("kj,abikd,abikcd->abijc", angular.derivative, t / R, P)
        total = np.zeros_like(u)
        np.add.at(total, tuple(node), pull)
        return inverse_mass * total

    return highest_frequency(accelerations, inverse_mass)
