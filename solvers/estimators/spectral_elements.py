"""Spectral elements in one direction: Gauss-Lobatto-Legendre points, their quadrature, derivative and interpolation.

A field on an element is the polynomial of order p through its values at the p + 1 points. With the same points for the
integrals ("collocation") the mass matrix is diagonal and the error of smooth fields falls like that of the polynomial
(Patera 1984; Komatitsch & Vilotte 1998). Set-up only: everything here is numpy, once a run.
"""

import functools
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre

POWER_TURNS = 200  # of the power method
STABLE = 2.4  # omega H up to which a sub-step is taken; Nystrom's method is stable up to 2.58, and damps from 1 on


@dataclass(frozen=True)
class Elements:
    """Line of ``count`` equal spectral elements of order p (``order``) between the coordinates ``start`` and ``end``;
    neighbours share their end points, the nodes."""

    start: float
    end: float
    count: int
    order: int

    @property
    def element_length(self) -> float:
        """Length of one element, in the unit of the coordinate."""
        return (self.end - self.start) / self.count

    @property
    def reference_points(self) -> np.ndarray:
        """Points (p+1,) of an element in its own coordinate, from -1 to 1."""
        return lobatto(self.order)[0]

    @property
    def weights(self) -> np.ndarray:
        """Quadrature weights of one element's points (p+1,): they sum to its length."""
        return 0.5 * self.element_length * lobatto(self.order)[1]

    @property
    def derivative(self) -> np.ndarray:
        """Matrix D (p+1, p+1) of the derivative at an element's points, per unit of the coordinate."""
        return differentiation_matrix(self.reference_points) * (2 / self.element_length)

    @property
    def node_coordinates(self) -> np.ndarray:
        """Coordinates of all nodes (count*p + 1,), in order."""
        inner = np.arange(self.count)[:, None] + 0.5 * (self.reference_points[:-1] + 1)
        return np.append((self.start + self.element_length * inner).ravel(), self.end)

    @property
    def node_of_point(self) -> np.ndarray:
        """Index of the node at each element's point (count, p+1)."""
        return np.arange(self.count)[:, None] * self.order + np.arange(self.order + 1)

    @property
    def assembled_weights(self) -> np.ndarray:
        """Quadrature weights (count*p + 1,) of all nodes: sums over the elements that share them."""
        return np.bincount(self.node_of_point.ravel(), np.tile(self.weights, self.count))

    def evaluate_basis(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Returns, for places x (K,), the index of their element, and values and derivatives (per unit of x) there of
        its p + 1 polynomials (K, p+1). Places outside the elements are extrapolated from the nearest one."""
        s = (x - self.start) / self.element_length
        element = np.clip(np.floor(s), 0, self.count - 1).astype(np.int32)
        to_modes = np.linalg.inv(legendre.legvander(self.reference_points, self.order))
        values = legendre.legvander(2 * (s - element) - 1, self.order) @ to_modes
        return element, values, values @ self.derivative


@functools.cache  # used by every property and interpolation
def lobatto(order: int) -> tuple[np.ndarray, np.ndarray]:
    """Returns the p + 1 Gauss-Lobatto-Legendre points in [-1, 1] of order p and their weights, read-only: +-1 and the
    roots of P_p', w = 2/(p (p+1) P_p^2)."""
    highest = np.append(np.zeros(order), 1.0)
    inner = np.sort(legendre.legroots(legendre.legder(highest)).real)
    points = np.concatenate([[-1.0], inner, [1.0]])
    weights = 2 / (order * (order + 1) * legendre.legval(points, highest) ** 2)
    points.flags.writeable = weights.flags.writeable = False
    return points, weights


def differentiation_matrix(points: np.ndarray) -> np.ndarray:
    """Returns D (n, n) with (D f)_i the derivative at point i of ``points`` (n,) of the polynomial through values f."""
    gap = points[:, None] - points
    np.fill_diagonal(gap, 1.0)
    scale = gap.prod(axis=1)
    D = scale[:, None] / scale / gap
    np.fill_diagonal(D, 0.0)
    np.fill_diagonal(D, -D.sum(axis=1))
    return D


def unresolved_size(values: np.ndarray, axis: int) -> np.ndarray:
    """Returns the size, in the unit of ``values``, of what elements' polynomials through their values at the points of
    ``axis`` leave out of a field, from the decay of the Legendre modes.

    The highest mode is the last that was kept; carried on at the rate of decay it tells the first that was not:
    c_p min(1, c_p/c_(p-1)), where c_(p-1) is at least sqrt(c_p c_(p-2)), for a field may be even or odd in an element.
    The result has the shape of ``values`` without ``axis``.
    """
    order = values.shape[axis] - 1
    to_modes = np.linalg.inv(legendre.legvander(lobatto(order)[0], order))
    modes = np.abs(np.moveaxis(values, axis, -1) @ to_modes.T)
    last = modes[..., -1]
    before = np.maximum(modes[..., -2], np.sqrt(last * modes[..., -3]))
    return last * np.minimum(1.0, last / np.maximum(before, np.finfo(float).tiny))


def highest_frequency(accelerations: Callable[[np.ndarray], np.ndarray], inverse_mass: np.ndarray) -> float:
    """Returns omega (1/s) of the fastest mode of u_tt = -A u, by the power method: at most a per cent too low.

    ``accelerations(u)`` is A u in m/s^2 for u in m, both with the shape of ``inverse_mass``, which is 0 where u is 0.
    """
    u = np.random.default_rng(0).normal(size=inverse_mass.shape) * (inverse_mass > 0)
    for _ in range(POWER_TURNS):
        u /= np.linalg.norm(u)
        u = accelerations(u)
    return float(np.sqrt(np.linalg.norm(u)))
