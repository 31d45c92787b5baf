"""Checks that the motion is as large as it should be and keeps its size, and that the clock is right.

Errors of the displacement are fitted by what a factor, damping or growth makes of the exact one, alone and together
with a wrong clock (a lag and a pace) and with the body's free vibration, which a grid excites and slows down: it swells
and shrinks by beats with the motion that a force drives. Of these fits the one is used that best tells times that it
has not seen, so that few times are fitted by little; what others make of the same number adds to its uncertainty.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from solvers.judging.findings.finding import HOLDS, OFF, Finding, unknown
from solvers.judging.findings.findings_input import FindingsInput, ParticleTrajectories
from solvers.judging.findings.time_series_fitting import (
    cross_validation_error,
    jackknife_error,
    jackknife_least_squares,
    rms,
    time_derivative,
)
from solvers.problems import PROBLEMS
from solvers.scene.scene import Scene
from solvers.translatable_message import Message

AMPLITUDE, CLOCK = "size of the motion", "times against the motion"
UNIT = "of the motion"
FEWEST_TIMES = 5
TURNS = 4  # of Gauss and Newton, each of which moves the exact motion to the times found
FARTHEST = 0.25  # of a period, by which the motion may be late; beyond, another of its turns fits as well
CLOSE = 1e-4  # of a period, over which the rate of the exact motion is a difference
TOLD, BLAMED = 3e-3, 5e-3  # of the motion, from which on its size is told, and blamed
SURE = 3.0  # times the standard error, more with hardly more times than numbers fitted
AS_GOOD = 2.0  # times the least mean square error of prediction, up to which another fit may be the right one
CANCELS = 1.5  # times the whole error: sizes beyond, which the other parts of a fit cancel, are none
FINEST = 2e-3  # of the motion, to which its size is told at best: the fit is linear
#: Times all other errors, which a size must make to be blamed: a grid leaves more than it shrinks the motion.
TELLS = 10.0
APART = 0.1  # of the motion's frequency, by which one of a free vibration must differ, so that they can be told apart
SHORTEST = 0.5  # of a period, which a motion must last before its size can be told from its pace, a phase or a trend
DISPERSION = 1 / 6  # of (k h)^2: by so much waves of a grid may be slower; 1/24 with hats and lumped masses
CLOCK_OFF = 2e-3  # of the time
TOO_SHORT = "too little of a period to tell a motion that is too small from one that is late or slow"
TOO_LARGE = "the errors are too large"
FEW = Message("fewer than {least} times, or not the same particles at all of them", FEWEST_TIMES)


@dataclass(frozen=True)
class MotionFit:
    """Fit of the error of the displacement: ``found`` has the factor a, growth b (1/s), with a ``clock`` lag (s) and
    pace, and the parts of a free vibration if any, from all times in the first row and without one group of times in
    each other (1 + n, 2 to 6), ``freedom`` times more. In m: ``error`` of the displacement (T, P, D), that ``beside``
    its size, that ``moved`` to the times found, and the RMS ``missed`` at times that the fit has not seen."""

    found: np.ndarray
    clock: bool
    freedom: int
    error: np.ndarray
    beside: np.ndarray
    moved: np.ndarray
    missed: float


def fit_motion(tracks: ParticleTrajectories, scene: Scene) -> list[MotionFit]:
    """Returns the fits of the particles' motion by the exact one, the one that predicts best first; none with a clock
    where that is off too far, none with more numbers than there are times, none that is a difference of large parts."""
    free = free_vibration(tracks, scene)
    slower = [tracks.time[:, None, None] * part for part in free]  # by its grid, to first order
    fits = [_fit_with(tracks, scene, clock, beside) for clock, beside in (
        (False, ()), (True, ()), *(((False, free), (True, free), (False, [*free, *slower])) if free else ()))]
    return sorted((fit for fit in fits if fit is not None and rms(fit.error - fit.beside) <= CANCELS * rms(fit.error)),
                  key=lambda fit: fit.missed)


def _fit_with(tracks: ParticleTrajectories, scene: Scene, clock: bool,
              beside: Sequence[np.ndarray]) -> MotionFit | None:
    """Returns a fit by a size, a ``clock`` or none, and motions ``beside`` these, (T, P, D) in m. Without a solution
    for any time that at the times of the files is used, to first order."""
    t, displacement = tracks.time[:, None, None], tracks.own["x"] - tracks.material_position
    lag = pace = 0.0
    for _ in range(TURNS if clock and scene.solution_known else 1):
        moved, rate = _exact_motion(tracks, scene, tracks.time - lag - pace * tracks.time)
        sizes = [moved, t * moved] if scene.swings else [0 * moved] * 2  # a drift that is smaller is just slower
        parts = [*sizes, *((-rate, -t * rate) if clock else ()), *beside]
        if len(t) <= len(parts):
            return None
        found, _ = jackknife_least_squares(displacement - moved, parts)
        missed = cross_validation_error(displacement - moved, parts, found)
        if clock:
            found[:, 2:4] += (lag, pace)
            lag, pace = found[0, 2:4].tolist()
        if not abs(lag) + abs(pace) * tracks.time[-1] < FARTHEST * scene.period:
            return None
    error = tracks.own["x"] - tracks.exact["x"]
    size = found[0, 0] * sizes[0] + found[0, 1] * sizes[1]
    return MotionFit(found, clock, len(t) - len(parts), error, error - size, displacement - moved, missed)


def free_vibration(tracks: ParticleTrajectories, scene: Scene) -> list[np.ndarray]:
    """Returns the free vibration in the shape of the motion, (T, P, D) in m, as a cosine and a sine; none where that
    has the frequency of the motion. By Rayleigh's quotient, the square of its frequency is
    that of the motion and the body force over the displacement."""
    if not (scene.solution_known and scene.swings):
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
    fits = fit_motion(tracks, scene)
    if not (fits and np.isfinite(fits[0].missed)):
        return unknown(AMPLITUDE, TOO_LARGE), unknown(CLOCK, TOO_LARGE)
    clock = _check_clock(fits, scene)
    if not scene.swings:
        return unknown(AMPLITUDE, "nothing swings, so that a motion that is too small is too slow"), clock
    if np.ptp(tracks.time) < SHORTEST * scene.period:
        return unknown(AMPLITUDE, TOO_SHORT), unknown(CLOCK, TOO_SHORT)
    return _check_amplitude(fits, tracks.time, scene.period), clock


def _value_and_doubt(fits: Sequence[MotionFit], number: Callable[[np.ndarray], np.ndarray]) -> tuple[float, float]:
    """Returns a number, computed from the columns of ``found``, of the first fit, and its uncertainty: by the times,
    and by the other fits that predict as well."""
    best, *others = (number(fit.found.T) for fit in fits if fit.missed**2 <= AS_GOOD * fits[0].missed**2)
    sure = SURE * (1 + 1 / fits[0].freedom) * jackknife_error(best)
    return float(best[0]), max([sure, *(abs(float(other[0] - best[0])) for other in others)])


def _check_amplitude(fits: Sequence[MotionFit], times: np.ndarray, period: float) -> Finding:
    """Checks the amplitude: its mean over the times in s, and where a trend is certain its value at the end; ``period``
    in s."""
    best = fits[0]
    slope, slack = _value_and_doubt(fits, lambda found: found[1])
    trend = abs(slope) > slack
    at = float(times[-1] if trend else times.mean())
    factor, unsure = _value_and_doubt(fits, lambda found: found[0] + at * found[1])
    size, doubt, made = abs(factor), max(FINEST, unsure), rms(best.error - best.beside)
    tolerance = max(BLAMED, doubt, TELLS * rms(best.beside) / made * size if made > 0 else 0.0)
    values = {"percent": 100 * size, "doubt": 100 * doubt, "which": Message("too small" if factor < 0 else "too large")}
    says = Message("the motion is {percent:.2g} ± {doubt:.2g} % {which}", **values)
    if trend:
        says = Message("the motion is {percent:.2g} ± {doubt:.2g} % {which} at the end and {how} by {rate:.2g} ± "
                       "{rate_doubt:.2g} % a period", **values, how=Message("shrinks" if slope < 0 else "grows"),
                       rate=100 * abs(slope) * period, rate_doubt=100 * max(FINEST, slack * period))
    if (vibration := float(np.linalg.norm(best.found[0, 2 + 2 * best.clock:][:2]))) > TOLD:
        says = Message("{motion}, a free vibration of {vibration:.2g} % aside", says, 100 * vibration)
    if size > tolerance:
        return Finding(AMPLITUDE, OFF, size, tolerance, UNIT, says)
    return Finding(AMPLITUDE, HOLDS, size, tolerance, UNIT, says if size > max(TOLD, doubt) else "")


def _check_clock(fits: Sequence[MotionFit], scene: Scene) -> Finding:
    """Checks the pace: a clock is wrong where no fit without one predicts as well, and no grid makes waves so slow."""
    best = next((fit for fit in fits if fit.clock), None)
    if best is None:
        return unknown(CLOCK, TOO_LARGE)
    pace, doubt = _value_and_doubt([fit for fit in fits if fit.clock], lambda found: found[3])
    grid = DISPERSION * (scene.angular_frequency * scene.spacing / scene.wave_speed) ** 2
    tolerance = max(CLOCK_OFF, doubt, grid if pace > 0 else 0.0)
    needed = all(fit.clock or fit.missed**2 > AS_GOOD * best.missed**2 for fit in fits)
    if abs(pace) <= tolerance or not needed:
        return Finding(CLOCK, HOLDS, abs(pace), tolerance, "of the time",
                       Message("smaller differences are below the error of x, or the waves of the grid"))
    how = Message("slower" if pace > 0 else "faster")
    return Finding(CLOCK, OFF, abs(pace), tolerance, "of the time",
                   Message("the motion is {percent:.2g} % {pace} than its times imply: with all times multiplied by "
                           "{factor:.4f}, the error of x would be {rest:.2g} of its value; the times are wrong, or the "
                           "input that sets the speed", 100 * abs(pace), how, 1 - pace,
                           rms(best.moved) / rms(best.error)))
