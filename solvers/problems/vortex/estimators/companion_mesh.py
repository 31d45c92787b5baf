"""The mesh of the companion on the vortex, how to read it at the particles, and its solve by itself: all in numpy."""

import functools

import numpy as np

from solvers.estimators.spectral import Elements, highest_frequency
from solvers.estimators.standalone import ElasticBody
from solvers.problems.vortex import exact
from solvers.problems.vortex.exact import combined, force_at_rest, on_axis, right
from solvers.problems.vortex.scene import VortexScene

#: Elements across the ring, whatever the particles' grid, for one radius costs next to nothing. Their own error is
#: 2e-7 m and 0.3 Pa at A = 1 (t = 0.5), where the finest run of the tables is 4e-3 m and 300 Pa off.
ACROSS, ORDER = 6, 6
STIFFENED = 1.3  # of the companion's steps: how much stiffer than at rest the vortex may grow, as a frequency


def mesh() -> Elements:
    """The elements of the radius."""
    return Elements(exact.INNER, exact.OUTER, ACROSS, ORDER)


def masses(elements: Elements) -> np.ndarray:
    """w_i R_i of the nodes: their masses in a sector of one radian, for a density of 1."""
    return elements.assembled_weights * elements.nodes


@functools.cache
def unit_frequency(elements: Elements) -> float:
    """The highest frequency of the ring at rest for a wave speed of 1 m/s, in 1/s: u_tt = u'' + u'/R - u/R^2."""
    R, node, weights = elements.nodes, elements.of_node, elements.weights
    inverse_mass = 1 / masses(elements)

    def accelerations(u: np.ndarray) -> np.ndarray:
        stretch = u[node] @ elements.derivative.T
        pull = (stretch * weights * R[node]) @ elements.derivative + weights * u[node] / R[node]
        return inverse_mass * np.bincount(node.ravel(), pull.ravel())

    return highest_frequency(accelerations, inverse_mass)


class VortexCompanionBody(ElasticBody):
    """Two functions of the radius, on a line of elements: with every angle the same, they tell all (why, and the
    equations, are in ``solvers.problems.vortex.estimators.companion``). The unknowns are the displacement of the
    particles on the x axis, along it and across it."""

    def __init__(self, scene: VortexScene, count: int, order: int):
        self._scene, self._elements = scene, Elements(exact.INNER, exact.OUTER, count, order)
        self._R, self._lame = self._elements.nodes, exact.lame(scene)
        self._inverse_mass = 1 / (scene.density * masses(self._elements))[:, None]
        self.velocity = exact.velocity(scene, on_axis(self._R), 0.0)
        self.frequency = STIFFENED * scene.wave_speed * unit_frequency(self._elements)

    def accelerations(self, u: np.ndarray, t: float) -> np.ndarray:
        (lam, mu), node, D = self._lame, self._elements.of_node, self._elements.derivative
        local, R, weight = u[node], self._R[node][..., None], self._elements.weights[:, None]
        along = np.einsum("ki,eic->ekc", D, local) + np.array([1.0, 0.0])  # F e_R, then F e_Theta
        around = right(-local) / R + np.array([0.0, 1.0])
        J = along[..., :1] * around[..., 1:] - along[..., 1:] * around[..., :1]
        with np.errstate(all="ignore"):  # a motion that is lost, which its end tells
            back = (lam * np.log(J) - mu) / J
        radial = mu * along + back * right(around)  # P e_R
        hoop = mu * around - back * right(along)  # P e_Theta
        pull = np.einsum("ki,ekc->eic", D, weight * R * radial) + weight * right(hoop)
        total = np.zeros_like(u)
        np.add.at(total, node, pull)
        return force_at_rest(self._scene, self._R, t) - self._inverse_mass * total

    def read(self, u: np.ndarray, X: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        R = np.linalg.norm(X, axis=1)
        e = X / R[:, None]
        element, values, slopes = self._elements.locate(R)
        local = u[self._elements.of_node[element]]
        there, slope = (np.einsum("pi,pic->pc", basis, local) for basis in (values, slopes))
        outward, around = combined(e, *slope.T), combined(e, *(right(-there) / R[:, None]).T)
        return combined(e, *there.T), outward[:, :, None] * e[:, None] + around[:, :, None] * right(-e)[:, None]
