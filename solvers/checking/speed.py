"""v against dx/dt: what a particle moves between two moments is its velocity's mean, times what parts them."""

from __future__ import annotations

import numpy as np

from solvers.checking.finding import BROKEN, HOLDS, SUSPICIOUS, Finding, unknown
from solvers.checking.motion import Motion
from solvers.judging.checks.moments import HALF, SLACK, SURE, fitted
from solvers.judging.checks.over_time import rate, rms

SPEED, MOMENT, CENTRE = "v against dx/dt", "moment of v before that of x", "the middle against the mean of v"
#: Of the velocity, RMS: what is left between v and dx/dt, of which the particles' own noise in a sound run of ours
#: makes up to 0.2 (the grid moves them, and is smoother than they are), from where on it is none.
MOST, NOTHING_LEFT = 0.4, 0.8
TOLD = 0.06  # of the velocity: where the trapezoid rule itself is off by more, moments are too far apart
FARTHER = 0.6  # of the way that the particles have gone at most
AROUND = 3  # intervals
RULE = 2.0  # times what the change of v's change says of that rule
OTHER_UNIT = 0.3  # of a power of ten
STEADY = 8.0  # times its own scatter over the intervals: a drift that stays the same
CHANGING = 0.5  # of the mean square of v: its variance over time
LEAST_DRIFT = 1e-5  # of the motion
EXPLAINS = 0.5  # of what v and dx/dt differ by, at most, is left by a lag
FEWEST = 6  # moments, for what is fitted


def check(motion: Motion) -> list[Finding]:
    names = (SPEED, MOMENT, CENTRE)
    if "v" not in motion.fields:
        return [unknown(name, "no v in the files (or not always a number)") for name in names]
    if len(motion.times) < 3 or not motion.speed > 0:
        return [unknown(name, "fewer than three moments" if len(motion.times) < 3 else "v is zero") for name in names]
    v, interval = motion.fields["v"], np.diff(motion.times)[:, None, None]
    moved = np.diff(motion.x, axis=0)
    told = 0.5 * interval * (v[1:] + v[:-1])
    gap, bend = told - moved, _bend(v, interval)
    return [_speed(motion, gap, bend, interval, told, moved), _moment(motion, gap, moved, np.diff(v, axis=0)),
            _centre(motion, moved)]


def _bend(v: np.ndarray, interval: np.ndarray) -> np.ndarray:
    """The error of the trapezoid rule over each interval, by the second differences of v."""
    second = np.empty_like(v)
    second[1:-1] = v[2:] - 2 * v[1:-1] + v[:-2]
    second[0], second[-1] = second[1], second[-2]
    return interval / 12 * np.maximum(np.abs(second[1:]), np.abs(second[:-1]))


def _around(values: np.ndarray) -> np.ndarray:
    """The largest of some values (n,) around each, and of the middle one of all."""
    wide = np.pad(values, AROUND, mode="edge")
    near = np.max([wide[k:k + len(values)] for k in range(2 * AROUND + 1)], axis=0)
    return np.maximum(near, float(np.median(values)))


def _sizes(values: np.ndarray, interval: np.ndarray) -> np.ndarray:
    """RMS over particles (T - 1,) of what is moved over each interval, as a velocity."""
    return np.sqrt(np.mean(np.sum(values**2, axis=2), axis=1)) / interval[:, 0, 0]


def _speed(motion: Motion, gap: np.ndarray, bend: np.ndarray, interval: np.ndarray, told: np.ndarray,
           moved: np.ndarray) -> Finding:
    doubt = RULE * _sizes(bend, interval) / motion.speed
    sure = _around(doubt) <= TOLD  # others look smooth here and there
    if not sure.any():
        return unknown(SPEED, f"the moments are too far apart: between two of them v itself changes so that its mean "
                              f"is unknown by {doubt.min():.2g} of it")
    reach = float(np.sqrt(np.max(np.mean(np.sum((motion.x - motion.x[0]) ** 2, axis=2), axis=1))))
    sure &= interval[:, 0, 0] * motion.speed <= FARTHER * reach  # moments a period apart look smooth everywhere
    if not sure.any():
        return unknown(SPEED, "between two moments v would carry the particles farther than they ever are: the moments "
                              "are too far apart, or v is in another unit")
    off = np.where(sure, _sizes(gap, interval) / motion.speed - doubt, -1.0)
    k = int(np.argmax(off))
    size = float(np.sum(told[sure] * moved[sure]) / max(float(np.sum(told[sure] ** 2)), 1e-300))
    at = motion.at(k + 1, int(np.argmax(np.sum(gap[k] ** 2, axis=1))))
    when = f"between t = {motion.times[k]:.4g} and {motion.times[k + 1]:.4g} s"
    if size > 0 and abs(np.log10(size)) > OTHER_UNIT:
        return Finding(SPEED, BROKEN, float(off[k]), MOST, "of v",
                       f"dx/dt is {size:.4g} times v: x, v or the times are in another unit ({when})", **at)
    if off[k] <= MOST:
        return Finding(SPEED, HOLDS, float(off[k]), MOST, "of v")
    return Finding(SPEED, BROKEN if off[k] > NOTHING_LEFT else SUSPICIOUS, float(off[k]), MOST, "of v",
                   f"the particles do not move as their v says {when}: what is left is {off[k]:.2g} of v (RMS)", **at)


def _moment(motion: Motion, gap: np.ndarray, moved: np.ndarray, gained: np.ndarray) -> Finding:
    """By how much v is late: what is left then goes with what v gains. The trapezoid rule's own error goes with what is
    moved, and is fitted beside."""
    if len(motion.times) < FEWEST:
        return unknown(MOMENT, f"fewer than {FEWEST} moments")
    found, sure = fitted(gap, [-gained, moved])
    late, doubt = float(found[0, 0]), SURE * float(sure[0])
    left = rms(gap + late * gained - found[0, 1] * moved) / max(rms(gap), 1e-300)
    if not np.isfinite(late + doubt):
        return unknown(MOMENT, "v or x are too large")
    if motion.step is None:
        between = float(np.median(np.diff(motion.times)))
        most = SLACK * between + HALF * between + doubt
        wrong = abs(late) > most
        told = "the files do not say the step, of which half is usual"
    else:
        wrong = not -SLACK * motion.step - doubt <= late <= (HALF + SLACK) * motion.step + doubt
        most, told = (HALF + SLACK) * motion.step + doubt, f"a step is {motion.step:.3g} s"
    wrong &= left < EXPLAINS
    when = "before" if late > 0 else "after"
    says = f"v is of a moment {abs(late):.3g} s {when} that of x ({told})" if wrong or abs(late) > doubt else ""
    return Finding(MOMENT, SUSPICIOUS if wrong else HOLDS, late, most, "s", says)


def _centre(motion: Motion, moved: np.ndarray) -> Finding:
    """The middle of mass moves by the momentum over the mass; walls and rims make that inexact, but never by the same
    at all times."""
    mass = motion.fields.get("mass")
    weight = (np.ones(len(motion.number)) if mass is None else mass[0])[:, None]
    if len(motion.times) < FEWEST or not motion.amplitude > 0 or not weight.sum() > 0:
        return unknown(CENTRE, f"fewer than {FEWEST} moments, nothing moves, or no mass")
    changing = float(np.mean(motion.fields["v"].var(axis=0))) / max(float(np.mean(motion.fields["v"] ** 2)), 1e-300)
    if changing < CHANGING:
        return unknown(CENTRE, "v is nearly the same at all moments, so that what goes with it cannot be told from a "
                               "drift")
    interval = np.diff(motion.times)[:, None]
    v = np.sum(motion.fields["v"] * weight, axis=1) / weight.sum()
    a = rate(motion.times, v)  # with which the trapezoid rule is of fourth order
    told = 0.5 * interval * (v[1:] + v[:-1]) - interval**2 / 12 * (a[1:] - a[:-1])
    drift = (np.sum(moved * weight, axis=1) / weight.sum() - told) / interval
    mean, scatter = drift.mean(axis=0), float(np.sqrt(np.sum(drift.var(axis=0))))
    far = float(np.linalg.norm(mean)) * float(motion.times[-1] - motion.times[0]) / motion.amplitude
    steady = float(np.linalg.norm(mean)) / max(scatter, 1e-300)
    if far <= LEAST_DRIFT or steady <= STEADY:
        return Finding(CENTRE, HOLDS, far, LEAST_DRIFT, "of the motion")
    way = ", ".join(f"{value:.3g}" for value in mean)
    return Finding(CENTRE, SUSPICIOUS, far, LEAST_DRIFT, "of the motion",
                   f"the middle of the particles drifts by {way} m/s beyond the mean of their v, the same at all "
                   "times",
                   time=float(motion.times[-1]))
