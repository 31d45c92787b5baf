"""The mesh of the companion on the vortex, and how to read it at the particles: set-up only, in numpy."""

import functools

import numpy as np

from solvers.estimators.companion import highest_frequency
from solvers.estimators.spectral import Elements
from solvers.problems.vortex.exact import INNER, OUTER

#: Elements across the ring, whatever the particles' grid, for one radius costs next to nothing. Their own error is
#: 2e-7 m and 0.3 Pa at A = 1 (t = 0.5), where the finest run of the tables is 4e-3 m and 300 Pa off.
ACROSS, ORDER = 6, 6


def mesh() -> Elements:
    """The elements of the radius."""
    return Elements(INNER, OUTER, ACROSS, ORDER)


def masses(elements: Elements) -> np.ndarray:
    """w_i R_i of the nodes: their masses in a sector of one radian, for a density of 1."""
    return elements.assembled_weights * elements.nodes


def read_radii(elements: Elements, radii: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """First node of the element of each of K radii, and there the p + 1 polynomials: value and slope (K (p+1), 2)."""
    element, values, slopes = elements.locate(radii)
    return (element * elements.order).astype(np.int32), np.stack([values, slopes], axis=2).reshape(-1, 2)


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
