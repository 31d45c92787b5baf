"""Checks of F against the distances of neighbours, and of particles that overtook each other or are inverted.

The present distance vector of two neighbours is compared with that from their mean F, pair by pair and integrated.
"""

import functools
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from solvers.judging.findings.finding import BROKEN, HOLDS, SUSPICIOUS, Finding, unknown
from solvers.judging.findings.neighbour_comparison import departures
from solvers.judging.findings.recorded_motion_reader import TINY, NeighbourPairs, RecordedMotion

NAMES_OF_F = "F against where neighbours stand", "F against the gradient of x", "F summed up against x"
GAP, FOLLOWS, TORN = NAMES_OF_F
#: Shares of the motion's amplitude from which on neighbours are not where F implies, as in the verdict on our own runs
#: (``neighbour_gap``, 0.2 of the largest displacement), and from which on F is meaningless.
MOST_GAP, NO_GAP = 0.25, 0.5
MOST_OFF, NO_F = 0.5, 1.0  # the same of F itself, RMS: good runs of ours reach 0.4
MOST_TORN, NO_SUM = 0.35, 0.5  # the same summed up (``displacement_mismatch``)
TRAPEZOID = 1 / 3  # of what F departs from its neighbours', by which the rule between two points may be off for it
OTHERWISE = 0.3  # of the miss is left at most where F is something else
INSIDE_OUT, OVERTAKEN = "det F is positive", "neighbours keep their order"
FLATTEST = 1e-3  # det F, below which a particle counts as crushed, as in our own runs
FEWEST = {1: 8, 2: 16, 3: 40}  # particles, by dimension, that a body needs for its inside to be more than its rim
MANY = 0.02  # of all pairs: more of them are no accident of a rim
FEW_AT_A_RIM = 0.005  # of all pairs in the plane or in space, where a rim may have so many; along a line none can
DEEP = 0.7  # of their distance in the reference: where a body is crushed, a few in good runs of ours are less far past


@dataclass(frozen=True)
class NeighbourPairMismatch:
    """Comparison at one time, for each pair of neighbours, of the distance vectors ``actual_vectors`` (n, D) with those
    that F implies, ``implied_vectors`` (n, D), in m."""

    edges: NeighbourPairs
    actual_vectors: np.ndarray
    implied_vectors: np.ndarray

    @functools.cached_property
    def difference_vectors(self) -> np.ndarray:
        return self.actual_vectors - self.implied_vectors

    @functools.cached_property
    def difference_lengths(self) -> np.ndarray:
        return np.linalg.norm(self.difference_vectors, axis=1)

    @property
    def rms(self) -> float:
        return float(np.sqrt(np.mean(self.difference_lengths**2)))

    @property
    def relative_rms(self) -> float:
        """RMS of the mismatch over the distance in the reference configuration: comparable with the error of F."""
        return float(np.sqrt(np.mean((self.difference_lengths / self.edges.length) ** 2)))

    @property
    def worst_particle(self) -> int:
        """Index of a particle of the pair with the largest mismatch."""
        return int(self.edges.one[np.argmax(self.difference_lengths)])


def neighbour_pair_mismatch(motion: RecordedMotion, moment: int, F: np.ndarray) -> NeighbourPairMismatch:
    """Returns pairs' distance vectors at the time of index ``moment``, and those implied by F (P, D, D) then."""
    edges, x = motion.neighbour_pairs, motion.x[moment]
    assert edges is not None
    return NeighbourPairMismatch(edges, x[edges.other] - x[edges.one], edges.deformed_vectors(F))


def strain_rms(F: np.ndarray) -> float:
    """Returns the root of the mean of |F - 1|², the Frobenius norm, over F (..., D, D)."""
    return float(np.sqrt(np.mean(np.sum((F - np.eye(F.shape[-1])) ** 2, axis=(-2, -1)))))


def integrate_pair_differences(edges: NeighbourPairs, values: np.ndarray, count: int, rounds: int = 300) -> np.ndarray:
    """Returns the field (P, D) of ``count`` particles of mean 0 whose differences between neighbours are nearest to
    ``values`` (n, D) of the pairs: by least squares, with conjugate gradients preconditioned by neighbour counts."""
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


def check_f(motion: RecordedMotion) -> list[Finding]:
    """Returns three findings on whether neighbours are where the F of both imply."""
    F, few = motion.deformation_gradient, FEWEST[motion.dimensions]
    assert F is not None
    if motion.neighbour_pairs is None or len(motion.reference) < few:
        return [unknown(name, f"fewer than {few} particles lie so that they have neighbours") for name in NAMES_OF_F]
    if not motion.amplitude > 0:
        return [unknown(name, "nothing moves") for name in NAMES_OF_F]
    mismatches = [(k, neighbour_pair_mismatch(motion, k, F[k])) for k in motion.checked_time_indices]
    follows = _explain_mismatch(motion, F, mismatches)
    if follows is None:
        moment, worst = max(mismatches, key=lambda pair: pair[1].relative_rms)
        says = f"what parts neighbours differs from what F says by {{share}} of what parted them, RMS, at " \
               f"t = {motion.times[moment]:.4g} s"
        rounding = motion.rounding / motion.spacing
        follows = _finding_from_limits(FOLLOWS, worst.relative_rms, MOST_OFF + rounding, NO_F + rounding, "of F", says,
                                       motion.finding_location(moment, worst.worst_particle))
    return [_check_neighbour_gap(motion, F, mismatches), follows, _check_integrated_mismatch(motion, mismatches)]


def _check_neighbour_gap(motion: RecordedMotion, F: np.ndarray,
                         mismatches: list[tuple[int, NeighbourPairMismatch]]) -> Finding:
    """Checks the largest RMS mismatch of pairs over time, relative to the motion's amplitude."""
    moment, worst = max(mismatches, key=lambda pair: pair[1].rms)
    assert motion.neighbourhood is not None
    rough = float(np.sqrt(np.mean(departures(motion.neighbourhood, F[moment].reshape(len(F[moment]), -1)) ** 2)))
    excuse = TRAPEZOID * rough * motion.spacing / motion.amplitude
    says = f"neighbours are not where their F says, by {worst.rms:.3g} m (RMS), {{share}} of the motion, at " \
           f"t = {motion.times[moment]:.4g} s"
    return _finding_from_limits(GAP, worst.rms / motion.amplitude, MOST_GAP + excuse, NO_GAP + excuse, "of the motion",
                                says, motion.finding_location(moment, worst.worst_particle))


def _check_integrated_mismatch(motion: RecordedMotion, mismatches: list[tuple[int, NeighbourPairMismatch]]) -> Finding:
    """Checks mismatches integrated over the body: late waves, of which each pair shows little."""
    count = len(motion.reference)
    squares = ((moment, np.sum(integrate_pair_differences(one.edges, one.difference_vectors, count)**2, axis=1))
               for moment, one in mismatches)
    size, moment, p = max((float(np.sqrt(np.mean(one))), moment, int(np.argmax(one))) for moment, one in squares)
    says = f"the displacements are not the sum of what F says, by {size:.3g} m (RMS), {{share}} of the motion, at " \
           f"t = {motion.times[moment]:.4g} s"
    return _finding_from_limits(TORN, size / motion.amplitude, MOST_TORN, NO_SUM, "of the motion", says,
                                motion.finding_location(moment, p))


def _finding_from_limits(name: str, measured: float, most: float, nothing_left: float, unit: str, says: str,
                         at: dict) -> Finding:
    """Returns a finding that holds up to ``most``, and is broken beyond ``nothing_left``; ``at`` is its location."""
    if measured <= most:
        return Finding(name, HOLDS, measured, most, unit)
    verdict = BROKEN if not measured <= nothing_left else SUSPICIOUS
    return Finding(name, verdict, measured, most, unit, says.format(share=f"{measured:.2g}"), **at)


def _explain_mismatch(motion: RecordedMotion, F: np.ndarray,
                      mismatches: list[tuple[int, NeighbourPairMismatch]]) -> Finding | None:
    """Returns a finding that F or x mean something else, where that fits far better; otherwise None. ``mismatches`` has
    time indices and comparisons."""
    moment, now = max(mismatches, key=lambda pair: strain_rms(F[pair[0]]))
    edges, told = now.edges, strain_rms(F[moment])
    if not told > 0 or now.rms <= max(0.1 * told * motion.spacing, motion.rounding):
        return None
    best = min(((float(np.sqrt(np.mean(np.sum((now.actual_vectors - other) ** 2, axis=1)))) / max(now.rms, TINY), words)
                for words, other in _readings(motion, F[moment], now)), default=(1.0, ""))
    if not best[0] < OTHERWISE:
        return None
    p = int(edges.one[int(np.argmax(now.difference_lengths))])
    return Finding(FOLLOWS, SUSPICIOUS, now.relative_rms, MOST_OFF, "of F",
                   f"at t = {motion.times[moment]:.4g} s {best[1]}: read so, {best[0]:.2g} is left of what neighbours "
                   "are off", **motion.finding_location(moment, p))


def _readings(motion: RecordedMotion, F: np.ndarray, now: NeighbourPairMismatch) -> Iterator[tuple[str, np.ndarray]]:
    """Yields other possible meanings of the file in words, each with the distance vectors (n, D) that it implies."""
    edges, D = now.edges, motion.dimensions
    yield "F seems to be its inverse, dX/dx", edges.deformed_vectors(np.linalg.pinv(F))
    yield "F seems to be the gradient of the displacement, F - 1", edges.deformed_vectors(F + np.eye(D))
    if D > 1:
        yield "F seems to be transposed", edges.deformed_vectors(np.swapaxes(F, -1, -2))
    yield "x seems to be the displacement, not the position", now.implied_vectors - edges.apart
    size = float(np.sum(now.actual_vectors * now.implied_vectors)) / max(float(np.sum(now.implied_vectors**2)), TINY)
    if abs(np.log10(max(abs(size), TINY))) > 0.3:
        yield (f"x seems to be in another unit than {'X' if not motion.from_start else 'at the start'}, {size:.4g} "
               "times", size * now.implied_vectors)
    if D > 1:
        yield "the axes of x seem to be exchanged", now.implied_vectors[:, ::-1]


def check_inverted(motion: RecordedMotion) -> Finding:
    """Checks that det F is positive for all particles at all times, and not nearly 0."""
    J = np.linalg.det(motion.fields["F"])
    flat = J < FLATTEST
    if not flat.any():
        return Finding(INSIDE_OUT, HOLDS, float(J.min()), FLATTEST, "")
    moment = int(np.argmax(flat.any(axis=1)))
    p, count = int(np.argmin(J[moment])), int(flat[moment].sum())
    word = "turned inside out" if J[moment, p] <= 0 else "crushed to nothing"
    return Finding(INSIDE_OUT, BROKEN if J[moment, p] <= 0 else SUSPICIOUS, float(J[moment, p]), FLATTEST, "",
                   f"{count:,} particle{'s are' if count != 1 else ' is'} {word} at t = {motion.times[moment]:.4g} s: "
                   f"det F is {J[moment, p]:.3g}", **motion.finding_location(moment, p))


def check_overtaken(motion: RecordedMotion) -> Finding:
    """Checks that the distance vector of neighbours is not opposite to that by the motion around them: on a line by
    their order in the reference configuration, otherwise by a plane through the neighbours, and by F."""
    edges, near = motion.neighbour_pairs, motion.neighbourhood
    if edges is None or near is None:
        return unknown(OVERTAKEN, "too few particles have neighbours")
    F, found = motion.deformation_gradient, []
    for moment in motion.checked_time_indices:
        x = motion.x[moment]
        now, told = x[edges.other] - x[edges.one], [edges.apart]
        if motion.dimensions > 1:  # by the plane, and by F where there is one: at a rim either may be wrong
            slopes = [neighbour_gradients(motion, x), *([] if F is None else [F[moment]])]
            told = [edges.deformed_vectors(one) for one in slopes]
        ahead = np.max([np.sum(now * one, axis=1) / np.maximum(np.linalg.norm(one, axis=1), TINY) for one in told],
                       axis=0)
        turned, deep = ahead <= -motion.rounding, ahead <= -DEEP * edges.length - motion.rounding
        few = FEW_AT_A_RIM if motion.dimensions > 1 else 0.0
        found.append(turned if turned.mean() > MANY else deep if deep.mean() > few else np.zeros_like(deep))
    shares = [float(turned.mean()) for turned in found]
    if max(shares) == 0:
        return Finding(OVERTAKEN, HOLDS, 0.0, 0.0, "of all pairs",
                       f"of up to {100 * MANY:.0f} % of them a shallow change would not count")
    k = int(np.argmax(shares))
    first = next(k for k, share in enumerate(shares) if share > 0)
    moment, p = motion.checked_time_indices[k], int(edges.one[np.argmax(found[k])])
    return Finding(OVERTAKEN, BROKEN if shares[k] > MANY else SUSPICIOUS, shares[k], 0.0, "of all pairs",
                   f"{int(found[k].sum()):,} of {len(found[k]):,} pairs of neighbours have changed their order at t = "
                   f"{motion.times[moment]:.4g} s (first at {motion.times[motion.checked_time_indices[first]]:.4g} s)",
                   **motion.finding_location(moment, p))


def neighbour_gradients(motion: RecordedMotion, values: np.ndarray) -> np.ndarray:
    """Returns the gradients (P, C, D), in the reference configuration, of planes fitted to the values (P, C) of each
    particle's neighbours."""
    near = motion.neighbourhood
    assert near is not None
    away = motion.reference[near.who] - motion.reference[:, None, :]
    weight = near.there[:, :, None]
    left = np.where(weight, away, 0.0)
    right = np.where(weight, values[near.who] - values[:, None, :], 0.0)
    square = np.einsum("pki,pkj->pij", left, left)
    return np.einsum("pij,pkj,pkc->pci", np.linalg.pinv(square, hermitian=True), left, right)
