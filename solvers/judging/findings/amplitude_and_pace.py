"""Checks that the motion is as large as it should be and keeps its size, and that the clock is right.

Displacements are fitted by (1 + a + b t) u(t - lag - pace t), with the exact u: by a constant factor, damping or
growth, a lag, and a pace, all together, because a motion out of phase looks smaller than one in phase. A body whose
motion a force drives also vibrates freely where it errs, and swells and shrinks by beats: that is fitted as well.
"""

from collections.abc import Sequence
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
FEWEST_TIMES, FEWEST_TIMES_OF_BEATS = 5, 10
TURNS = 4  # of Gauss and Newton, each of which moves the exact motion to the times found
FARTHEST = 0.25  # of a period, by which the motion may be late; beyond, another of its turns fits as well
CLOSE = 1e-4  # of a period, over which the rate of the exact motion is a difference
TOLD, BLAMED = 3e-3, 5e-3  # of the motion, from which on its size is told, and blamed
SURE = 3.0  # times the standard error
FINEST = 2e-3  # of the motion, to which its size is told at best: the fit is linear
#: Times the error that is left, which a size must make to be blamed: a grid leaves more than it shrinks the motion.
TELLS = 10.0
APART = 0.1  # of the motion's frequency, by which one of a free vibration must differ, so that they can be told apart
SHORTEST = 0.75  # of a period, which a motion must last before its size can be told from its pace, a phase or a trend
DISPERSION = 1 / 6  # of (k h)^2: by so much waves of a grid may be slower; 1/24 with hats and lumped masses
CLOCK_OFF, CLOCK_TELLS = 2e-3, 2.5  # of the time; times the error that is left, which a clock must make to be told
#: The same of a motion that is faster than its times, which no grid makes: masses that are lumped slow waves down.
FAST_SURE, FAST_TELLS = 6.0, 1.0
TOO_SHORT = "too little of a period to tell a motion that is too small from one that is late or slow"
TOO_LARGE = "the errors are too large"
FEW = Message("fewer than {least} times, or not the same particles at all of them", FEWEST_TIMES)


@dataclass(frozen=True)
class MotionFit:
    """Fit of a motion: ``found`` has the factor a, growth b (1/s), lag (s), pace, and the parts of a free vibration if
    any, from all times in the first row and without one group of times in each other (1 + n, 4 or 6). ``moved`` is the
    exact displacement at the times found and ``rate`` its rate, ``rest`` what is left, (T, P, D), in m and m/s."""

    times: np.ndarray
    found: np.ndarray
    moved: np.ndarray
    rate: np.ndarray
    rest: np.ndarray


def fit_motion(tracks: ParticleTrajectories, scene: Scene, beside: Sequence[np.ndarray] = ()) -> MotionFit | None:
    """Returns the fit of the particles' motion by the exact one and motions ``beside`` it, (T, P, D) in m; None where
    its errors are too large. Without a solution for any time that at the times of the files is used, to first order."""
    t, displacement = tracks.time[:, None, None], tracks.own["x"] - tracks.material_position
    lag = pace = 0.0
    for _ in range(TURNS if scene.solution_known else 1):
        moved, rate = _exact_motion(tracks, scene, tracks.time - lag - pace * tracks.time)
        sizes = [moved, t * moved] if scene.swings else [0 * moved] * 2  # a drift that is smaller is just slower
        parts = [*sizes, -rate, -t * rate, *beside]
        found, _ = jackknife_least_squares(displacement - moved, parts)
        rest = displacement - moved - sum(part * share for part, share in zip(parts, found[0], strict=True))
        found[:, 2:4] += (lag, pace)
        lag, pace = found[0, 2:4].tolist()
        if not abs(lag) + abs(pace) * tracks.time[-1] < FARTHEST * scene.period:
            return None
    return MotionFit(tracks.time, found, moved, rate, rest)


def free_vibration(tracks: ParticleTrajectories, scene: Scene) -> list[np.ndarray]:
    """Returns the free vibration in the shape of the motion, (T, P, D) in m, as a cosine and a sine; none where that
    has the frequency of the motion, or there are too few times. By Rayleigh's quotient, the square of its frequency is
    that of the motion and the body force over the displacement."""
    if not (scene.solution_known and scene.swings and len(tracks.time) >= FEWEST_TIMES_OF_BEATS):
        return []
    X, t = tracks.material_position, scene.period / 4
    reference, w = PROBLEMS[scene.problem].reference, scene.angular_frequency
    shape = reference.displacement(scene, X, t)
    square = w * w + float(np.sum(shape * reference.body_force(scene, X, t)) / np.sum(shape**2))
    if not square > 0 or abs(np.sqrt(square) - w) < APART * w:
        return []
    turn = np.sqrt(square) * tracks.time[:, None, None]
    return [np.cos(turn) * shape, np.sin(turn) * shape]


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
    clock = _check_clock(fit, scene, rms(tracks.own["x"] - tracks.exact["x"]))
    if not scene.swings:
        return unknown(AMPLITUDE, "nothing swings, so that a motion that is too small is too slow"), clock
    if np.ptp(tracks.time) < SHORTEST * scene.period:
        return unknown(AMPLITUDE, TOO_SHORT), unknown(CLOCK, TOO_SHORT)
    beside = free_vibration(tracks, scene)
    return _check_amplitude(fit, fit_motion(tracks, scene, beside) if beside else None, scene.period), clock


def _check_amplitude(fit: MotionFit, with_beats: MotionFit | None, period: float) -> Finding:
    """Checks the amplitude of a fit: its mean, and where a trend is certain its value at the end; ``period`` in s. The
    fit ``with_beats`` is used where its trend is the more certain one."""
    t = fit.times
    best = min([fit, *([with_beats] if with_beats else [])], key=lambda one: jackknife_error(one.found[:, 1]))
    a, b = best.found[:, :2].T
    slope, slack = abs(float(b[0])), SURE * jackknife_error(b)
    trend = slope > slack
    sizes = a + b * (t[-1] if trend else t.mean())
    size, made = abs(float(sizes[0])), rms((a[0] + b[0] * t)[:, None, None] * best.moved)
    left = rms(fit.rest) / made * size if made > 0 else 0.0
    doubt = max(FINEST, SURE * jackknife_error(sizes))
    tolerance = max(BLAMED, doubt, TELLS * left)
    if not np.isfinite(tolerance + size):
        return unknown(AMPLITUDE, TOO_LARGE)
    values = {"percent": 100 * size, "doubt": 100 * doubt,
              "which": Message("too small" if sizes[0] < 0 else "too large")}
    says = Message("the motion is {percent:.2g} ± {doubt:.2g} % {which}", **values)
    if trend:
        says = Message("the motion is {percent:.2g} ± {doubt:.2g} % {which} at the end and {how} by {rate:.2g} ± "
                       "{rate_doubt:.2g} % a period", **values, how=Message("shrinks" if b[0] < 0 else "grows"),
                       rate=100 * slope * period, rate_doubt=100 * max(FINEST, slack * period))
    if (vibration := float(np.hypot(*best.found[0, 4:6])) if best is not fit else 0.0) > TOLD:
        says = Message("{motion}, a free vibration of {vibration:.2g} % aside", says, 100 * vibration)
    if size > tolerance:
        return Finding(AMPLITUDE, OFF, size, tolerance, UNIT, says)
    return Finding(AMPLITUDE, HOLDS, size, tolerance, UNIT, says if size > max(TOLD, doubt) else "")


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
