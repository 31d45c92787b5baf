"""F against where neighbours stand: what parts two of them now, less what the mean of their F makes of what parted
them."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np

from solvers.checking.motion import TINY, Edges, Motion


@dataclass(frozen=True)
class Misses:
    """At a moment, of each pair of neighbours: ``now`` (n, D) what parts them, ``told`` (n, D) what F says it is, and
    ``size`` (n,) of the difference."""

    edges: Edges
    now: np.ndarray
    told: np.ndarray

    @functools.cached_property
    def miss(self) -> np.ndarray:
        return self.now - self.told

    @functools.cached_property
    def size(self) -> np.ndarray:
        return np.linalg.norm(self.miss, axis=1)

    @property
    def rms(self) -> float:
        return float(np.sqrt(np.mean(self.size**2)))

    @property
    def of_length(self) -> float:
        """RMS of the miss over the distance in the reference: as large as the error of F."""
        return float(np.sqrt(np.mean((self.size / self.edges.length) ** 2)))

    @property
    def worst(self) -> int:
        """The particle of the pair with the largest."""
        return int(self.edges.one[np.argmax(self.size)])


def misses(motion: Motion, moment: int, F: np.ndarray) -> Misses:
    """By the trapezoid rule between two neighbours, whose error is of third order in their distance."""
    edges, x = motion.edges, motion.x[moment]
    assert edges is not None
    mean = 0.5 * (F[edges.one] + F[edges.other])
    return Misses(edges, x[edges.other] - x[edges.one], np.einsum("nij,nj->ni", mean, edges.apart))


def strain(F: np.ndarray) -> float:
    """RMS of the parts of F - 1."""
    return float(np.sqrt(np.mean(np.sum((F - np.eye(F.shape[-1])) ** 2, axis=(-2, -1)))))


def gathered(edges: Edges, values: np.ndarray, count: int, rounds: int = 300) -> np.ndarray:
    """The field (P, D) whose differences between neighbours come nearest to ``values`` (n, D), by least squares, with
    mean 0: conjugate gradients, preconditioned by the numbers of neighbours."""
    one, other = edges.one, edges.other
    degree = np.maximum(np.bincount(one, minlength=count) + np.bincount(other, minlength=count), 1)[:, None]

    def spread(differences: np.ndarray) -> np.ndarray:
        return np.stack([np.bincount(other, d, count) - np.bincount(one, d, count) for d in differences.T], axis=1)

    left = spread(values)
    field, begin = np.zeros_like(left), float(np.sum(left**2))
    way = left / degree
    product = float(np.sum(left * way))
    for _ in range(rounds):
        if not np.sum(left**2) > 1e-6 * begin or not product > TINY:
            break
        bent = spread(way[other] - way[one])
        length = product / float(np.sum(way * bent))
        field, left = field + length * way, left - length * bent
        step = left / degree
        product, before = float(np.sum(left * step)), product
        way = step + product / before * way
    return field - field.mean(axis=0)
