"""Particles whose position, velocity, F, stress or mass differs from those around them: by the error against a
problem's solution, whose limits are fine, or by the quantity itself, which may vary; and rough fields."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from solvers.judging.findings import neighbour_comparison
from solvers.judging.findings.finding import BROKEN, HOLDS, OFF, SUSPICIOUS, Finding, unknown
from solvers.judging.findings.findings_input import FindingsInput
from solvers.judging.findings.neighbour_comparison import (
    MOST,
    USUAL,
    NearestNeighbours,
    NeighbourSearch,
    allowance_at_rims,
    find_neighbours,
    find_outliers,
)
from solvers.judging.findings.recorded_motion_reader import ROUNDED, RecordedMotion
from solvers.judging.findings.time_series_fitting import largest_rms
from solvers.judging.particle_data_types import Frame
from solvers.scene.scene import Scene
from solvers.translatable_message import Message

MOST_FRAMES = 24  # in which velocities and stresses are checked, evenly spread
LEAST_APART = 0.02  # of a cell; rims and crossings of sound runs of ours leave less on evenly laid particles
NAMES = {"x": "x of each particle against its neighbours'", "v": "v of each particle against its neighbours'",
         "sigma": "stress of each particle against its neighbours'"}
NAMES_OF_WEIGHTS = {"mass": "mass of each particle against its neighbours'",
                    "volume": "volume of each particle against its neighbours'"}
#: Times what most depart, from where on a particle is by itself. Of runs of ours drawn at random x reached 8 (beyond
#: LEAST_APART), and what lasted a third of the frames 5 of v and 3.5 of the stress; what did not last 30 and 20.
TIMES = {"x": 12.0, "v": 8.0, "sigma": 4.5}
LEAST = {"v": 0.1, "sigma": 0.2}  # of the size of the quantity
LASTS = 3  # one moment in so many
SAME_PLACE, ALIKE = 1e-3, 1e-2  # of the distance of particles, about; of a departure
PASSES = 6.0  # times as much where it does not last: crossings of the grid pass
OTHER_WEIGHT, OF_USUAL = 0.2, "of the usual one"
UNITS = {"x": "m", "v": "m/s", "F": "", "sigma": "Pa"}
#: Of a quantity itself: times what most depart, from where on one is by itself, and the least of that, of the spacing
#: for x and of the quantity's own size for others.
ALONE: dict[str, tuple[float, float]] = {"x": (30.0, 0.5), "v": (15.0, 0.3), "F": (30.0, 1.0), "sigma": (15.0, 0.4)}
NAMES_OF_MOTION = {key: f"{key} of each particle against its neighbours'" for key in ALONE}
SOON_PASSES = 10.0  # times as much where that does not last
A_PLACE, NOISE = 1.6, 6.0  # of the spacing, and times what most depart
WORDS = {"x": "position", "v": "velocity", "F": "F", "sigma": "stress"}
ROUGH, ROUGHEST = 0.5, 1.0  # of the size of v or the stress: what it departs from its neighbours', RMS
FEWEST = 16  # particles
SMOOTH_START = 0.3  # of the size: a field that is rougher at the start already is none that runs get wrong


@dataclass(frozen=True)
class FrameOutliers:
    """Particles unlike their neighbours: indices ``which`` (n,) in a frame, how ``far`` (n,), m for positions."""

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
class OutlierSummary:
    """Outliers of a quantity: the frame with the ``most``, if any, the departure closest to the limit or farthest
    beyond it, and that limit, both in the quantity's unit."""

    most: FrameOutliers | None
    largest: float
    limit: float


def position_outliers(evidence: FindingsInput) -> OutlierSummary | None:
    """Returns the outliers of x, found in each frame alone, in the frame with the most. None for too few particles."""
    found, least = [], LEAST_APART * evidence.scene.spacing + ROUNDED * evidence.stored_rounding["x"]
    for frame, error, near in _with_neighbours(evidence, "x", len(evidence.frames)):
        which, far, limit = find_outliers(near, error, TIMES["x"], least)
        beyond = far / allowance_at_rims(near)
        which = which[beyond[which] > limit]
        found.append((FrameOutliers(frame, which, far[which]), float(beyond.max()), limit))
    if not found:
        return None
    most = max((one for one, *_ in found), key=lambda one: len(one.which))
    _, largest, limit = max(found, key=lambda one: one[1] / one[2])
    return OutlierSummary(most if len(most.which) else None, largest, limit)


def value_outliers(evidence: FindingsInput, quantity: str) -> OutlierSummary | None:
    """Returns the outliers of v or the stress: particles that are outliers in a third of the frames, or by far in one.
    None where the files do not have the quantity, or not always of the same particles."""
    least = (LEAST[quantity] * evidence.scene.size_of(quantity)
             + ROUNDED * evidence.stored_rounding.get(quantity, 0.0))  # there may be F alone
    frames, parts, limits, first = [], [], [], None
    for frame, error, near in _with_neighbours(evidence, quantity, MOST_FRAMES):
        if first is not None and near is not first:
            return None
        first = near
        _, far, limit = find_outliers(near, error, TIMES[quantity], least)
        frames.append(frame)
        parts.append(far.astype(np.float32))
        limits.append(limit)
    if first is None:
        return None
    every_far, every_limit = np.array(parts), np.array(limits)
    rim = allowance_at_rims(first)
    at, beyond, factor = _lasting_outliers(every_far / every_limit[:, None] / rim, len(frames) // LASTS, PASSES)
    factor = factor * rim
    which = _without_twins(frames[0], np.flatnonzero(beyond > 1), beyond)
    worst = int(which[np.argmax(beyond[which])] if len(which) else np.argmax(np.minimum(beyond, 1)))
    k = int(at[worst])
    return OutlierSummary(FrameOutliers(frames[k], which, every_far[k, which].astype(float)) if len(which) else None,
                          float(every_far[k, worst]), float(every_limit[k]) * float(factor[worst]))


def _without_twins(frame: Frame, which: np.ndarray, beyond: np.ndarray) -> np.ndarray:
    """Returns the outliers ``which`` (n,) of a frame that have no twin: another particle opposite to the centre, or
    across the diagonal, which is ``beyond`` (P,) as far. There methods err alike, as at rims; files do not."""
    X, twin = frame.material_position, np.zeros(len(which), bool)
    if not len(which):
        return which
    search, centre = NeighbourSearch(X), 0.5 * (X.min(axis=0) + X.max(axis=0))
    for image in (2 * centre - X[which], X[which][:, ::-1]):
        apart, who = (found[:, 0] for found in search.nearest(image, 1))
        alike = np.abs(beyond[who] - beyond[which]) <= ALIKE * beyond[which]
        twin |= (apart < SAME_PLACE * search.width) & (who != which) & alike
    return which[~twin]


def _lasting_outliers(score: np.ndarray, longer: int, passes: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Returns for scores (T, P) by how much each particle exceeds 1 at over ``longer`` times, or by a factor ``passes``
    at any; the time index that shows it, and that factor, 1 where it lasts: (P,) each. Cell crossings do not last."""
    order, every = np.argsort(-score, axis=0), np.arange(score.shape[1])
    lasting, passing = score[order[longer], every], score[order[0], every] / passes
    lasts = lasting >= passing
    return np.where(lasts, order[longer], order[0]), np.maximum(lasting, passing), np.where(lasts, 1.0, passes)


def _with_neighbours(evidence: FindingsInput, quantity: str,
                     most: int) -> Iterator[tuple[Frame, np.ndarray, NearestNeighbours]]:
    """Yields at most ``most`` frames with their errors (P, C) and neighbourhoods, computed once if constant."""
    pairs = [(f, e[quantity]) for f, e in zip(evidence.frames, evidence.errors, strict=True) if quantity in e]
    before: np.ndarray | None = None
    near: NearestNeighbours | None = None
    for frame, error in pairs[::max(1, -(-len(pairs) // most))]:
        if before is None or not np.array_equal(before, frame.material_position):
            before, near = frame.material_position, find_neighbours(frame.material_position)
        if near is not None:
            yield frame, error.reshape(len(error), -1), near


def outliers_finding(quantity: str, outliers: OutlierSummary | None) -> Finding:
    """Returns the finding on the outliers of x, v or sigma, or on None that they are unknown."""
    if outliers is None:
        return unknown(NAMES[quantity], f"not of the same 5 to {MOST:,} particles at all times")
    if outliers.most is None:
        return Finding(NAMES[quantity], HOLDS, outliers.largest, outliers.limit, UNITS[quantity])
    most = outliers.most
    worst = int(np.argmax(most.far))
    X = ", ".join(f"{c:.4g}" for c in most.frame.material_position[most.which[worst]])
    whose = {"x": Message("position"), "v": Message("velocity"), "sigma": Message("stress (or F)")}[quantity]
    return Finding(NAMES[quantity], OFF, outliers.largest, outliers.limit, UNITS[quantity],
                   Message("the {whose} of {count:,} particle{plural} differs from the neighbours by up to {far:.3g} "
                           "{quantity} at t = {time:.4g} s, most at particle {number} at X = {x}", whose,
                           len(most.which), "s" * (len(most.which) != 1), most.far[worst], UNITS[quantity],
                           most.frame.time, int(most.frame.number[most.which[worst]]), X))


def check_weights(frame: Frame, key: str) -> Finding:
    """Checks each particle's mass or volume, by its ``key``, in a frame against a plane through its neighbours'."""
    values, name = {"mass": frame.mass, "volume": frame.volume}[key], NAMES_OF_WEIGHTS[key]
    if values is None:
        return unknown(name, f"no {key} in the files; a wrong one shows in the motion alone, or not at all")
    near, usual = find_neighbours(frame.material_position), float(np.median(np.abs(values)))
    if near is None or not usual > 0:
        return unknown(name, f"not of 5 to {MOST:,} particles at a time")
    which, far, limit = find_outliers(near, values[:, None], TIMES["x"], OTHER_WEIGHT * usual)
    if not len(which):
        return Finding(name, HOLDS, float(far.max()) / usual, limit / usual, OF_USUAL)
    worst = which[np.argmax(far[which])]
    return Finding(name, OFF, float(far[worst]) / usual, limit / usual, OF_USUAL,
                   Message("the {weight} of {count:,} particle{plural} differs from the neighbours, most that of "
                           "particle {number} ({share:.3g} of the usual {weight})",
                           weight=Message("mass") if key == "mass" else Message("volume"), count=len(which),
                           plural="s" * (len(which) != 1), number=int(frame.number[worst]),
                           share=values[worst] / usual))


def check_outliers(motion: RecordedMotion, key: str) -> Finding:
    """Checks each particle's x, v, F or sigma against a plane through those around it, without other outliers."""
    name, near = NAMES_OF_MOTION[key], motion.neighbourhood
    if near is None or len(motion.reference) < FEWEST:
        return unknown(name, f"not of {FEWEST} particles and more")
    times, least = ALONE[key]
    every = motion.fields[key] - (motion.reference if key == "x" else 0.0)
    size = motion.spacing if key == "x" else _largest_rms(motion, key)
    if not size > 0:
        return unknown(name, "it is zero everywhere, or rounding")
    scores, limits = [], []
    rounding = ROUNDED * motion.stored_rounding[key]
    for moment in motion.checked_time_indices:
        _, far, limit = find_outliers(near, every[moment].reshape(len(motion.reference), -1), times,
                                      least * size + rounding)
        if key == "x":  # bent as it may be, a whole place aside is no bend, but where most are so
            limit = min(limit, max(A_PLACE * size + rounding, NOISE * float(np.quantile(far, USUAL))))
        scores.append(far / limit)
        limits.append(limit)
    score = np.array(scores) / allowance_at_rims(near)
    at, beyond, _ = _lasting_outliers(score, 0 if key == "x" else len(scores) // LASTS,
                                      SOON_PASSES)  # places do not pass
    p, count = int(np.argmax(beyond)), int(np.sum(beyond > 1))
    k = int(at[p])
    moment, far_off, limit = motion.checked_time_indices[k], float(scores[k][p]) * limits[k], limits[k]
    if not count:
        return Finding(name, HOLDS, far_off, max(limit, far_off), UNITS[key])
    return Finding(name, SUSPICIOUS, far_off, limit, UNITS[key],
                   f"the {WORDS[key]} of {count:,} particle{'s' * (count != 1)} differs from the neighbours "
                   f"by up to {far_off:.3g} {UNITS[key]} at t = {motion.times[moment]:.4g} s",
                   **motion.finding_location(moment, p))


def check_roughness(motion: RecordedMotion, key: str) -> Finding:
    """Checks how much v or sigma jumps between neighbouring particles, relative to its size, if smooth at first."""
    name = f"{key} is smooth from particle to particle"
    near = motion.neighbourhood
    if key not in motion.fields or near is None or len(motion.reference) < FEWEST:
        return unknown(name, f"no {key} in the files" if key not in motion.fields
                       else f"not of {FEWEST} particles and more")
    size, rounding = _largest_rms(motion, key), ROUNDED * motion.stored_rounding[key]
    if not size > rounding:
        return unknown(name, "it is zero everywhere, or rounding")
    every = [neighbour_comparison.departures(near, motion.fields[key][moment].reshape(len(motion.reference), -1))
             for moment in motion.checked_time_indices]
    shares = [float(np.sqrt(np.mean(far**2))) / size for far in every]
    k = int(np.argmax(shares))
    moment, p = motion.checked_time_indices[k], int(np.argmax(every[k]))
    if shares[0] > SMOOTH_START:
        return unknown(name, f"it jumps by {shares[0]:.2g} of its size at the first moment already")
    if shares[k] <= ROUGH + rounding / size:
        return Finding(name, HOLDS, shares[k], ROUGH, "of its size")
    return Finding(name, BROKEN if shares[k] > ROUGHEST else SUSPICIOUS, shares[k], ROUGH, "of its size",
                   f"the {WORDS[key]} jumps from particle to particle by {shares[k]:.2g} of its size at t = "
                   f"{motion.times[moment]:.4g} s, and by {shares[0]:.2g} at first",
                   **motion.finding_location(moment, p))


def _largest_rms(motion: RecordedMotion, key: str) -> float:
    """Returns the largest RMS over particles of a quantity at any time, for F that of F - 1; SI units."""
    if key == "v":
        return motion.speed
    return largest_rms(motion.fields[key] - (np.eye(motion.dimensions) if key == "F" else 0.0))
