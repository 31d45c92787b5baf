"""Particles that are by themselves, and fields that jump from each particle to the next."""

from __future__ import annotations

import numpy as np

from solvers.checking.finding import BROKEN, HOLDS, SUSPICIOUS, Finding, unknown
from solvers.checking.motion import Motion
from solvers.judging.checks.neighbours import departures, outliers

#: Of each quantity: times what most depart from a plane through their neighbours, from where on one is by itself, and
#: the least of that, of the spacing for x and of the quantity's own size for others.
ALONE: dict[str, tuple[float, float]] = {"x": (20.0, 0.2), "v": (20.0, 0.3), "F": (30.0, 0.6), "sigma": (30.0, 0.4)}
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
    found = []
    for moment in motion.moments:
        which, far, limit = outliers(near, every[moment].reshape(len(motion.reference), -1), times, least * size)
        found.append((float(far.max()) / limit, moment, which, far, limit))
    _, moment, which, far, limit = max(found, key=lambda one: (len(one[2]) > 0, one[0]))
    if not len(which):
        return Finding(name, HOLDS, float(far.max()), limit, UNITS[key])
    p = int(which[np.argmax(far[which])])
    return Finding(name, SUSPICIOUS, float(far[p]), limit, UNITS[key],
                   f"the {WORDS[key]} of {len(which):,} particle{'s' * (len(which) != 1)} is not as the neighbours', "
                   f"by up to {far[p]:.3g} {UNITS[key]} at t = {motion.times[moment]:.4g} s", **motion.at(moment, p))


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
