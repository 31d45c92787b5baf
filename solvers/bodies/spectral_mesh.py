"""Mesh of spectral elements on the patches of a body, and evaluation of its fields on lattices of points.

Every element has its own (p+1)^2 points, entry e (p+1)^2 + i (p+1) + j at the i-th point along xi and the j-th along
eta; points at one place share a ``master``, the first of them, whose value all have. Geometry is isoparametric.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre

from solvers.bodies.body import Body
from solvers.bodies.connections import equalize_counts
from solvers.estimators.spectral_elements import STABLE, differentiation_matrix, lobatto
from solvers.problems.planar.estimators.companion_patch import contravariant_vectors

Cuts = Sequence[tuple[np.ndarray, np.ndarray]]  # ends of the elements of each patch along xi and eta, from 0 to 1
MERGE, ROUNDS = 1e-7, 2  # of the body's size: width of the cells in which points are one; passes over four grids
ORDERS = (4, 6)  # of the two companions that run with every body
TRIED_ACROSS = np.arange(4, 41) / 4  # elements over the narrowest patch
FREQUENCY = 1.05  # omega h/(c p^2) of elements of width h
POINT_COST = 200 / 55  # nanoseconds of a point's step of a companion over those of a particle's step
MOST_COST, FREE = 0.05, 2.1e6  # of the run's, that companions may have; and steps of a particle that nobody waits for


class Lattice(NamedTuple):
    """Points of a patch with every coordinate ``xi`` (n,) and every ``eta`` (m,), both ascending: n m of them, in this
    order."""

    patch: int
    xi: np.ndarray
    eta: np.ndarray


def default_cuts(body: Body) -> Cuts:
    """Returns near-square elements of both companions: ``elements_across`` over the body's narrowest patch, by default
    the most with which their predicted cost is a twentieth of the run's or negligible, and at least one."""
    def counts(across: float) -> np.ndarray:
        wanted = np.rint(body.mean_lengths * (across / body.mean_lengths.min())).astype(int)
        return equalize_counts(body.patches, body.joined, np.maximum(wanted, 1))

    if body.elements_across:
        return even_cuts(counts(body.elements_across))
    allowed = [across for across in TRIED_ACROSS
               if _predicted_cost(body, counts(across)) <= max(MOST_COST * body.particle_steps, FREE)]
    return even_cuts(counts(max(allowed, default=1)))


def _predicted_cost(body: Body, counts: np.ndarray) -> float:
    """Returns the cost of both companions with ``counts`` (K, 2) elements on the patches, in steps of a particle."""
    narrowest = min(patch.side_length(side) / counts[k, side % 2] for k, patch in enumerate(body.patches)
                    for side in range(4))
    steps = FREQUENCY * body.wave_speed * body.t_end / (STABLE * narrowest)  # over the square of the order
    return POINT_COST * steps * counts.prod(axis=1).sum() * sum((p + 1)**2 * p**2 for p in ORDERS)


def even_cuts(counts: np.ndarray) -> Cuts:
    """Returns the ends of equal elements, ``counts`` (K, 2) of them along xi and eta of each patch."""
    return [(np.linspace(0, 1, a + 1), np.linspace(0, 1, b + 1)) for a, b in counts]


class SpectralMesh:
    """Mesh of order p (``order``) with N points: ``points`` (N, 2) in m, ``geometry`` (N, 4) j grad xi and j grad eta
    in the element's coordinates from -1 to 1, ``master`` (N,), ``inverse_mass`` (N, 2) in 1/kg per metre of thickness,
    0 for held components."""

    def __init__(self, body: Body, cuts: Cuts, order: int):
        self.cuts, self.order = cuts, order
        reference, weights = lobatto(order)
        self.derivative, self.weights = differentiation_matrix(reference), np.outer(weights, weights)
        self._sizes = [(len(a) - 1, len(b) - 1) for a, b in cuts]
        self._starts = np.cumsum([0, *(a * b * (order + 1)**2 for a, b in self._sizes)])
        points = []
        for patch, (along, across) in zip(body.patches, cuts, strict=True):
            xi, eta = (one[:-1, None] + np.diff(one)[:, None] * 0.5 * (reference + 1) for one in (along, across))
            xi, eta = np.broadcast_arrays(xi[:, None, :, None], eta[None, :, None, :])
            points.append(patch.place(xi.ravel(), eta.ravel()))
        self.points = np.concatenate(points)
        self.elements = len(self.points) // (order + 1)**2
        self.geometry = contravariant_vectors(self._reference_derivatives(self.points))
        self._area = self.geometry[:, 0] * self.geometry[:, 3] - self.geometry[:, 1] * self.geometry[:, 2]
        self.master = _merge(self.points)
        mass = np.bincount(self.master, body.density * self._area * np.tile(self.weights.ravel(), self.elements),
                           len(self.points))
        held = np.zeros((len(self.points), 2), bool)
        np.logical_or.at(held, self.master, self._constrained_components(body))
        self.inverse_mass = ~held[self.master] / mass[self.master][:, None]

    def _constrained_components(self, body: Body) -> np.ndarray:
        """Returns the components (N, 2) that clamped and roller sides hold."""
        held = np.zeros((len(self.points), 2), bool)
        for k, patch in enumerate(body.patches):
            for side in range(4):
                grid = self.point_numbers(k)
                row = 0 if side in (0, 3) else -1
                on = grid[row, :, row] if side % 2 else grid[:, row, :, row]
                for axis in patch.constrained_axes(side):
                    held[on, axis] = True
        return held

    def point_numbers(self, patch: int) -> np.ndarray:
        """Returns the numbers of a patch's points, by element along xi and eta, and by point in the element."""
        return np.arange(self._starts[patch], self._starts[patch + 1]).reshape(*self._sizes[patch], self.order + 1, -1)

    def _reference_derivatives(self, nodal: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Returns the derivatives (N, 2) of nodal values (N, 2) in the coordinates of the elements."""
        local = nodal.reshape(-1, self.order + 1, self.order + 1, 2)
        return ((self.derivative @ local.reshape(len(local), self.order + 1, -1)).reshape(-1, 2),
                (self.derivative @ local).reshape(-1, 2))

    def least_stretch(self, u: np.ndarray) -> tuple[float, np.ndarray]:
        """Returns the least principal stretch at the points for displacements u (N, 2) in m, and its place (2,);
        below 0 where the body is turned inside out."""
        by_xi, by_eta = self._reference_derivatives(u)
        xx, xy, yx, yy = _material_gradient(by_xi, by_eta, (self.geometry / self._area[:, None]).T)
        xx, yy = 1 + xx, 1 + yy
        smallest = 0.5 * (np.hypot(xx + yy, xy - yx) - np.hypot(xx - yy, xy + yx))  # singular value of F, with sign
        at = int(np.argmin(smallest))
        return float(smallest[at]), self.points[at]


class LatticeBasis(NamedTuple):
    """Tables with which kernels evaluate a mesh's fields on lattices, P points in all, in batches of neighbours along
    eta within one element.

    ``values`` (R, 2) are those of n polynomials and their derivatives by xi at each xi of a patch, then by eta at each
    eta; ``batches`` (B + 1, 4) the element's first point, the first row of values for the batch's xi and for the first
    of its eta, and its first lattice point, of which the last row is P; ``coordinate_gradients`` (P, 4) are grad xi and
    grad eta in 1/m.
    """

    values: np.ndarray
    batches: np.ndarray
    coordinate_gradients: np.ndarray


def lattice_basis(mesh: SpectralMesh, lattices: Sequence[Lattice]) -> LatticeBasis:
    """Returns the tables for a mesh and lattices."""
    values, batches, gradients, n, rows, points = [], [], [], mesh.order + 1, 0, 0
    for patch, xi, eta in lattices:
        (at_xi, along), (at_eta, across) = (_interpolation(cuts, mesh.order, s)
                                            for cuts, s in zip(mesh.cuts[patch], (xi, eta), strict=True))
        numbers = mesh.point_numbers(patch)
        lines = np.einsum("kbpqc,dkp->dkbqc", mesh.points[numbers[at_xi]], along)[:, :, at_eta]  # points at each xi
        by_xi, by_eta = (np.einsum("kmqc,mq->kmc", lines[1 - d], across[d]).reshape(-1, 2) for d in (0, 1))
        g = contravariant_vectors((by_xi, by_eta))
        gradients.append(g / (g[:, 0] * g[:, 3] - g[:, 1] * g[:, 2])[:, None])
        i, first = np.arange(len(xi))[:, None], np.flatnonzero(np.diff(at_eta, prepend=-1))  # the first in an element
        batches.append(np.stack(np.broadcast_arrays(
            numbers[at_xi[:, None], at_eta[first], 0, 0], rows + i * n, rows + (len(xi) + first) * n,
            points + i * len(eta) + first), axis=-1).reshape(-1, 4))
        values += [along.reshape(2, -1).T, across.reshape(2, -1).T]
        rows, points = rows + (len(xi) + len(eta)) * n, points + len(xi) * len(eta)
    return LatticeBasis(np.concatenate(values), np.concatenate([*batches, [[0, 0, 0, points]]]),
                        np.concatenate(gradients))


def _material_gradient(by_xi: np.ndarray, by_eta: np.ndarray, g: np.ndarray) -> tuple[np.ndarray, ...]:
    """Returns the gradient of a vector field in X as xx, xy, yx, yy (N,), from its derivatives by xi and eta (N, 2)
    and ``g`` (4, N), grad xi and grad eta."""
    (x, y), (p, q) = by_xi.T, by_eta.T
    return x * g[0] + p * g[2], x * g[1] + p * g[3], y * g[0] + q * g[2], y * g[1] + q * g[3]


def _interpolation(cuts: np.ndarray, order: int, s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Returns the element of a line in which each of its coordinates ``s`` (k,) lies, and matrices (2, k, n) that take
    the values at its n points to the value and the derivative there."""
    points = lobatto(order)[0]
    element = np.clip(np.searchsorted(cuts, s, side="right") - 1, 0, len(cuts) - 2)
    width = np.diff(cuts)[element]
    basis = legendre.legvander(2 * (s - cuts[element]) / width - 1, order) @ np.linalg.inv(
        legendre.legvander(points, order))
    return element, np.stack([basis, basis @ differentiation_matrix(points) * (2 / width)[:, None]])


def _merge(points: np.ndarray) -> np.ndarray:
    """Returns for each of N points (N, 2) in m the first at its place. Four grids of cells, each half a cell from the
    others, so that points that differ by rounding are in one cell of at least one."""
    width = MERGE * float(np.ptp(points, axis=0).max())
    master = np.arange(len(points))
    for shift in ROUNDS * ((0.0, 0.0), (0.5, 0.0), (0.0, 0.5), (0.5, 0.5)):
        _, cell = np.unique(np.floor(points / width + shift), axis=0, return_inverse=True)
        first = np.full(len(points), len(points))
        np.minimum.at(first, cell.ravel(), master)
        master = first[cell.ravel()]
    return master
