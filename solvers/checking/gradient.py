"""F against the gradient of x: whether neighbours stand where the F of both say, pair by pair and summed up."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from solvers.checking.deformation import Misses, gathered, misses, strain
from solvers.checking.finding import BROKEN, HOLDS, SUSPICIOUS, Finding, unknown
from solvers.checking.motion import TINY, Motion
from solvers.judging.checks.neighbours import departures

GAP, FOLLOWS, TORN = "F against where neighbours stand", "F against the gradient of x", "F summed up against x"
#: Of the amplitude of the motion, from where on neighbours are not where their F says: as the lab's own verdict has it
#: (``neighbour_gap``, 0.2 of the largest displacement), and from where on nothing is left of it.
MOST_GAP, NO_GAP = 0.25, 0.5
MOST_OFF, NO_F = 0.5, 1.0  # the same of F itself, RMS: good runs of ours reach 0.4
MOST_TORN, NO_SUM = 0.35, 0.5  # the same summed up (``displacement_mismatch``)
TRAPEZOID = 1 / 3  # of what F departs from its neighbours', by which the rule between two points may be off for it
OTHERWISE = 0.3  # of the miss is left at most where F is something else
NO_F_THERE = "no F in the files (or not always a number)"
FEW = "fewer than {} particles lie so that they have neighbours"


def fewest(motion: Motion) -> int:
    """Particles that a body needs for its inside to be more than its rim."""
    return {1: 8, 2: 16, 3: 40}[motion.dimensions]


def check(motion: Motion) -> list[Finding]:
    F = motion.gradient
    names = (GAP, FOLLOWS, TORN)
    if F is None:
        return [unknown(name, NO_F_THERE) for name in names]
    if motion.edges is None or len(motion.reference) < fewest(motion):
        return [unknown(name, FEW.format(fewest(motion))) for name in names]
    if not motion.amplitude > 0:
        return [unknown(name, "nothing moves") for name in names]
    every = [(moment, misses(motion, moment, F[moment])) for moment in motion.moments]
    other = _otherwise(motion, F, every)
    return [_gap(motion, F, every), other or _follows(motion, every), _torn(motion, every)]


def _gap(motion: Motion, F: np.ndarray, every: list[tuple[int, Misses]]) -> Finding:
    """By the largest RMS over the pairs, beside the motion's amplitude."""
    moment, worst = max(every, key=lambda pair: pair[1].rms)
    excuse = TRAPEZOID * _rough(motion, F[moment]) * motion.spacing / motion.amplitude
    return _told(GAP, worst.rms / motion.amplitude, MOST_GAP + excuse, NO_GAP + excuse, "of the motion",
                 f"neighbours are not where their F says, by {worst.rms:.3g} m (RMS), {{share}} of the motion, "
                 f"at t = {motion.times[moment]:.4g} s", motion.at(moment, worst.worst))


def _follows(motion: Motion, every: list[tuple[int, Misses]]) -> Finding:
    """By what F would have to be off."""
    moment, worst = max(every, key=lambda pair: pair[1].of_length)
    return _told(FOLLOWS, worst.of_length, MOST_OFF, NO_F, "of F",
                 f"what parts neighbours differs from what F says by {{share}} of what parted them, RMS, at t = "
                 f"{motion.times[moment]:.4g} s", motion.at(moment, worst.worst))


def _torn(motion: Motion, every: list[tuple[int, Misses]]) -> Finding:
    """Misses that add up over the body: late waves, which each pair shows little of."""
    found = []
    for moment, pairs in every:
        field = gathered(pairs.edges, pairs.miss, len(motion.reference))
        found.append((float(np.sqrt(np.mean(np.sum(field**2, axis=1)))), moment,
                      int(np.argmax(np.sum(field**2, axis=1)))))
    size, moment, p = max(found)
    return _told(TORN, size / motion.amplitude, MOST_TORN, NO_SUM, "of the motion",
                 f"the displacements are not the sum of what F says, by {size:.3g} m (RMS), {{share}} of the motion, "
                 f"at t = {motion.times[moment]:.4g} s", motion.at(moment, p))


def _rough(motion: Motion, F: np.ndarray) -> float:
    assert motion.near is not None
    return float(np.sqrt(np.mean(departures(motion.near, F.reshape(len(F), -1)) ** 2)))


def _told(name: str, measured: float, most: float, nothing_left: float, unit: str, says: str, at: dict) -> Finding:
    if measured <= most:
        return Finding(name, HOLDS, measured, most, unit)
    verdict = BROKEN if not measured <= nothing_left else SUSPICIOUS
    return Finding(name, verdict, measured, most, unit, says.format(share=f"{measured:.2g}"), **at)


def _otherwise(motion: Motion, F: np.ndarray, every: list[tuple[int, Misses]]) -> Finding | None:
    """What F or x is where something else fits far better, and F itself not."""
    moment, now = max(every, key=lambda pair: strain(F[pair[0]]))
    edges, told = now.edges, strain(F[moment])
    if not told > 0 or now.rms <= 0.1 * told * motion.spacing:
        return None
    best = min(((float(np.sqrt(np.mean(np.sum((now.now - other) ** 2, axis=1)))) / max(now.rms, TINY), words)
                for words, other in _readings(motion, F[moment], now)), default=(1.0, ""))
    if not best[0] < OTHERWISE:
        return None
    p = int(edges.one[int(np.argmax(now.size))])
    return Finding(FOLLOWS, SUSPICIOUS, now.of_length, MOST_OFF, "of F",
                   f"at t = {motion.times[moment]:.4g} s {best[1]}: read so, {best[0]:.2g} is left of what neighbours "
                   "are off", **motion.at(moment, p))


def _readings(motion: Motion, F: np.ndarray, now: Misses) -> Iterator[tuple[str, np.ndarray]]:
    """What parts neighbours if the file means something else, in words."""
    edges, D = now.edges, motion.dimensions

    def by(other: np.ndarray) -> np.ndarray:
        mean = 0.5 * (other[edges.one] + other[edges.other])
        return np.einsum("nij,nj->ni", mean, edges.apart)

    forms: dict[str, Callable[[], np.ndarray]] = {
        "F seems to be its inverse, dX/dx": lambda: np.linalg.pinv(F),
        "F seems to be the gradient of the displacement, F - 1": lambda: F + np.eye(D)}
    if D > 1:
        forms["F seems to be transposed"] = lambda: np.swapaxes(F, -1, -2)
    for words, form in forms.items():
        yield words, by(form())
    yield "x seems to be the displacement, not the position", now.told - edges.apart
    size = float(np.sum(now.now * now.told)) / max(float(np.sum(now.told**2)), TINY)
    if abs(np.log10(max(abs(size), TINY))) > 0.3:
        yield (f"x seems to be in another unit than {'X' if not motion.from_start else 'at the start'}, {size:.4g} "
               "times", size * now.told)
    if D > 1:
        yield "the axes of x seem to be exchanged", now.told[:, ::-1]
