"""Checks of a motion's times by its velocities: how far v carries the particles says how long an interval lasted.

Where v fits the positions in most intervals, one in which particles go farther than any v would carry them is between
moments that are exchanged or missing; and where they go on as before while the times do not, these change their unit.
"""

import numpy as np

from solvers.judging.findings.finding import BROKEN, HOLDS, Finding, unknown
from solvers.judging.findings.recorded_motion_reader import TINY, RecordedMotion

NAME = "intervals between moments against v"
FEWEST = 6  # moments
FITS = 0.3  # of what particles move, by which v may miss it, where it says how long that took
FEW_DOUBTS = 0.25  # of the intervals: v fits those that are not
TOO_FAR = 1.6  # times as far as the largest velocity carries particles
AS_BEFORE = 1.1  # times as long, at most, an interval is by v where particles go on as before
OTHER = 1.5  # times as long it is by the times


def check_intervals(motion: RecordedMotion) -> Finding:
    """Checks each interval between moments by the mean velocity over it, which moves the particles ``lasts`` s long."""
    if len(motion.times) < FEWEST or not motion.speed > 0:
        return unknown(NAME, f"fewer than {FEWEST} moments, or v is zero, or rounding")
    times, interval, moved = motion.times, np.diff(motion.times), np.diff(motion.x, axis=0)
    mean = 0.5 * (motion.fields["v"][1:] + motion.fields["v"][:-1])
    lasts = np.einsum("tpd,tpd->t", moved, mean) / np.maximum(_squares(mean), TINY)
    fits = _squares(moved - lasts[:, None, None] * mean) <= FITS**2 * _squares(moved)
    right = fits & (np.abs(lasts - interval) <= FITS * interval)
    far = np.sqrt(_squares(moved) / moved.shape[1]) / (motion.speed * interval)
    k = int(np.argmax(far))
    if np.mean(~right) <= FEW_DOUBTS and far[k] > TOO_FAR:
        return Finding(NAME, BROKEN, float(far[k]), TOO_FAR, "times as far", f"between t = {times[k]:.4g} and "
                       f"{times[k + 1]:.4g} s the particles go {far[k]:.3g} times as far as the largest v would carry "
                       "them: moments are exchanged or missing", time=float(times[k + 1]))
    longer, by_v = (values[1:] / values[:-1] for values in (interval, lasts))
    goes_on = fits[1:] & fits[:-1] & (np.maximum(by_v, 1 / by_v) <= AS_BEFORE) & (by_v > 0)
    # A unit lasts: with moments a whole turn of the motion apart, a shorter last interval alone may look right.
    lasting = (right[:-3] == right[1:-2]) & (right[1:-2] != right[2:-1]) & (right[2:-1] == right[3:])
    goes_on &= np.pad(lasting, 1)
    change = np.where(goes_on, np.maximum(longer, 1 / longer), 1.0)
    k = int(np.argmax(change))
    if change[k] <= OTHER:
        return Finding(NAME, HOLDS, float(max(change[k], far.max())), TOO_FAR, "times as far")
    return Finding(NAME, BROKEN, float(change[k]), OTHER, "times as long", f"from t = {times[k + 1]:.4g} s on the "
                   f"particles go on as before, as v carries them in {lasts[k + 1]:.3g} s, but the times by "
                   f"{interval[k + 1]:.3g} s, after {interval[k]:.3g} s: times change their unit, or are doubled",
                   time=float(times[k + 1]))


def _squares(field: np.ndarray) -> np.ndarray:
    """Returns the sums (T,) of the squares of a field (T, P, D)."""
    return np.einsum("tpd,tpd->t", field, field)
