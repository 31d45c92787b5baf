"""Search for neighbours, and for particles that differ from those around them."""

import itertools
from dataclasses import dataclass

import numpy as np

IN_A_BIN = 3.0  # points, about: nine bins of the plane then hold some thirty
MOST_IN_A_BIN = 64  # points of one bin that are evaluated
MOST_ASKED = 50_000  # points that represent a larger number
AT_ONCE = 2_000_000  # candidates per batch
NEIGHBOURS = {1: 6, 2: 12, 3: 26}  # that a particle is compared with, by dimensions
MOST = 200_000  # particles at a time: some 300 MB and a few seconds
ROUNDS = 40  # of removing the worst, each of many particles at once
SUSPECT = 12.0  # times the usual departure, from which on a particle is excluded for others
USUAL = 0.9  # of all particles depart less than what the last word is measured by
ONE_SIDED, ON_A_RIM = 0.4, 3.0  # of their distance the middle of the neighbours is aside; times as much may be there
TINY = 1e-300


class NeighbourSearch:
    """Search for the nearest of ``points`` (P, D), in m, within at least ``width``, the side of its bins."""

    def __init__(self, points: np.ndarray, width: float | None = None):
        self._points, D = points, points.shape[1]
        self._corner = points.min(axis=0)
        if not width:  # ``IN_A_BIN`` points are in a bin where there are any at all: a ring is empty in the middle
            width = (float(np.ptp(points, axis=0).max()) or 1.0) / max(1.0, len(points) ** (1 / D))
            used = len(np.unique(((points - self._corner) / width).astype(int), axis=0))
            width *= (IN_A_BIN * used / len(points)) ** (1 / D)
        self.width = width
        own = self._bin_of(points)
        self._shape = own.max(axis=0) + 3  # an empty bin on every side
        number = self._bin_number(own)
        self._order = np.argsort(number, kind="stable")
        self._number_of = number[self._order]
        self._offsets = np.array(list(itertools.product((-1, 0, 1), repeat=D)))

    def nearest(self, asked: np.ndarray, count: int, skip_itself: bool = False) -> tuple[np.ndarray, np.ndarray]:
        """Returns increasing distances (n, count) of the nearest points to ``asked`` (n, D), and their indices;
        infinite where the bins around have fewer. ``skip_itself`` if ``asked`` are the points themselves."""
        most = min(MOST_IN_A_BIN, int(np.unique(self._number_of, return_counts=True)[1].max()))
        step = max(1, AT_ONCE // (most * len(self._offsets)))
        parts = [self._nearest_in_batch(asked[k:k + step], count, k if skip_itself else None, most)
                 for k in range(0, len(asked), step)]
        return np.concatenate([far for far, _ in parts]), np.concatenate([who for _, who in parts])

    def nearest_distances(self, asked: np.ndarray) -> np.ndarray:
        """Returns distances (n,) to the nearest point from at most ``MOST_ASKED`` of ``asked``, evenly chosen."""
        return self.nearest(asked[::-(-len(asked) // MOST_ASKED)], 1)[0][:, 0]

    def _nearest_in_batch(self, asked: np.ndarray, count: int, first: int | None,
                          most: int) -> tuple[np.ndarray, np.ndarray]:
        around = self._bin_of(asked)[:, None, :] + self._offsets
        inside = ((around >= -1) & (around < self._shape - 1)).all(axis=2)
        number = np.where(inside, self._bin_number(np.where(inside[..., None], around, 0)), -1)
        slot = np.searchsorted(self._number_of, number)[:, :, None] + np.arange(most)
        there = np.minimum(slot, len(self._order) - 1)
        there_is = (slot < len(self._order)) & (self._number_of[there] == number[:, :, None])
        who = self._order[there].reshape(len(asked), -1)
        far = np.linalg.norm(self._points[who] - asked[:, None, :], axis=2)
        far[~there_is.reshape(len(asked), -1)] = np.inf
        if first is not None:
            far[who == np.arange(first, first + len(asked))[:, None]] = np.inf
        if far.shape[1] < count:
            far = np.pad(far, ((0, 0), (0, count - far.shape[1])), constant_values=np.inf)
            who = np.pad(who, ((0, 0), (0, count - who.shape[1])))
        chosen = np.argsort(far, axis=1, kind="stable")[:, :count]
        return np.take_along_axis(far, chosen, 1), np.take_along_axis(who, chosen, 1)

    def _bin_of(self, points: np.ndarray) -> np.ndarray:
        return np.clip(np.floor((points - self._corner) / self.width), -10, 2**31 // 4).astype(int)

    def _bin_number(self, bins: np.ndarray) -> np.ndarray:
        number = np.zeros(bins.shape[:-1], int)
        for k in range(bins.shape[-1]):
            number = number * int(self._shape[k]) + bins[..., k] + 1
        return number


@dataclass(frozen=True)
class NearestNeighbours:
    """Nearest neighbours of P particles: indices ``who`` (P, K), relative positions ``around`` (P, K, 1 + D) over the
    farthest's distance, with a first column of ones, whether each is ``there`` (P, K), and ``weights`` (P, K) with
    which their values give that of a fitted plane at the particle."""

    who: np.ndarray
    around: np.ndarray
    there: np.ndarray
    weights: np.ndarray


def find_neighbours(X: np.ndarray) -> NearestNeighbours | None:
    """Returns the neighbourhoods of particles at X (P, D) in m; None for too few particles, or more than ``MOST``."""
    P, D = X.shape
    count = min(NEIGHBOURS[D], P - 1)
    if count < D + 2 or P > MOST:
        return None
    far, who = NeighbourSearch(X).nearest(X, count, skip_itself=True)
    there = np.isfinite(far)
    scale = np.where(there, far, 0.0).max(axis=1)
    away = (X[who] - X[:, None, :]) / np.maximum(scale, TINY)[:, None, None]
    around = np.concatenate([np.ones((P, count, 1)), away], axis=2)
    return NearestNeighbours(who, around, there, _plane_weights(around, there))


def departures(near: NearestNeighbours, values: np.ndarray, which: np.ndarray | None = None,
               bad: np.ndarray | None = None) -> np.ndarray:
    """Returns the distances (n,) of values (P, C), of all particles or ``which`` (n,), from planes through those of
    their neighbours that are not ``bad`` (P,), scaled so that noise keeps its size; 0 where too few are left."""
    at = slice(None) if which is None else which
    who, used, weights = near.who[at], near.there[at], near.weights[at]
    if bad is not None and (used & bad[who]).any():
        used = used & ~bad[who]
        weights = _plane_weights(near.around[at], used)
    rest = values[at] - np.einsum("pk,pkc->pc", weights, values[who])
    far = np.sqrt(np.sum(rest**2, axis=1) / (1 + np.sum(weights**2, axis=1)))
    return np.where(used.sum(axis=1) >= near.around.shape[2] + 1, far, 0.0)


def allowance_at_rims(near: NearestNeighbours) -> np.ndarray:
    """Returns the factor (P,) by which a particle may depart more than others from the plane through its neighbours:
    where these are all on one side the plane goes on beyond them."""
    away = np.where(near.there[:, :, None], near.around[:, :, 1:], 0.0)
    rim = np.linalg.norm(away.mean(axis=1), axis=1) > ONE_SIDED * np.linalg.norm(away, axis=2).mean(axis=1)
    return np.where(rim, ON_A_RIM, 1.0)


def _plane_weights(around: np.ndarray, used: np.ndarray) -> np.ndarray:
    """Returns the weights (P, K) with which the ``used`` neighbours' values give that of a plane at a particle."""
    At = np.where(used[:, :, None], around, 0.0).transpose(0, 2, 1)
    return (np.linalg.pinv(At @ around, hermitian=True)[:, :1, :] @ At)[:, 0]


def find_outliers(near: NearestNeighbours, values: np.ndarray, times: float,
                  least: float) -> tuple[np.ndarray, np.ndarray, float]:
    """Returns the indices (n,) of outliers, the departure (P,) of each particle's values (P, C) from the others', and
    the limit: ``times`` the usual departure, at least ``least``, in the values' unit.

    A far outlier distorts the planes of all particles around it: the worst of a neighbourhood is removed first, and the
    others are compared with those that remain.
    """
    bad = np.zeros(len(values), bool)
    far = departures(near, values)
    limit = max(SUSPECT * float(np.median(far)), 0.5 * least)
    for _ in range(ROUNDS):
        suspects = np.flatnonzero((far > limit) & ~bad)
        if not len(suspects):
            break
        rivals = np.where(near.there[suspects] & ~bad[near.who[suspects]], far[near.who[suspects]], 0.0).max(axis=1)
        bad[suspects[far[suspects] >= rivals]] = True
        again = np.flatnonzero((far > limit) & (near.there & bad[near.who]).any(axis=1) & ~bad)
        far[again] = departures(near, values, again, bad)
    far = departures(near, values, None, bad)
    limit = max(times * float(np.quantile(far, USUAL)), least)
    return np.flatnonzero(bad & (far > limit)), far, limit
