"""Bodies that are strained before their motion begins: F counts from a state without stress, and X from another one.

F then differs from dx/dX by the same factor at all times, that of the first moment: F over F at the first moment is the
deformation since then, whatever the first one is.
"""

from dataclasses import replace

import numpy as np

from solvers.judging.findings.deformation import (
    MOST_GAP,
    OTHERWISE,
    integrate_pair_differences,
    neighbour_pair_mismatch,
    strain_rms,
)
from solvers.judging.findings.recorded_motion_reader import RecordedMotion
from solvers.judging.findings.time_series_fitting import rms

ELSEWHERE = 0.5  # of their distance: farther from where X puts them, neighbours have moved, or X is that of others


def count_from_first_moment(motion: RecordedMotion) -> RecordedMotion:
    """Returns the motion with its first positions as reference, and a note, where F counts from another state than X:
    where neighbours are where F says if both are counted from the first moment, and not if from X."""
    F = motion.fields.get("F")
    if motion.from_start or F is None or motion.neighbour_pairs is None:
        return motion
    misses = _miss_of_pairs_and_sums(motion, F)
    if (misses <= MOST_GAP * motion.rounding).all():
        return motion
    since_start = replace(motion, reference=motion.x[0], from_start=True)
    F_since_start, pairs = since_start.deformation_gradient, motion.neighbour_pairs
    if F_since_start is None or since_start.neighbour_pairs is None:
        return motion
    first = motion.x[0][pairs.other] - motion.x[0][pairs.one]
    if (np.linalg.norm(first - pairs.apart, axis=1) >= ELSEWHERE * pairs.length).any():
        return motion
    if not (_miss_of_pairs_and_sums(since_start, F_since_start) < OTHERWISE * misses).any():
        return motion
    since_start.notes.append(f"F counts from another state than X (it is {strain_rms(F[0]):.3g} off 1 at the first "
                             "moment, RMS), as of a body that is strained before: both were counted from the first "
                             "moment")
    return since_start


def _miss_of_pairs_and_sums(motion: RecordedMotion, F: np.ndarray) -> np.ndarray:
    """Returns by how much (2,), in m, neighbours are not where F (T, P, D, D) says, RMS, and particles where the sum of
    that puts them, at most of three moments: unevenly strained bodies show the one, evenly strained ones the other."""
    T, count = len(motion.times), len(motion.reference)
    found = [neighbour_pair_mismatch(motion, k, F[k]) for k in (0, T // 2, T - 1)]
    sums = [integrate_pair_differences(one.edges, one.difference_vectors, count) for one in found]
    return np.array([max(one.rms for one in found), max(rms(one) for one in sums)])
