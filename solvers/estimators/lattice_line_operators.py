"""Operators along one line of a material lattice: recovery of smooth fields, B-splines, integrals.

The particles of the bar, and those of a polar lattice along an angle or a radius, begin at j + 1/2, j = 0, 1, ... in
units of their spacing. A field known at particles is *recovered* between them by a weighted least-squares polynomial
(moving least squares on a line); an *error grid* of quadratic B-splines, one an element, stands on the same line. All
operators are rows of few weights on consecutive entries: a :class:`Rows` each. Two-dimensional operators are products
of an angular and a radial one, so that nothing in two dimensions has ever to be stored.

What lies beyond the ends of a line is said by ``ends``: "periodic", "free" (nothing: recovery becomes one-sided), or a
symmetry plane at each end, across which one component is odd: "mirror" where the planes are at right angles to each
other, on the arc of a quarter of a ring, and "walls" where they are parallel.
"""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Rows:
    """Sparse linear map: entry r of its result is the sum over k < ``width`` of ``weights[r, k]`` times the input's
    entry ``first[r] + k``, modulo its length. ``first`` (rows,) are indices; ``weights`` (rows, width, ...) may hold
    several maps, such as a value and a slope, side by side."""

    first: np.ndarray
    weights: np.ndarray

    @property
    def width(self) -> int:
        return self.weights.shape[1]

    def repeat_over_cells(self, cells: int, rows: int, columns: int) -> "Rows":
        """Returns the map of a periodic line of ``cells`` equal cells, with ``rows`` results and ``columns`` inputs
        each, from the map of fewer such cells. It stores one cell's weights: row r has ``weights[r % rows]``."""
        few = len(self.first) // rows * columns  # columns of the shorter line
        first = self.first[:rows].astype(np.int64)
        first = np.where(first > few // 2, first - few, first)
        first = (np.arange(cells)[:, None] * columns + first).ravel() % (cells * columns)
        return Rows(first.astype(np.int32), self.weights[:rows])

    def __call__(self, values: np.ndarray) -> np.ndarray:
        """Returns the map or maps of ``values`` (inputs,): (rows, ...), for use outside kernels."""
        at = (self.first[:, None] + np.arange(self.width)) % len(values)
        weights = self.weights[np.arange(len(at)) % len(self.weights)]
        return np.einsum("rk...,rk->r...", weights, values[at])


@dataclass(frozen=True)
class LatticeLine:
    """Line of ``points`` particles, ``length`` m long, under ``elements`` elements of the error grid; ``ends``, what
    lies beyond, is "periodic", "free", "mirror" or "walls". Maps have a sign for each of the vector components that
    differ beyond symmetry planes: two with "mirror" and "walls", else one. A free end may be ``clamped``, the first or
    the last: what forces hold it there is unknown, so the error grid has only functions that vanish there."""

    points: int
    elements: int
    length: float
    ends: str
    clamped: tuple[bool, bool] = (False, False)

    @property
    def node_count(self) -> int:
        """Number of B-splines of the error grid: one per element, and one more beyond each free end not clamped."""
        return self.elements + (2 - sum(self.clamped) if self.ends == "free" else 0)

    @property
    def points_per_length(self) -> float:
        return self.points / self.length

    @property
    def elements_per_length(self) -> float:
        return self.elements / self.length

    def quadrature(self) -> tuple[np.ndarray, np.ndarray]:
        """Returns Gauss points (Q,), in particle spacings from the line's start, and weights (Q,) in m: two a particle
        or more, equal in each element. They belong to elements and not to particles, whose domains may end anywhere:
        an integral of N' that is not exact leaves a force in a constant stress, at every mesh."""
        points, weights = np.polynomial.legendre.leggauss(max(3, 2 * -(-self.points // self.elements)))
        at = (np.arange(self.elements)[:, None] + 0.5 + 0.5 * points) * (self.points / self.elements)
        return at.ravel(), np.tile(0.5 * weights / self.elements_per_length, self.elements)

    def particle_positions(self) -> np.ndarray:
        """Returns where the particles are (points,), in particle spacings from the line's start."""
        return np.arange(self.points) + 0.5

    def fit_operator(self, width: int, degree: int) -> Rows:
        """Returns the map from values at particles to fits of ``degree`` over ``width`` of them: value and slope (per
        m) at every particle, weights (points, width, components, 2)."""
        index, value, slope = self._recovery_weights(self.particle_positions(), width, degree)
        index, sign = self._fold(index, self.points)
        weights = sign[..., None] * np.stack([value, slope * self.points_per_length], axis=-1)[:, :, None]
        return self._sum_rows(np.arange(self.points)[:, None], index, weights, self.points, self.points)

    def interpolation_operator(self) -> Rows:
        """Returns the map from coefficients of B-splines to value and slope (per m) at every particle: weights (points,
        3, components, 2)."""
        index, value, slope = self._splines(self.particle_positions())
        index, sign = self._fold_nodes(index)
        weights = sign[..., None] * np.stack([value, slope * self.elements_per_length], axis=-1)[:, :, None]
        return self._sum_rows(np.arange(self.points)[:, None], index, weights, self.points, self.node_count)

    def projection_operator(self, width: int, degree: int, measure: np.ndarray | float = 1.0) -> Rows:
        """Returns the map from f at particles to integrals of m N f, m N' f and N f, each over the integral of m N.

        f is a fit of ``degree`` over ``width`` particles, N a B-spline, and m the ``measure`` at the Gauss points (Q,),
        such as R on a radius. Weights (nodes, k, components, 3), one for each integral. In the second f is a derivative
        along the line, so beyond a symmetry plane it has the other sign than the component itself.
        """
        q, weight = self.quadrature()
        measured = weight * measure
        node, N, dN = self._splines(q)
        particle, value, _ = self._recovery_weights(q, width, degree)
        kinds = np.stack([N * measured[:, None], dN * self.elements_per_length * measured[:, None],
                          N * weight[:, None]], -1)
        node, node_sign = self._fold_nodes(node)
        particle, sign = self._fold(particle, self.points)
        signs = np.stack([sign, sign[..., ::-1], sign], -1)  # (Q, k, components, 3)
        found = (signs * value[:, :, None, None])[:, None]
        values = node_sign[:, :, None, :, None] * kinds[:, :, None, None, :] * found
        banded = self._sum_rows(node[:, :, None], particle[:, None, :], values, self.node_count, self.points)
        return Rows(banded.first, banded.weights / self.spline_integrals(measure)[:, None, None, None])

    def spline_integrals(self, measure: np.ndarray | float = 1.0) -> np.ndarray:
        """Returns integrals (nodes,) in m of the B-splines times ``measure`` (Q,), images beyond a mirror included."""
        q, weight = self.quadrature()
        node, N, _ = self._splines(q)
        total = np.zeros(self.node_count)
        np.add.at(total, self._fold_nodes(node)[0], N * (weight * measure)[:, None])
        return total

    def smoothing_operator(self, measure: np.ndarray | float = 1.0) -> Rows:
        """Returns the map of nodal values by the integral of N_i N_j over that of N_i, both times ``measure`` (Q,):
        what spreading and gathering does. Weights (nodes, k, components, 2), the second of each pair zero."""
        q, weight = self.quadrature()
        node, N, _ = self._splines(q)
        node, sign = self._fold_nodes(node)
        values = (sign * (N * (weight * measure)[:, None])[..., None])[:, :, None] * (sign * N[..., None])[:, None]
        banded = self._sum_rows(node[:, :, None], node[:, None, :], values, self.node_count, self.node_count)
        weights = banded.weights / self.spline_integrals(measure)[:, None, None]
        return Rows(banded.first, np.stack([weights, np.zeros_like(weights)], axis=-1))

    def _recovery_weights(self, at: np.ndarray, width: int, degree: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Returns indices of the nearest particles to the places ``at`` (Q,), in spacings, and their weights for value
        and slope (per spacing) there, (Q, width) each: fits of ``degree``, in which a particle at the distance d counts
        (1 - (d/r)^2)^2, r just beyond the furthest. Equal places have equal weights, which are then found once."""
        width = min(width, self.points) if self.ends == "free" else width
        first = np.ceil(at - 0.5 * (width + 1) - 1e-9).astype(np.int64)
        if self.ends == "free":
            first = np.clip(first, 0, self.points - width)
        index = first[:, None] + np.arange(width)
        unique, back = np.unique((index + 0.5 - at[:, None]).round(9), axis=0, return_inverse=True)
        furthest = np.maximum(1.01 * np.abs(unique).max(axis=1, keepdims=True), 0.5 * width + 0.3)
        weight = (1 - (unique / furthest) ** 2) ** 2
        powers = unique[:, :, None] ** np.arange(min(degree, width - 1) + 1)
        weighted = weight[:, :, None] * powers
        found = np.linalg.solve(np.einsum("qka,qkb->qab", weighted, powers), weighted.transpose(0, 2, 1))
        slope = found[:, 1] if found.shape[1] > 1 else np.zeros_like(found[:, 0])
        return index, found[back.ravel(), 0], slope[back.ravel()]

    def _splines(self, at: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Returns the three quadratic B-splines at places ``at`` (Q,), in particle spacings: indices, values and slopes
        (per element), (Q, 3) each."""
        x = at * (self.elements / self.points)
        element = np.clip(np.floor(x), 0, self.elements - 1).astype(np.int64)
        s = x - element
        value = np.stack([0.5 * (1 - s) ** 2, 0.5 + s - s * s, 0.5 * s * s], axis=1)
        return element[:, None] + np.arange(-1, 2), value, np.stack([s - 1, 1 - 2 * s, s], axis=1)

    def _fold_nodes(self, index: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Returns the nodes that stand for indices of B-splines (...), and signs of components: see :meth:`_fold`. That
        beyond a clamped end belongs to the one before it, and is subtracted from it."""
        if self.ends != "free":
            return self._fold(index, self.elements)
        low, high = (index < 0) & self.clamped[0], (index >= self.elements) & self.clamped[1]
        inside = np.where(low, -1 - index, np.where(high, 2 * self.elements - 1 - index, index))
        return inside + (not self.clamped[0]), np.where(low | high, -1.0, 1.0)[..., None]

    def _fold(self, index: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
        """Returns the points of a line of ``count`` that stand for indices (...) beyond its ends, and the signs (...,
        components) there. Mirrors: component 0 is odd across the far end and component 1 across the near one (x across
        x = 0, at the angle pi/2, and y across y = 0). Between walls component 0, along the line, is odd at both."""
        if self.ends in ("mirror", "walls"):
            low, high = index < 0, index >= count
            inside = np.where(low, -1 - index, np.where(high, 2 * count - 1 - index, index))
            odd = (high, low) if self.ends == "mirror" else (low | high, np.zeros_like(low))
            return inside, np.stack([1.0 - 2 * out for out in odd], axis=-1)
        return index % count, np.ones((*index.shape, 1))

    def _sum_rows(self, rows: np.ndarray, columns: np.ndarray, values: np.ndarray, row_count: int,
                  column_count: int) -> Rows:
        """Returns the map of a matrix given by its entries, with equal ones summed: ``rows`` and ``columns`` (...),
        ``values`` (..., maps)."""
        rows, columns = np.broadcast_arrays(rows, columns)
        tail = values.shape[rows.ndim:]
        rows, columns, values = rows.ravel(), columns.ravel(), values.reshape(rows.size, *tail)
        middle = ((np.arange(row_count) + 0.5) * column_count / row_count).astype(np.int64)
        offset = columns - middle[rows]
        if self.ends == "periodic":  # the shorter way around
            offset = (offset + column_count // 2) % column_count - column_count // 2
        low, high = np.full(row_count, column_count), np.full(row_count, -column_count)
        np.minimum.at(low, rows, offset)
        np.maximum.at(high, rows, offset)
        width = int((high - low).max()) + 1
        first = middle + low
        if self.ends != "periodic":
            first = np.minimum(first, column_count - width)
        weights = np.zeros((row_count, width, *tail))
        np.add.at(weights, (rows, offset + middle[rows] - first[rows]), values)
        return Rows((first % column_count).astype(np.int32), weights)
