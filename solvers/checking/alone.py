"""Particles that are by themselves, and fields that jump from each particle to the next."""

from __future__ import annotations

import numpy as np

from solvers.checking.finding import BROKEN, HOLDS, SUSPICIOUS, Finding, unknown
from solvers.checking.motion import Motion
from solvers.judging.checks.neighbours import USUAL, Surroundings, departures, outliers

#: Of each quantity: times what most depart from a plane through their neighbours, from where on one is by itself, and
#: the least of that, of the spacing for x and of the quantity's own size for others.
ALONE: dict[str, tuple[float, float]] = {"x": (30.0, 0.5), "v": (15.0, 0.3), "F": (30.0, 1.0), "sigma": (15.0, 0.4)}
LASTS, PASSES = 3, 10.0  # one moment in so many, but for x; times as much where it does not last
A_PLACE, NOISE = 1.6, 6.0  # of the spacing, and times what most depart
ONE_SIDED, ON_A_RIM = 0.4, 3.0  # of their distance the middle of the neighbours is aside; times as much may be there
WORDS = {"x": "position", "v": "velocity", "F": "F", "sigma": "stress"}
UNITS = {"x": "m", "v": "m/s", "F": "", "sigma": "Pa"}
ROUGH, ROUGHEST = 0.5, 1.0  # of the size of v or the stress: what it departs from its neighbours', RMS
FEW = "not of 16 particles and more"
FEWEST = 16
SMOOTH_START = 0.3  # of the size: a field that is rougher at the start already is none that runs get wrong


def check(motion: Motion, key: str) -> Finding:
    """Each particle held against a plane through those around it, without others that are far off."""
    name = f"{key} of each particle against its neighbours'"
    if key not in motion.fields:
        return unknown(name, f"no {key} in the files (or not always a number)")
    near = motion.near
    if near is None or len(motion.reference) < FEWEST:
        return unknown(name, FEW)
    times, least = ALONE[key]
    every = motion.fields[key] - (motion.reference if key == "x" else 0.0)
    size = motion.spacing if key == "x" else _size(motion, key)
    if not size > 0:
        return unknown(name, "it is zero everywhere")
    scores, limits = [], []
    for moment in motion.moments:
        _, far, limit = outliers(near, every[moment].reshape(len(motion.reference), -1), times, least * size)
        if key == "x":  # bent as it may be, a whole place aside is no bend, but where most are so
            limit = min(limit, max(A_PLACE * size, NOISE * float(np.quantile(far, USUAL))))
        scores.append(far / limit)
        limits.append(limit)
    score = np.array(scores) / np.where(_rim(near, motion.reference), ON_A_RIM, 1.0)
    order = np.argsort(-score, axis=0)  # what goes with the crossing of a cell passes; places do not
    lasts, particles = order[0 if key == "x" else len(scores) // LASTS], np.arange(score.shape[1])
    lasting, passing = score[lasts, particles], score[order[0], particles] / PASSES
    at, beyond = np.where(lasting >= passing, lasts, order[0]), np.maximum(lasting, passing)
    p, count = int(np.argmax(beyond)), int(np.sum(beyond > 1))
    k = int(at[p])
    moment, far_off, limit = motion.moments[k], float(scores[k][p]) * limits[k], limits[k]
    if not count:
        return Finding(name, HOLDS, far_off, max(limit, far_off), UNITS[key])
    return Finding(name, SUSPICIOUS, far_off, limit, UNITS[key],
                   f"the {WORDS[key]} of {count:,} particle{'s' * (count != 1)} is not as the neighbours', "
                   f"by up to {far_off:.3g} {UNITS[key]} at t = {motion.times[moment]:.4g} s", **motion.at(moment, p))


def _rim(near: Surroundings, reference: np.ndarray) -> np.ndarray:
    """Which particles (P,) have their neighbours on one side, so that the plane goes on beyond them."""
    away = np.where(near.there[:, :, None], reference[near.who] - reference[:, None], 0.0)
    return np.linalg.norm(away.mean(axis=1), axis=1) > ONE_SIDED * np.linalg.norm(away, axis=2).mean(axis=1)


def rough(motion: Motion, key: str) -> Finding:
    """How much v or the stress jumps from one particle to the next, beside its own size, where it was smooth before."""
    name = f"{key} is smooth from particle to particle"
    near = motion.near
    if key not in motion.fields or near is None or len(motion.reference) < FEWEST:
        return unknown(name, f"no {key} in the files" if key not in motion.fields else FEW)
    size = _size(motion, key)
    if not size > 0:
        return unknown(name, "it is zero everywhere")
    every = [departures(near, motion.fields[key][moment].reshape(len(motion.reference), -1))
             for moment in motion.moments]
    shares = [float(np.sqrt(np.mean(far**2))) / size for far in every]
    k = int(np.argmax(shares))
    moment, p = motion.moments[k], int(np.argmax(every[k]))
    if shares[0] > SMOOTH_START:
        return unknown(name, f"it jumps by {shares[0]:.2g} of its size at the first moment already")
    if shares[k] <= ROUGH:
        return Finding(name, HOLDS, shares[k], ROUGH, "of its size")
    return Finding(name, BROKEN if shares[k] > ROUGHEST else SUSPICIOUS, shares[k], ROUGH, "of its size",
                   f"the {WORDS[key]} jumps from particle to particle by {shares[k]:.2g} of its size at t = "
                   f"{motion.times[moment]:.4g} s, and by {shares[0]:.2g} at first", **motion.at(moment, p))


def _size(motion: Motion, key: str) -> float:
    """The largest RMS of a quantity, of F of F - 1."""
    values = motion.fields[key] - (np.eye(motion.dimensions) if key == "F" else 0.0)
    return float(np.sqrt(np.max(np.mean(np.sum(values.reshape(*values.shape[:2], -1) ** 2, axis=2), axis=1))))
