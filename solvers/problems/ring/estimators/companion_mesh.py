"""The mesh of the companion on the ring, how to read it at the particles, and its solve by itself: all in numpy."""

import functools
import math

import numpy as np

from solvers.estimators.companion import LAYERS
from solvers.estimators.spectral import Elements, highest_frequency
from solvers.estimators.standalone import PolarBody
from solvers.problems.planar.layout import particle_layout
from solvers.problems.ring import exact
from solvers.problems.ring.scene import RingScene

#: Up to so many cells: elements across, elements around, order p.
MESHES = ((40, (1, 2, 4)), (72, (2, 3, 4)), (128, (2, 3, 5)), (math.inf, (3, 4, 6)))


def elements(across: int, around: int, order: int) -> tuple[Elements, Elements]:
    """So many elements across the quarter ring and around it, of the order p."""
    return Elements(exact.INNER, exact.OUTER, across, order), Elements(0.0, 0.5 * np.pi, around, order)


def mesh(cells: int) -> tuple[Elements, Elements]:
    """Elements across the ring and around it: few, for the solve must cost little beside the particles.

    Chosen on the free ring, which unlike the manufactured one is no polynomial in R: the velocity's pointwise distance
    from an independent solution stays below 0.01 with CPDI at 24 to 96 cells.
    """
    across, around, order = next(sizes for most, sizes in MESHES if cells <= most)
    return elements(across, around, order)


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


def free(radial: Elements, angular: Elements) -> np.ndarray:
    """1 where a component of a node can move and 0 where a symmetry plane holds it (radii, row, 2)."""
    moves = np.ones((len(radial.nodes), len(angular.nodes), 2))
    moves[:, 0, 1] = moves[:, -1, 0] = 0
    return moves


@functools.cache
def unit_frequency(radial: Elements, angular: Elements) -> float:
    """The highest frequency of the ring at rest for a wave speed of 1 m/s, in 1/s: P = (grad u + grad u^T)/2."""
    body = RingAtRest(radial, angular, directions(angular), free(radial, angular), 1.0, 0.0)
    return highest_frequency(lambda u: -body.accelerations(u, 0.0), body.inverse_mass)


class RingAtRest(PolarBody):
    """The ring under small strains, of unit density and with E = 1 Pa, which nothing pushes."""

    def piola(self, F: np.ndarray) -> np.ndarray:
        return 0.5 * (F + np.swapaxes(F, -1, -2)) - np.eye(2)

    def force(self, t: float) -> np.ndarray:
        return np.zeros_like(self.places)


class RingCompanionBody(PolarBody):
    """The quarter ring, its surfaces free, held across the planes of symmetry."""

    def __init__(self, scene: RingScene, across: int, around: int, order: int):
        radial, angular = elements(across, around, order)
        # strain stiffens: the tangent of the exact motion is at most mu (1 + 1/s^2), s the least stretch
        stretches = [np.min(exact.stretches(scene, radial.nodes, s * scene.period / 4)) for s in (1, 3)]
        stiffest = 0.5 * (1 + 1 / max(0.1, min(stretches)) ** 2)
        super().__init__(radial, angular, directions(angular), free(radial, angular), scene.density,
                         scene.wave_speed * unit_frequency(radial, angular) * float(np.sqrt(stiffest)))
        self._scene = scene
        self.velocity = exact.velocity(scene, self.places, 0.0) * free(radial, angular).reshape(-1, 2)
        self._directions = np.broadcast_to(directions(angular), (self.rows, self.row, 2)).reshape(-1, 2)

    def piola(self, F: np.ndarray) -> np.ndarray:
        J = F[..., 0, 0] * F[..., 1, 1] - F[..., 0, 1] * F[..., 1, 0]
        turned = np.stack([F[..., 1, 1], -F[..., 1, 0], -F[..., 0, 1], F[..., 0, 0]], axis=-1).reshape(F.shape)
        return 0.5 * self._scene.modulus * (F - turned / J[..., None, None])

    def force(self, t: float) -> np.ndarray:
        return np.repeat(exact.body_force(self._scene, self.radial.nodes, t), self.row)[:, None] * self._directions
