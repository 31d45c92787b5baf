"""Particles that are not what their neighbours are: each held against a plane through the others around it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from solvers.judging.checks.nearby import Nearby

NEIGHBOURS = {1: 6, 2: 12, 3: 26}  # that a particle is held against, by dimensions
MOST = 200_000  # particles at a time: some 300 MB and a few seconds
ROUNDS = 40  # of taking the worst out, each of many particles at once
SUSPECT = 12.0  # times the usual departure, from where on a particle is not to spoil what is said of others
USUAL = 0.9  # of all particles depart less than what the last word is measured by
TINY = 1e-300


@dataclass(frozen=True)
class Surroundings:
    """Of P particles the nearest ``who`` (P, K), how they lie around each (P, K, 1 + D), with a first column of ones,
    whether they are ``there`` (P, K), and their ``weights`` (P, K) in the value here of a plane through theirs."""

    who: np.ndarray
    around: np.ndarray
    there: np.ndarray
    weights: np.ndarray


def surroundings(X: np.ndarray) -> Surroundings | None:
    """None of so few particles that nobody has neighbours, and of more than ``MOST``."""
    P, D = X.shape
    count = min(NEIGHBOURS[D], P - 1)
    if count < D + 2 or P > MOST:
        return None
    far, who = Nearby(X).nearest(X, count, skip_itself=True)
    there = np.isfinite(far)
    scale = np.where(there, far, 0.0).max(axis=1)
    away = (X[who] - X[:, None, :]) / np.maximum(scale, TINY)[:, None, None]
    around = np.concatenate([np.ones((P, count, 1)), away], axis=2)
    return Surroundings(who, around, there, _weights(around, there))


def departures(near: Surroundings, values: np.ndarray, which: np.ndarray | None = None,
               bad: np.ndarray | None = None) -> np.ndarray:
    """How far (n,) the values (P, C) of all particles, or of those ``which`` (n,), are from planes through those of
    their neighbours that are not ``bad`` (P,), over what a plane through noise leaves; 0 where too few are left."""
    at = slice(None) if which is None else which
    who, used, weights = near.who[at], near.there[at], near.weights[at]
    if bad is not None and (used & bad[who]).any():
        used = used & ~bad[who]
        weights = _weights(near.around[at], used)
    rest = values[at] - np.einsum("pk,pkc->pc", weights, values[who])
    far = np.sqrt(np.sum(rest**2, axis=1) / (1 + np.sum(weights**2, axis=1)))
    return np.where(used.sum(axis=1) >= near.around.shape[2] + 1, far, 0.0)


def _weights(around: np.ndarray, used: np.ndarray) -> np.ndarray:
    At = np.where(used[:, :, None], around, 0.0).transpose(0, 2, 1)
    return (np.linalg.pinv(At @ around, hermitian=True)[:, :1, :] @ At)[:, 0]


def outliers(near: Surroundings, values: np.ndarray, times: float,
             least: float) -> tuple[np.ndarray, np.ndarray, float]:
    """Which particles (n,) are by themselves, how far each (P,) is from the others, and from where on that counts: so
    many ``times`` what most depart, and ``least``.

    One that is far off spoils the planes of all around it: the worst of a neighbourhood is taken out first, and the
    others are held against those that remain.
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
