"""Checks that all quantities at one time belong to one time, and that v is dx/dt.

A quantity that lags by tau has the error -tau times its rate. The lag is fitted by least squares over all particles and
times, beside the effects of the grid's smoothing and of a wrong amplitude; without a solution, for v against x.
"""

import numpy as np

from solvers.judging.findings.finding import BROKEN, HOLDS, OFF, SUSPICIOUS, Finding, unknown
from solvers.judging.findings.findings_input import FindingsInput
from solvers.judging.findings.recorded_motion_reader import RecordedMotion
from solvers.judging.findings.time_series_fitting import (
    jackknife_error,
    jackknife_least_squares,
    largest_rms,
    rms,
    time_derivative,
)
from solvers.translatable_message import Message

FEWEST_TIMES = 5
SURE, SMOOTHED = 6.0, 3.0  # times that uncertainty; times what smoothing can make of the error of v
FARTHEST_APART = 0.25  # of a period: moments between which neither rule follows the motion are farther apart
UNSURE = "smaller shifts are below the errors, or between the few times"
VELOCITY, STRESS = ("moment of the velocities before that of the positions",
                    "moment of F or the stress before that of the positions")
STEPS = "steps"
HALF = 0.5  # of a step: what leapfrog's velocities are of, and 0 what others' are
SLACK = 0.25  # of a step
SHORTEST_LAG = 0.25  # of a period, in less of which v does not pass through 0, so that a lag looks like a size
TOO_LARGE = "the errors are too large"
FEW = Message("fewer than {least} times, or not the same particles at all of them", FEWEST_TIMES)
NAMES_OF_V = "v against dx/dt", "moment of v before that of x", "the middle against the mean of v"
SPEED, MOMENT, CENTRE = NAMES_OF_V
#: Of the velocity, RMS: what is left between v and dx/dt at most, which is what v of a good run may be wrong by (the
#: grid moves the particles, and is smoother than their own v), and from where on v is none.
MOST, NOTHING_LEFT = 0.5, 0.8
TOLD = 0.06  # of the velocity: where the trapezoid rule itself is off by more, moments are too far apart
FARTHER = 0.6  # of the way that the particles have gone at most
AROUND = 3  # intervals
RULE = 2.0  # times the rule's error by the second difference of v
OTHER_UNIT = 0.3  # of a power of ten
STEADY = 8.0  # times its own scatter over the intervals: a drift that stays the same
CHANGING = 0.5  # of the mean square of v: its variance over time
STEADY_V = "v is nearly the same at all moments, so that what goes with it cannot be told from a drift or a lag"
LEAST_DRIFT = 1e-5  # of the motion
LOST = 0.5  # of v: errors of it from which on a lag must explain most
LEFT_BY_LAG = 0.5  # of the mean square by which positions miss such velocities, at most, where a lag is the reason
EXPLAINS = 0.5  # of what v and dx/dt differ by, at most, is left by a lag
STILL = 1e-9  # of the stress: what it changes by in a run where rounding alone changes it
FEWEST = 6  # moments, for what is fitted within a motion


def check_velocity_time(evidence: FindingsInput) -> Finding:
    """Checks that positions grow by the velocities: over each interval the trapezoidal rule for the errors of v is
    compared with the growth of the error of x. Both are small and smooth in time, so that few times are enough."""
    tracks, step = evidence.tracks, evidence.step
    if tracks is None or len(tracks.time) < FEWEST_TIMES or "v" not in tracks.exact:
        return unknown(VELOCITY, FEW if "v" in evidence.errors[0] else "no velocities in the files")
    if np.diff(tracks.time).max() > FARTHEST_APART * evidence.scene.period:
        return unknown(VELOCITY, "two moments are farther apart than a quarter of a period")
    if evidence.scene.swings and np.ptp(tracks.time) < SHORTEST_LAG * evidence.scene.period:
        return unknown(VELOCITY, "too little of a period to tell velocities that are late from too large ones")
    x, v = (tracks.own[q] - tracks.exact[q] for q in ("x", "v"))
    interval = np.diff(tracks.time)[:, None, None]
    gap = 0.5 * interval * (v[1:] + v[:-1]) - np.diff(x, axis=0)
    bend = interval**2 / 12 * np.diff(time_derivative(tracks.time, v), axis=0)  # with which the rule is of fourth order
    moved, gained = np.diff(tracks.exact["x"], axis=0), np.diff(tracks.exact["v"], axis=0)
    late, sure = jackknife_least_squares(gap, [-gained, moved])
    apparent = _apparent_lag_by_smoothing(late[0, 1], v, time_derivative(tracks.time, tracks.exact["v"]))
    rule = RULE * abs(jackknife_least_squares(bend, [-gained, moved])[0][0, 0])
    slack = (SURE * sure[0] + apparent + rule) / step
    found = _lag_finding(VELOCITY, late[0, 0] / step, slack, (-SLACK, HALF + SLACK), step,
                         Message("the velocities are"))
    left = rms(gap + late[0, 0] * gained - late[0, 1] * moved)
    lost = rms(v) > LOST * rms(tracks.exact["v"]) and left**2 > LEFT_BY_LAG * rms(gap) ** 2
    return unknown(VELOCITY, TOO_LARGE) if found.verdict == OFF and lost else found


def check_stress_time(evidence: FindingsInput) -> Finding:
    """Checks the lag in time of the stress behind x, from the errors of both, in steps."""
    tracks, step = evidence.tracks, evidence.step
    if tracks is None or len(tracks.time) < FEWEST_TIMES or "sigma" not in tracks.exact:
        return unknown(STRESS, FEW if "sigma" in evidence.errors[0] else "no F and no stress in the files")
    sigma, x = (tracks.own[q] - tracks.exact[q] for q in ("sigma", "x"))
    speed = time_derivative(tracks.time, tracks.exact["x"])
    parts = [-time_derivative(tracks.time, tracks.exact["sigma"]), tracks.exact["sigma"]]
    if rms(parts[0]) * np.ptp(tracks.time) <= STILL * rms(parts[1]):
        return unknown(STRESS, "the stress does not change")
    of_place = [-speed, tracks.exact["x"] - tracks.material_position]
    outwards = np.argsort(np.linalg.norm(tracks.material_position - tracks.material_position.mean(axis=0), axis=1),
                          kind="stable")
    late = [(jackknife_least_squares(turn(sigma), [turn(part) for part in parts])[0]
             - jackknife_least_squares(turn(x), [turn(part) for part in of_place])[0])[:, 0] / step
            for turn in (lambda values: values, lambda values: np.moveaxis(values[:, outwards], 0, 1))]
    # What is really late is so at all times and everywhere, and of the right size.
    slack = SURE * max(map(jackknife_error,
                           late)) + _apparent_lag_by_smoothing(jackknife_least_squares(sigma, parts)[0][0, 1], sigma,
                                                                                parts[0]) / step
    return _lag_finding(STRESS, float(late[0][0]), slack, (-HALF, HALF), step, Message("F or the stress is"))


def _apparent_lag_by_smoothing(part: float, error: np.ndarray, slope: np.ndarray) -> float:
    """Returns the lag in s that a grid pretends by smoothing the motion by a ``part``, with the ``error`` of a field
    and its rate ``slope``."""
    return SMOOTHED * abs(part) * rms(error) / max(rms(slope), 1e-300)


def _lag_finding(name: str, steps: float, slack: float, allowed: tuple[float, float], step: float, who: str) -> Finding:
    """Returns the finding for a lag of ``steps``: ``allowed`` is its range and ``slack`` the uncertainty, in steps of
    ``step`` s; ``who`` begins the sentence."""
    if not np.isfinite(steps + slack):
        return unknown(name, TOO_LARGE)
    least, most = allowed
    tolerance = slack + abs(least if steps < 0.5 * (least + most) else most)
    if least - slack <= steps <= most + slack:
        return Finding(name, HOLDS, steps, tolerance, STEPS, UNSURE if slack > HALF else "")
    when = Message("before that of the positions" if steps > 0 else "after that of the positions")
    return Finding(name, OFF, steps, tolerance, STEPS,
                   Message("{who} of a moment {offset:.3g} s {when}, {ratio:.2g} times the step ({step:.3g} s)", who,
                           abs(steps) * step, when, abs(steps), step))


def check_velocity(motion: RecordedMotion) -> list[Finding]:
    """Returns three findings on whether displacements between times are the mean velocity times the interval."""
    if len(motion.times) < 3 or not motion.speed > 0:
        why = "fewer than three moments" if len(motion.times) < 3 else "v is zero, or rounding"
        return [unknown(name, why) for name in NAMES_OF_V]
    v, interval = motion.fields["v"], np.diff(motion.times)[:, None, None]
    moved = np.diff(motion.x, axis=0)
    told = 0.5 * interval * (v[1:] + v[:-1])
    second = np.empty_like(v)  # differences, by which the trapezoid rule errs
    second[1:-1] = v[2:] - 2 * v[1:-1] + v[:-2]
    second[0], second[-1] = second[1], second[-2]
    gap, bend = told - moved, interval / 12 * np.maximum(np.abs(second[1:]), np.abs(second[:-1]))
    return [_check_speed(motion, gap, bend, interval, told, moved), _check_lag(motion, gap, moved, np.diff(v, axis=0)),
            _check_centre(motion, moved)]


def _interval_rms(values: np.ndarray, interval: np.ndarray) -> np.ndarray:
    """Returns the RMS over particles (T - 1,) of displacements (T - 1, P, D) over their intervals, in m/s."""
    return np.sqrt(np.mean(np.sum(values**2, axis=2), axis=1)) / interval[:, 0, 0]


def _check_speed(motion: RecordedMotion, mismatch: np.ndarray, bend: np.ndarray, interval: np.ndarray,
                 expected: np.ndarray, moved: np.ndarray) -> Finding:
    """Checks the ``mismatch`` of displacements, ``expected`` from v minus ``moved`` (T - 1, P, D), relative to v;
    ``bend`` is the possible error of the trapezoidal rule, both in m, ``interval`` in s."""
    doubt = RULE * _interval_rms(bend, interval) / motion.speed
    wide = np.pad(doubt, AROUND, mode="edge")
    near = np.max([wide[k:k + len(doubt)] for k in range(2 * AROUND + 1)], axis=0)
    sure = np.maximum(near, float(np.median(doubt))) <= TOLD  # others look smooth here and there
    if not sure.any():
        return unknown(SPEED, f"the moments are too far apart: between two of them v itself changes so that its mean "
                              f"is unknown by {doubt.min():.2g} of it")
    reach = largest_rms(motion.x - motion.x[0])
    sure &= interval[:, 0, 0] * motion.speed <= FARTHER * reach  # moments a period apart look smooth everywhere
    if not sure.any():
        return unknown(SPEED, "between two moments v would carry the particles farther than they ever are: the moments "
                              "are too far apart, or v is in another unit")
    rounding = 2 * motion.stored_rounding["x"] / interval[:, 0, 0] + motion.stored_rounding["v"]
    doubt = doubt + rounding * np.sqrt(motion.dimensions) / motion.speed
    off = np.where(sure, _interval_rms(mismatch, interval) / motion.speed - doubt, -1.0)
    k = int(np.argmax(off))
    size = float(np.sum(expected[sure] * moved[sure]) / max(float(np.sum(expected[sure] ** 2)), 1e-300))
    at = motion.finding_location(k + 1, int(np.argmax(np.sum(mismatch[k] ** 2, axis=1))))
    when = f"between t = {motion.times[k]:.4g} and {motion.times[k + 1]:.4g} s"
    if size > 0 and abs(np.log10(size)) > OTHER_UNIT:
        return Finding(SPEED, BROKEN, float(off[k]), MOST, "of v",
                       f"dx/dt is {size:.4g} times v: x, v or the times are in another unit ({when})", **at)
    if off[k] <= MOST:
        return Finding(SPEED, HOLDS, float(off[k]), MOST, "of v")
    return Finding(SPEED, BROKEN if off[k] > NOTHING_LEFT else SUSPICIOUS, float(off[k]), MOST, "of v",
                   f"the particles do not move as their v says {when}: what is left is {off[k]:.2g} of v (RMS)", **at)


def _check_lag(motion: RecordedMotion, mismatch: np.ndarray, moved: np.ndarray, gained: np.ndarray) -> Finding:
    """Checks the lag of v, in proportion to which the mismatch grows with the change of v (``gained``). The trapezoidal
    rule's own error is proportional to the displacement (``moved``), and fitted as well."""
    if len(motion.times) < FEWEST:
        return unknown(MOMENT, f"fewer than {FEWEST} moments")
    if _changing_share(motion.fields["v"]) < CHANGING:
        return unknown(MOMENT, STEADY_V)
    if rms(mismatch) <= motion.rounding:
        return Finding(MOMENT, HOLDS)
    found, sure = jackknife_least_squares(mismatch, [-gained, moved])
    late, doubt = float(found[0, 0]), SURE * float(sure[0])
    left = rms(mismatch + late * gained - found[0, 1] * moved) / max(rms(mismatch), 1e-300)
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


def _changing_share(v: np.ndarray) -> float:
    """Returns the share of the mean square of velocities (T, P, D) that is variance over time."""
    return float(np.mean(v.var(axis=0))) / max(float(np.mean(v**2)), 1e-300)


def _check_centre(motion: RecordedMotion, moved: np.ndarray) -> Finding:
    """Checks that the centre of mass moves by momentum over mass; walls and rims make that inexact, but never by the
    same amount at all times."""
    mass = motion.fields.get("mass")
    weight = (np.ones(len(motion.number)) if mass is None else mass[0])[:, None]
    if len(motion.times) < FEWEST or not motion.amplitude > 0 or not weight.sum() > 0:
        return unknown(CENTRE, f"fewer than {FEWEST} moments, nothing moves, or no mass")
    if _changing_share(motion.fields["v"]) < CHANGING:
        return unknown(CENTRE, STEADY_V)
    interval = np.diff(motion.times)[:, None]
    v = np.sum(motion.fields["v"] * weight, axis=1) / weight.sum()
    a = time_derivative(motion.times, v)  # with which the trapezoid rule is of fourth order
    told = 0.5 * interval * (v[1:] + v[:-1]) - interval**2 / 12 * (a[1:] - a[:-1])
    drift = (np.sum(moved * weight, axis=1) / weight.sum() - told) / interval
    mean, scatter = drift.mean(axis=0), float(np.sqrt(np.sum(drift.var(axis=0))))
    far = float(np.linalg.norm(mean)) * float(motion.times[-1] - motion.times[0]) / motion.amplitude
    steady = float(np.linalg.norm(mean)) / max(scatter, 1e-300)
    if far <= LEAST_DRIFT or steady <= STEADY:
        return Finding(CENTRE, HOLDS, far, LEAST_DRIFT, "of the motion")
    way = ", ".join(f"{value:.3g}" for value in mean)
    return Finding(CENTRE, SUSPICIOUS, far, LEAST_DRIFT, "of the motion", "the middle of the particles drifts by "
                   f"{way} m/s beyond the mean of their v, the same at all times", time=float(motion.times[-1]))
