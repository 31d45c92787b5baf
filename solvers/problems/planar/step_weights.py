"""Weights of the last step as linear maps between particles and nodes, in numpy.

A node beyond a symmetry plane stands for its mirror image, with the component across the plane in odd sign; nothing
moves across a plane, and a node that the run has left out for its small mass carries nothing here either. Vectors of C
causes are (C, P, 2) at particles and (C, N, 2) at nodes.
"""

import numpy as np

from solvers.problems.planar.method.body import InstrumentedBody
from solvers.problems.planar.method.cpdi import NODES
from solvers.problems.planar.method.phases import EMPTY
from solvers.problems.planar.method.stored_weights import weights_by_particle
from solvers.problems.planar.particle_layout import CORNERS, half_edges
from solvers.scene.scene import Scene


class MirroredNodeGrid:
    """Nodes of a grid row by row, ``row`` in each, the first ``ghosts`` rows and columns beyond symmetry planes."""

    def __init__(self, row: int, ghosts: int, far: bool = False):
        """Creates the grid; ``far`` is whether there are planes at the upper ends of x and y too."""
        self.row, self.ghosts, self.nodes = row, ghosts, row * row
        self.last = row - 1 - ghosts if far else 2 * row
        on_plane = (np.arange(row) == ghosts) | (np.arange(row) == self.last) if ghosts else np.zeros(row, bool)
        free = np.ones((row, row, 2))
        free[:, on_plane, 0] = 0.0
        free[on_plane, :, 1] = 0.0
        self.free = free.reshape(-1, 2)  # 0 for what would move a node across a plane

    def resolve_images(self, nodes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Returns the nodes that ``nodes`` (...) mirror, or themselves, and signs (..., 2) of a vector's components."""
        ij = np.stack([nodes % self.row, nodes // self.row], axis=-1)
        home = np.abs(ij - self.ghosts) + self.ghosts
        home = np.where(home > self.last, 2 * self.last - home, home)
        return home[..., 1] * self.row + home[..., 0], np.where((ij < self.ghosts) | (ij > self.last), -1.0, 1.0)

    def sum_at_nodes(self, home: np.ndarray, values: np.ndarray) -> np.ndarray:
        """Returns sums at nodes (C, N, 2) of ``values`` (C, P, M, 2) of particles, whose nodes are ``home`` (P, M)."""
        out = np.empty((len(values), self.nodes, 2))
        index = home.ravel()
        for c, given in enumerate(values):
            for d in range(2):
                out[c, :, d] = np.bincount(index, given[:, :, d].ravel(), self.nodes)
        return out


class StepWeights:
    """Weights of a run's last step, which began with ``F`` (P, 2, 2), from the arrays ``a`` after it."""

    def __init__(self, scene: Scene, a: InstrumentedBody, F: np.ndarray, grid: MirroredNodeGrid):
        self.grid = grid
        self.node_numbers, signs = grid.resolve_images(particle_node_numbers(scene, a))
        S, dS = shape_function_values(scene, a, half_edges(scene, F, a.edges), np.arange(a.particles))
        self.particle_mass = a.mass
        self.S = S[:, :, None] * signs  # (P, M, 2), of a vector's components
        self.dS = dS[:, :, None, :] * signs[:, :, :, None]  # (P, M, 2, 2), component and direction
        mass = np.bincount(self.node_numbers.ravel(), (a.mass[:, None] * S).ravel(), grid.nodes)
        carries = mass > EMPTY * a.density * a.spacing**2
        self.per_mass = np.where(carries, 1 / np.where(carries, mass, 1.0), 0.0)[:, None] * grid.free

    def average_to_nodes(self, vectors: np.ndarray) -> np.ndarray:
        """Returns mass-weighted means at the nodes (C, N, 2) of the particles' ``vectors`` (C, P, 2)."""
        given = self.particle_mass[:, None, None] * self.S * vectors[:, :, None, :]
        return self.per_mass * self.grid.sum_at_nodes(self.node_numbers, given)

    def stress_acceleration(self, moments: np.ndarray) -> np.ndarray:
        """Returns nodal accelerations (C, N, 2) in m/s^2 from stresses times volumes (C, P, 2, 2), in N: -sum grad S
        over the mass."""
        given = np.stack([np.einsum("pmij,pij->pmi", self.dS, one) for one in moments])
        return -self.per_mass * self.grid.sum_at_nodes(self.node_numbers, given)

    def interpolate_to_particles(self, vectors: np.ndarray) -> np.ndarray:
        """Returns nodal ``vectors`` (C, N, 2) interpolated to the particles (C, P, 2)."""
        return np.stack([np.einsum("pmi,pmi->pi", self.S, one[self.node_numbers]) for one in vectors])

    def gradient(self, vectors: np.ndarray) -> np.ndarray:
        """Returns gradients (C, P, 2, 2), per m, of nodal ``vectors`` (C, N, 2) at particles: component, direction."""
        return np.stack([np.einsum("pmij,pmi->pij", self.dS, one[self.node_numbers]) for one in vectors])


def particle_node_numbers(scene: Scene, a: InstrumentedBody) -> np.ndarray:
    """Returns the numbers (P, M) of each particle's nodes in the last step, possibly repeated."""
    row = a.row
    if scene.method == "cpdi":
        first = weights_by_particle(a.weights, scene.method, a.particles)[:, NODES:NODES + 4].astype(int)
        return (first[:, :, None] + np.array([0, 1, row, row + 1])).reshape(a.particles, 16)
    return a.first_node[:, None] + (row * np.arange(3)[:, None] + np.arange(3)).ravel()


def shape_function_values(scene: Scene, a: InstrumentedBody, edges: np.ndarray,
                          some: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Returns S (c, M) and its gradient (c, M, 2) in 1/m at the nodes of the particles with the indices ``some`` (c,),
    whose domains have half edge vectors ``edges`` (P, 2, 2) in m."""
    kept = weights_by_particle(a.weights, scene.method, a.particles)[some]
    return _cpdi_weights(kept, edges[some]) if scene.method == "cpdi" else _gimp_weights(kept)


def _gimp_weights(kept: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Returns S (c, 9) and its gradient (c, 9, 2) in 1/m from stored numbers ``kept`` (c, 8)."""
    w = kept.reshape(-1, 4, 2)  # left, right and their slopes, each in x and y
    S = np.stack([w[:, 0], 1 - w[:, 0] - w[:, 1], w[:, 1]], axis=1)
    dS = np.stack([w[:, 2], -w[:, 2] - w[:, 3], w[:, 3]], axis=1)
    (x, y), (by_x, by_y) = np.moveaxis(S, 2, 0), np.moveaxis(dS, 2, 0)

    def product(along_y: np.ndarray, along_x: np.ndarray) -> np.ndarray:
        return np.einsum("pj,pi->pji", along_y, along_x).reshape(-1, 9)

    return product(y, x), np.stack([product(y, by_x), product(by_y, x)], axis=2)


def _cpdi_weights(kept: np.ndarray, edges: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Returns S = 1/4 sum N(corner) (c, 16) and its gradient (c, 16, 2) in 1/m, in which N at opposite corners have
    opposite signs, from stored numbers ``kept`` (c, 16) and half ``edges`` (c, 2, 2) in m."""
    x, y = kept[:, :4], kept[:, 4:8]
    N = np.stack([(1 - x) * (1 - y), x * (1 - y), (1 - x) * y, x * y], axis=2)  # (c, corner, node)
    # A linear f has f(corner) = f(x) + c_1 f'r_1 + c_2 f'r_2, and so grad f = inverse of the edges, times sum c f.
    along = np.einsum("ce,pcn->pecn", np.array(CORNERS), N)
    slope = np.einsum("pde,pecn->pcnd", np.linalg.inv(2 * edges), along)
    return 0.25 * N.reshape(-1, 16), slope.reshape(-1, 16, 2)
