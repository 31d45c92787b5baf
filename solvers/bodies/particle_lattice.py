"""Particles of a body at rest: a lattice in the coordinates of each patch, which fills it."""

from typing import NamedTuple

import numpy as np

from solvers.bodies.body import Body
from solvers.bodies.spectral_mesh import Lattice


class ParticleLattice(NamedTuple):
    """P particles: ``position`` (P, 2) in m, ``edges`` (P, 4) of their parallelograms as (r1x, r1y, r2x, r2y) in m,
    ``volume`` (P,) in m^2, and the ``lattices`` on which they lie in this order, one for each patch."""

    position: np.ndarray
    edges: np.ndarray
    volume: np.ndarray
    lattices: list[Lattice]


def particle_lattice(body: Body, counts: np.ndarray) -> ParticleLattice:
    """Returns the particles with ``counts`` (K, 2) of them along xi and eta of each patch, in the middle of equal parts
    of the unit square. Edges are differences of the map over these parts."""
    positions, edges, lattices = [], [], []
    for k, (patch, (a, b)) in enumerate(zip(body.patches, counts, strict=True)):
        line, other = (np.arange(a) + 0.5) / a, (np.arange(b) + 0.5) / b
        xi, eta = (one.ravel() for one in np.meshgrid(line, other, indexing="ij"))
        positions.append(patch.place(xi, eta))
        edges.append(np.concatenate([patch.place(xi + 0.5 / a, eta) - patch.place(xi - 0.5 / a, eta),
                                     patch.place(xi, eta + 0.5 / b) - patch.place(xi, eta - 0.5 / b)], axis=1))
        lattices.append(Lattice(k, line, other))
    r = np.concatenate(edges)
    return ParticleLattice(np.concatenate(positions), r, r[:, 0] * r[:, 3] - r[:, 1] * r[:, 2], lattices)
