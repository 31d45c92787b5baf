"""Checks that the motion is as large as it should be and keeps its size, and that the clock is right.

Displacements are fitted by (1 + a + b t) u(t - lag - pace t), with the exact u: by a constant factor, damping or
growth, a lag, and a pace, all together, because a motion out of phase looks smaller than one in phase.
"""

from dataclasses import dataclass

import numpy as np

from solvers.judging.findings.finding import HOLDS, OFF, Finding, unknown
from solvers.judging.findings.findings_input import FindingsInput, ParticleTrajectories
from solvers.judging.findings.time_series_fitting import jackknife_error, jackknife_least_squares, rms, time_derivative
from solvers.problems import PROBLEMS
from solvers.scene.scene import Scene
from solvers.translatable_message import Message

AMPLITUDE, CLOCK = "size of the motion", "times against the motion"
UNIT = "of the motion"
FEWEST_TIMES = 5
TURNS = 4  # of Gauss and Newton, each of which moves the exact motion to the times found
FARTHEST = 0.25  # of a period, by which the motion may be late; beyond, another of its turns fits as well
CLOSE = 1e-4  # of a period, over which the rate of the exact motion is a difference
LEAST = 5e-3  # of the motion, from which on its size is told
SURE = 4.0  # times the uncertainty
#: Times the error that is left, which a size must make to be blamed, and to be remarked on: a grid leaves more than it
#: shrinks the motion.
TELLS, TOLD = 10.0, 1.0
#: Of a period, which a motion must last before its size, and a trend of it, can be told from a phase.
SHORTEST, WHOLE = 0.6, 0.75
DISPERSION = 1 / 6  # of (k h)^2: by so much waves of a grid may be slower; 1/24 with hats and lumped masses
CLOCK_OFF, CLOCK_TELLS = 2e-3, 2.5  # of the time; times the error that is left, which a clock must make to be told
#: The same of a motion that is faster than its times, which no grid makes: masses that are lumped slow waves down.
FAST_SURE, FAST_TELLS = 6.0, 1.0
TOO_LARGE = "the errors are too large"
FEW = Message("fewer than {least} times, or not the same particles at all of them", FEWEST_TIMES)


@dataclass(frozen=True)
class MotionFit:
    """Fit of a motion: ``found`` has the factor a, growth b (1/s), lag (s) and pace, from all times in the first row
    and without one group of times in each other (1 + n, 4). ``moved`` is the exact displacement at the times found and
    ``rate`` its rate, ``rest`` what is left, (T, P, D), in m and m/s."""

    times: np.ndarray
    found: np.ndarray
    moved: np.ndarray
    rate: np.ndarray
    rest: np.ndarray


def fit_motion(tracks: ParticleTrajectories, scene: Scene) -> MotionFit | None:
    """Returns the fit of the particles' motion by the exact one; None where its errors are too large. Without a
    solution for any time that at the times of the files is used, to first order."""
    t, displacement = tracks.time[:, None, None], tracks.own["x"] - tracks.material_position
    lag = pace = 0.0
    for _ in range(TURNS if scene.solution_known else 1):
        moved, rate = _exact_motion(tracks, scene, tracks.time - lag - pace * tracks.time)
        sizes = [moved, t * moved] if scene.swings else [0 * moved] * 2  # a drift that is smaller is just slower
        parts = [*sizes, -rate, -t * rate]
        found, _ = jackknife_least_squares(displacement - moved, parts)
        rest = displacement - moved - sum(part * share for part, share in zip(parts, found[0], strict=True))
        found[:, 2:] += (lag, pace)
        lag, pace = found[0, 2:].tolist()
        if not abs(lag) + abs(pace) * tracks.time[-1] < FARTHEST * scene.period:
            return None
    return MotionFit(tracks.time, found, moved, rate, rest)


def _exact_motion(tracks: ParticleTrajectories, scene: Scene, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Returns the exact displacements in m and their rates in m/s (T, P, D) at the times (T,) in s."""
    X, near = tracks.material_position, CLOSE * scene.period
    if not scene.solution_known:
        return tracks.exact["x"] - X, time_derivative(tracks.time, tracks.exact["x"])
    reference = PROBLEMS[scene.problem].reference
    at, before, after = (np.stack([reference.displacement(scene, X, float(one)) for one in times + shift])
                         for shift in (0.0, -near, near))
    return at, (after - before) / (2 * near)


def check_amplitude_and_clock(evidence: FindingsInput) -> tuple[Finding, Finding]:
    """Checks the size of the motion, its damping, and its pace against the times in the files."""
    tracks, scene = evidence.tracks, evidence.scene
    if tracks is None or len(tracks.time) < FEWEST_TIMES:
        return unknown(AMPLITUDE, FEW), unknown(CLOCK, FEW)
    fit = fit_motion(tracks, scene)
    if fit is None:
        return unknown(AMPLITUDE, TOO_LARGE), unknown(CLOCK, TOO_LARGE)
    if not scene.swings:
        size = unknown(AMPLITUDE, "nothing swings, so that a motion that is too small is too slow")
    elif np.ptp(tracks.time) < SHORTEST * scene.period:
        size = unknown(AMPLITUDE, "too little of a period to tell a motion that is too small from one that is late")
    else:
        size = _check_amplitude(fit, scene.period)
    return size, _check_clock(fit, scene, rms(tracks.own["x"] - tracks.exact["x"]))


def _check_amplitude(fit: MotionFit, period: float) -> Finding:
    """Checks the amplitude of a fit: its mean, and where a trend is certain its value at the end; ``period`` in s."""
    (a, b), t = fit.found[:, :2].T, fit.times
    weight = np.sum(fit.moved**2, axis=(1, 2))
    trend = t[-1] - t[0] >= WHOLE * period and abs(b[0]) > SURE * jackknife_error(b)
    sizes = a + b * (t[-1] if trend else float(np.sum(weight * t) / np.sum(weight)))
    size, made = abs(float(sizes[0])), rms((a[0] + b[0] * t)[:, None, None] * fit.moved)
    left = rms(fit.rest) / made * size if made > 0 else 0.0
    least = max(LEAST, SURE * jackknife_error(sizes))
    tolerance = max(least, TELLS * left)
    if not np.isfinite(tolerance + size):
        return unknown(AMPLITUDE, TOO_LARGE)
    which = Message("too small" if sizes[0] < 0 else "too large")
    says = Message("the motion is {percent:.2g} % {which}", 100 * size, which)
    if trend:
        how = Message("shrinks" if b[0] < 0 else "grows")
        says = Message("the motion is {percent:.2g} % {which} at the end and {how} by {rate:.2g} % a period",
                       100 * size, which, how, 100 * abs(float(b[0])) * period)
    if size > tolerance:
        return Finding(AMPLITUDE, OFF, size, tolerance, UNIT, says)
    return Finding(AMPLITUDE, HOLDS, size, tolerance, UNIT, says if size > max(least, TOLD * left) else "")


def _check_clock(fit: MotionFit, scene: Scene, error: float) -> Finding:
    """Checks the pace of a fit: of times that are too long or too short the ``error`` of x, RMS in m, grows with the
    velocity."""
    slow, t = float(fit.found[0, 3]), fit.times[:, None, None]
    growing = t * fit.rate
    apart, _ = jackknife_least_squares(growing, [fit.rate])  # what of a growing lag is not a lag that stays
    size = rms(growing - apart[0, 0] * fit.rate)
    grid = DISPERSION * (scene.angular_frequency * scene.spacing / scene.wave_speed) ** 2
    left = rms(fit.rest) / size if size > 0 else np.inf
    tolerance = max(CLOCK_OFF, grid, CLOCK_TELLS * left) if slow > 0 else \
        max(CLOCK_OFF, FAST_SURE * jackknife_error(fit.found[:, 3]), FAST_TELLS * left)
    if not np.isfinite(tolerance + slow):
        return unknown(CLOCK, TOO_LARGE if size > 0 else "nothing moves by which a clock could be told")
    if abs(slow) <= tolerance:
        return Finding(CLOCK, HOLDS, abs(slow), tolerance, "of the time",
                       Message("smaller differences are below the error of x, or the waves of the grid"))
    pace = Message("slower" if slow > 0 else "faster")
    return Finding(CLOCK, OFF, abs(slow), tolerance, "of the time",
                   Message("the motion is {percent:.2g} % {pace} than its times imply: with all times multiplied by "
                           "{factor:.4f}, the error of x would be {rest:.2g} of its value; the times are wrong, or the "
                           "input that sets the speed", 100 * abs(slow), pace, 1 - slow, rms(fit.rest) / error))
