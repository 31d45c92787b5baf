"""Particles whose position, velocity, stress or mass is not as that of the particles around them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from solvers.judging.checks.check import HOLDS, OFF, Check, unknown
from solvers.judging.checks.evidence import Evidence
from solvers.judging.checks.neighbours import MOST, Surroundings, outliers, surroundings
from solvers.judging.frames import Frame
from solvers.scene.scene import Scene

MOST_FRAMES = 24  # in which velocities and stresses are looked at, spread over all
LEAST_APART = 0.02  # of a cell; rims and crossings of sound runs of ours leave less on evenly laid particles
NAMES = {"x": "x of each particle against its neighbours'", "v": "v of each particle against its neighbours'",
         "sigma": "stress of each particle against its neighbours'"}
MASSES = "mass of each particle against its neighbours'"
#: Times what most depart, from where on a particle is by itself. Of runs of ours drawn at random x reached 8 (beyond
#: LEAST_APART), and what lasted a third of the frames 5 of v and 3.5 of the stress; what did not last 30 and 20.
TIMES = {"x": 12.0, "v": 8.0, "sigma": 4.5}
LEAST = {"v": 0.1, "sigma": 0.2}  # of the size of the quantity
LASTS, PASSES = 3, 6.0  # one frame in so many; times as much where it does not last: crossings of the grid pass
OTHER_MASS = 0.2  # of the usual mass
UNITS = {"x": "m", "v": "m/s", "sigma": "Pa"}


@dataclass(frozen=True)
class Apart:
    """Particles that are not where their neighbours are: ``which`` (n,) of a frame, and how far (n,) in m."""

    frame: Frame
    which: np.ndarray
    far: np.ndarray

    def to_dict(self, scene: Scene) -> dict:
        worst = int(np.argmax(self.far))
        X = self.frame.material_position[self.which]
        return {"t": self.frame.time, "file": self.frame.file, "count": len(self.which),
                "share": len(self.which) / len(self.frame.number), "farthest": float(self.far[worst]),
                "farthest_over_h": float(self.far[worst]) / scene.spacing,
                "particle": int(self.frame.number[self.which[worst]]), "X": X[worst].tolist(),
                "from": X.min(axis=0).tolist(), "to": X.max(axis=0).tolist()}


@dataclass(frozen=True)
class Alone:
    """What was found of a quantity: a frame with the particles that are by themselves, if any, the departure that comes
    nearest to the limit or is farthest beyond it, and that limit."""

    most: Apart | None
    largest: float
    limit: float


def of_places(evidence: Evidence) -> Alone | None:
    """Of x, in each frame by itself: the one in which most particles are. None of too few particles."""
    scene, found = evidence.scene, []
    for frame, error, near in _with_neighbours(evidence, "x", len(evidence.frames)):
        which, far, limit = outliers(near, error, TIMES["x"], LEAST_APART * scene.spacing)
        found.append((Apart(frame, which, far[which]), float(far.max()), limit))
    if not found:
        return None
    most = max((one for one, *_ in found), key=lambda one: len(one.which))
    _, largest, limit = max(found, key=lambda one: one[1] / one[2])
    return Alone(most if len(most.which) else None, largest, limit)


def of_values(evidence: Evidence, quantity: str) -> Alone | None:
    """Of v or the stress: particles that are by themselves for a third of the frames, or by far in one. None where the
    files do not have the quantity, or not always of the same particles."""
    least = LEAST[quantity] * evidence.scene.size_of(quantity)
    frames, parts, limits, first = [], [], [], None
    for frame, error, near in _with_neighbours(evidence, quantity, MOST_FRAMES):
        if first is not None and near is not first:
            return None
        first = near
        _, far, limit = outliers(near, error, TIMES[quantity], least)
        frames.append(frame)
        parts.append(far.astype(np.float32))
        limits.append(limit)
    if not frames:
        return None
    every_far, every_limit = np.array(parts), np.array(limits)
    score = every_far / every_limit[:, None]
    order = np.argsort(-score, axis=0)
    lasts = order[len(frames) // LASTS]  # a frame in which each particle is as far off as in a third of them
    every = np.arange(score.shape[1])
    lasting, passing = score[lasts, every], score[order[0], every] / PASSES
    at = np.where(lasting >= passing, lasts, order[0])
    worst = int(np.argmax(np.maximum(lasting, passing)))
    k, factor = int(at[worst]), 1.0 if lasting[worst] >= passing[worst] else PASSES
    which = np.flatnonzero(np.maximum(lasting, passing) > 1)
    return Alone(Apart(frames[k], which, every_far[k, which].astype(float)) if len(which) else None,
                 float(every_far[k, worst]), float(every_limit[k]) * factor)


def _with_neighbours(evidence: Evidence, quantity: str,
                     most: int) -> Iterator[tuple[Frame, np.ndarray, Surroundings]]:
    """Of so many frames at most their errors (P, C), with who is whose neighbour, looked for once where it stays."""
    pairs = [(f, e[quantity]) for f, e in zip(evidence.frames, evidence.errors, strict=True) if quantity in e]
    before: np.ndarray | None = None
    near: Surroundings | None = None
    for frame, error in pairs[::max(1, -(-len(pairs) // most))]:
        if before is None or not np.array_equal(before, frame.material_position):
            before, near = frame.material_position, surroundings(frame.material_position)
        if near is not None:
            yield frame, error.reshape(len(error), -1), near


def check(quantity: str, found: Alone | None) -> Check:
    if found is None:
        return unknown(NAMES[quantity], f"not of the same 5 to {MOST:,} particles at all times")
    if found.most is None:
        return Check(NAMES[quantity], found.largest, found.limit, UNITS[quantity], HOLDS)
    most = found.most
    worst = int(np.argmax(most.far))
    X = ", ".join(f"{c:.4g}" for c in most.frame.material_position[most.which[worst]])
    count, whose = len(most.which), {"x": "position", "v": "velocity", "sigma": "stress (or F)"}[quantity]
    return Check(NAMES[quantity], found.largest, found.limit, UNITS[quantity], OFF,
                 f"the {whose} of {count:,} particle{'s' * (count != 1)} is not as the neighbours', by up to "
                 f"{most.far[worst]:.3g} {UNITS[quantity]} at t = {most.frame.time:.4g} s: that of particle "
                 f"{int(most.frame.number[most.which[worst]])} at X = {X} the most")


def masses(frame: Frame) -> Check:
    if frame.mass is None:
        return unknown(MASSES, "no masses in the files; a wrong one shows in the motion alone, or not at all")
    near, usual = surroundings(frame.material_position), float(np.median(np.abs(frame.mass)))
    if near is None or not usual > 0:
        return unknown(MASSES, f"not of 5 to {MOST:,} particles at a time")
    which, far, limit = outliers(near, frame.mass[:, None], TIMES["x"], OTHER_MASS * usual)
    if not len(which):
        return Check(MASSES, float(far.max()) / usual, limit / usual, "of the usual mass", HOLDS)
    worst = which[np.argmax(far[which])]
    return Check(MASSES, float(far[worst]) / usual, limit / usual, "of the usual mass", OFF,
                 f"the mass of {len(which):,} particle{'s' * (len(which) != 1)} is not as the neighbours': that of "
                 f"particle {int(frame.number[worst])}, {frame.mass[worst]:.4g} kg, the most")
