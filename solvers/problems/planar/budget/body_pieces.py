"""Pieces: the part of the body that each particle represents, without gaps or overlaps.

At rest a piece is the cell of the particles' lattice, cut off at the rims. In motion it is the quadrilateral between
the lattice's corners, each of which moves with the particles around it. The nodal forces of pieces with constant stress
are integrals of hat functions along their edges, which are exact: edges are cut where they leave a cell.
"""

import numpy as np

from solvers.problems.planar.particle_layout import particle_layout
from solvers.problems.planar.scene import PlanarScene
from solvers.problems.planar.step_weights import MirroredNodeGrid

GAUSS = 0.5 / np.sqrt(3.0)  # of two points, in lengths from the middle: exact for the hats' products along a line
CELL_CORNERS = ((0, 0), (1, 0), (1, 1), (0, 1))  # the corners of a lattice's cell, anticlockwise


class PieceLattice:
    """Corners (K) and edges (E) of the pieces of a scene's P particles, at rest: ``corner`` (P, 4) and ``edge`` (P, 4)
    of each piece, ``ends`` (E, 2), the corners of each edge, ``place`` (K, 2), the corners in m."""

    def __init__(self, scene: PlanarScene):
        X = particle_layout(scene).position
        if scene.layout == "polar":
            cell, place = _polar_cells(scene, X)
        else:
            side = scene.spacing / scene.ppc
            cell, place = np.floor(X / side).astype(np.int64), lambda corner: side * corner
        keys = cell[:, None, :] + np.array(CELL_CORNERS)
        corner_place = place(keys.astype(float))
        if scene.layout == "polar" and scene.ANGLE >= 2 * np.pi:  # the last row of corners is the first one again
            keys[:, :, 1] %= scene.lattice_counts(scene.cells, scene.ppc)[0]
        _, first, corner = np.unique(keys.reshape(-1, 2), axis=0, return_index=True, return_inverse=True)
        self.corner = corner.reshape(-1, 4)
        self.place = corner_place.reshape(-1, 2)[first]  # (K, 2)
        self.from_particle = self.place[self.corner] - X[:, None, :]  # (P, 4, 2)
        self.share = 1 / np.bincount(self.corner.ravel())[:, None]
        ends = np.stack([self.corner, np.roll(self.corner, -1, axis=1)], axis=2).reshape(-1, 2)
        self.ends, edge = np.unique(np.sort(ends, axis=1), axis=0, return_inverse=True)
        self.edge = edge.reshape(-1, 4)
        self.along = np.where(ends[:, 0] < ends[:, 1], 1.0, -1.0).reshape(-1, 4)  # or against the edge's direction
        # Corners on a symmetry plane stay there.
        planes = [end for end, there in zip((0.0, scene.SIDE), scene.PLANES, strict=True) if there]
        on_plane = [np.abs(self.place - end) < 1e-9 * scene.SIDE for end in planes]
        self.free = np.where(np.any(on_plane, axis=0), 0.0, 1.0) if planes else np.ones_like(self.place)

    def corners(self, displacement: np.ndarray, F: np.ndarray) -> np.ndarray:
        """Returns the corners' places (K, 2) in m at a ``displacement`` (P, 2) in m and F (P, 2, 2) of particles."""
        moves = displacement[:, None, :] + np.einsum("pij,pcj->pci", F - np.eye(2), self.from_particle)
        total = np.stack([np.bincount(self.corner.ravel(), moves[:, :, d].ravel()) for d in range(2)], axis=1)
        return self.place + self.free * self.share * total


class MovedBodyPieces:
    """Pieces of a ``lattice`` in motion, and their maps to the nodes of a grid. ``corners`` (K, 2) are where they are,
    in m; ``place`` has the same in cells from the first node."""

    def __init__(self, lattice: PieceLattice, corners: np.ndarray, grid: MirroredNodeGrid, place: np.ndarray):
        self.lattice, self.grid = lattice, grid
        a, b = (corners[lattice.ends[:, k]] for k in range(2))
        self.normal = np.stack([(b - a)[:, 1], (a - b)[:, 0]], axis=1)  # times the edge's length
        nodes, self.weight = _mean_hats(place[lattice.ends[:, 0]], place[lattice.ends[:, 1]], grid.row)
        self.node_numbers, self.signs = grid.resolve_images(nodes)
        x, y = np.moveaxis(corners[lattice.corner], 2, 0)
        self.area = 0.5 * np.sum(x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1), axis=1)

    def nodal_force(self, stress: np.ndarray) -> np.ndarray:
        """Returns nodal forces (N, 2) in N per m of thickness of a ``stress`` (P, 2, 2) in Pa, constant per piece."""
        jump = np.zeros_like(self.normal)
        for k in range(4):
            edge = self.lattice.edge[:, k]
            pull = self.lattice.along[:, k, None] * np.einsum("pij,pj->pi", stress, self.normal[edge])
            for d in range(2):
                jump[:, d] += np.bincount(edge, pull[:, d], len(jump))
        given = self.weight[:, :, None] * self.signs * jump[:, None, :]
        return -self.grid.sum_at_nodes(self.node_numbers, given[None])[0]

    def gradient(self, vectors: np.ndarray) -> np.ndarray:
        """Returns means over each piece (P, 2, 2), per m, of the gradient of nodal ``vectors`` (N, 2)."""
        on_edge = np.einsum("em,emi->ei", self.weight, self.signs * vectors[self.node_numbers])
        through = self.lattice.along[:, :, None, None] \
            * (on_edge[:, :, None] * self.normal[:, None, :])[self.lattice.edge]
        return through.sum(axis=1) / self.area[:, None, None]


def _mean_hats(a: np.ndarray, b: np.ndarray, row: int) -> tuple[np.ndarray, np.ndarray]:
    """Returns nodes (E, M) near edges from a to b (E, 2), in cells, and the mean (E, M) of their hats along the edge;
    ``row`` is the number of nodes in a row."""
    low, high = np.minimum(a, b), np.maximum(a, b)
    most = max(0, int(np.max(np.ceil(high) - np.floor(low))) - 1)  # lines that an edge crosses in one direction
    lines = np.floor(low)[:, :, None] + 1 + np.arange(most)
    with np.errstate(divide="ignore", invalid="ignore"):
        cuts = np.where(lines < high[:, :, None], (lines - a[:, :, None]) / (b - a)[:, :, None], 1.0)
    ends = np.zeros((len(a), 1))
    cuts = np.sort(np.concatenate([ends, cuts.reshape(len(a), -1), ends + 1], axis=1), axis=1)
    middle, length = 0.5 * (cuts[:, 1:] + cuts[:, :-1]), np.diff(cuts, axis=1)
    t = np.concatenate([middle - GAUSS * length, middle + GAUSS * length], axis=1)
    part = 0.5 * np.concatenate([length, length], axis=1)
    x = a[:, None, :] + t[:, :, None] * (b - a)[:, None, :]
    cell = np.clip(np.floor(x), 0, row - 2)
    right, above = np.moveaxis(x - cell, 2, 0)
    hats = np.stack([(1 - right) * (1 - above), right * (1 - above), (1 - right) * above, right * above], axis=2)
    nodes = (cell[:, :, 1] * row + cell[:, :, 0]).astype(np.int64)[:, :, None] + np.array([0, 1, row, row + 1])
    return nodes.reshape(len(a), -1), (part[:, :, None] * hats).reshape(len(a), -1)


def _polar_cells(scene: PlanarScene, X: np.ndarray):
    """Returns the polar cell (P, 2), in radius and angle, of particles at X (P, 2), and a function from the indices of
    corners (..., 2) to places in m."""
    around, across = scene.lattice_counts(scene.cells, scene.ppc)
    width, angle = (scene.OUTER - scene.INNER) / across, scene.ANGLE / around
    theta = np.arctan2(X[:, 1], X[:, 0]) % (2 * np.pi)
    cell = np.floor(np.stack([(np.hypot(X[:, 0], X[:, 1]) - scene.INNER) / width, theta / angle], axis=1))

    def place(corner: np.ndarray) -> np.ndarray:
        R = scene.INNER + corner[..., 0] * width
        return np.stack([R * np.cos(corner[..., 1] * angle), R * np.sin(corner[..., 1] * angle)], axis=-1)

    return cell.astype(np.int64), place
