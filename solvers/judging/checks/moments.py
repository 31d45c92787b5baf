"""Whether what a file has at one time is all of one moment, and whether its clock is right.

A quantity that is late by tau has the error -tau times its rate. That is found by least squares over all particles and
times, beside what a grid's smoothing and a wrong size would leave.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from solvers.judging.checks.check import HOLDS, OFF, Check, unknown
from solvers.judging.checks.evidence import Evidence
from solvers.judging.checks.over_time import rate, rms

FEWEST_TIMES = 5
GROUPS = 10  # of times, each left out once to see how sure a number is
SURE, SMOOTHED = 6.0, 3.0  # times that uncertainty; times what smoothing can make of the error of v
UNSURE = "less hides in the errors, or between the few times"
VELOCITY, STRESS, CLOCK = ("moment of the velocities before that of the positions",
                           "moment of F or the stress before that of the positions", "times against the motion")
STEPS = "steps"
HALF = 0.5  # of a step: what leapfrog's velocities are of, and 0 what others' are
DISPERSION = 1 / 6  # of (k h)^2: by so much waves of a grid may be slower; 1/24 with hats and lumped masses
SLACK = 0.25  # of a step
CLOCK_OFF, TELLS = 2e-3, 2.5  # of the time; times the error that is left, which a clock must make to be told
#: The same of a motion that is faster than its times, which no grid makes: masses that are lumped slow waves down. Of
#: 65 sound runs drawn at random none was fast by more than 3.6 times the uncertainty and .2 % at once; of 74 others,
#: which these numbers were not set on, none was called fast.
FAST_SURE, FAST_TELLS = 4.0, 1.0
TOO_LARGE = "the errors are too large"
FEW = f"fewer than {FEWEST_TIMES} times, or not the same particles at all of them"


def velocity(evidence: Evidence) -> Check:
    """Positions grow by the velocities: over each interval the trapezoid rule of the errors of v is held against what
    the error of x grows by. Both are small and smooth in time, so that few times are enough."""
    tracks, step = evidence.tracks, evidence.step
    if tracks is None or len(tracks.time) < FEWEST_TIMES or "v" not in tracks.exact:
        return unknown(VELOCITY, FEW if "v" in evidence.errors[0] else "no velocities in the files")
    x, v = (tracks.own[q] - tracks.exact[q] for q in ("x", "v"))
    interval = np.diff(tracks.time)[:, None, None]
    gap = 0.5 * interval * (v[1:] + v[:-1]) - np.diff(x, axis=0)
    moved, gained = np.diff(tracks.exact["x"], axis=0), np.diff(tracks.exact["v"], axis=0)
    late, sure = fitted(gap, [-gained, moved])
    slack = (SURE * sure[0] + _of_size(late[0, 1], v, rate(tracks.time, tracks.exact["v"]))) / step
    return _told(VELOCITY, late[0, 0] / step, slack, (-SLACK, HALF + SLACK), step, "the velocities are")


def stress(evidence: Evidence) -> Check:
    """What the errors of the stress and of x say of how late each is."""
    tracks, step = evidence.tracks, evidence.step
    if tracks is None or len(tracks.time) < FEWEST_TIMES or "sigma" not in tracks.exact:
        return unknown(STRESS, FEW if "sigma" in evidence.errors[0] else "no F and no stress in the files")
    sigma, x = (tracks.own[q] - tracks.exact[q] for q in ("sigma", "x"))
    speed = rate(tracks.time, tracks.exact["x"])
    parts = [-rate(tracks.time, tracks.exact["sigma"]), tracks.exact["sigma"]]
    of_place = [-speed, tracks.exact["x"] - tracks.material_position]
    outwards = np.argsort(np.linalg.norm(tracks.material_position - tracks.material_position.mean(axis=0), axis=1),
                          kind="stable")
    late = [(fitted(turn(sigma), [turn(part) for part in parts])[0]
             - fitted(turn(x), [turn(part) for part in of_place])[0])[:, 0] / step
            for turn in (lambda values: values, lambda values: np.moveaxis(values[:, outwards], 0, 1))]
    # What is really late is so at all times and everywhere, and of the right size.
    slack = SURE * max(map(_spread, late)) + _of_size(fitted(sigma, parts)[0][0, 1], sigma, parts[0]) / step
    return _told(STRESS, float(late[0][0]), slack, (-HALF, HALF), step, "F or the stress is")


def clock(evidence: Evidence) -> Check:
    """A clock that runs fast or slow leaves an error that grows with time as the motion's rate does."""
    tracks = evidence.tracks
    if tracks is None or len(tracks.time) < FEWEST_TIMES:
        return unknown(CLOCK, FEW)
    x, speed = tracks.own["x"] - tracks.exact["x"], rate(tracks.time, tracks.exact["x"])
    growing = tracks.time[:, None, None] * speed
    found, sure = fitted(x, [-speed, -growing])
    late, slow = found[0]
    rest = x + late * speed + slow * growing
    apart, _ = fitted(growing, [speed])  # what of a growing lag is not a lag that stays
    alone = growing - apart[0, 0] * speed
    size = rms(alone)
    scene = evidence.scene
    grid = DISPERSION * (scene.angular_frequency * scene.spacing / scene.wave_speed) ** 2
    left = rms(rest) / size if size > 0 else np.inf
    tolerance = max(CLOCK_OFF, grid, TELLS * left) if slow > 0 else \
        max(CLOCK_OFF, FAST_SURE * float(sure[1]), FAST_TELLS * left)
    if not np.isfinite(tolerance + slow):
        return unknown(CLOCK, TOO_LARGE if size > 0 else "nothing moves by which a clock could be told")
    if abs(slow) <= tolerance:
        return Check(CLOCK, abs(slow), tolerance, "of the time", HOLDS,
                     "one that is less off hides in the error of x, or in the waves of the grid")
    pace = "slower" if slow > 0 else "faster"
    return Check(CLOCK, abs(slow), tolerance, "of the time", OFF,
                 f"the motion is {100 * abs(slow):.2g} % {pace} than its times say: with {1 - slow:.4f} times each the "
                 f"error of x would be {rms(rest) / rms(x):.2g} of what it is; the times are others, or what sets the "
                 "pace")


def fitted(target: np.ndarray, parts: Sequence[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """How much of each part (T, ...) is in the target (T, ...), by least squares: first of all times, then with each
    group of times left out (1 + n, parts); and how sure the numbers are (parts,), by the jackknife."""
    def products(one: np.ndarray, other: np.ndarray) -> np.ndarray:
        return (one * other).reshape(len(one), -1).sum(axis=1)

    scale = [rms(part) or 1.0 for part in parts]
    scaled = [part / size for part, size in zip(parts, scale, strict=True)]
    matrix = np.array([[products(one, other) for other in scaled] for one in scaled])
    right, T = np.array([products(one, target) for one in scaled]), len(target)

    if not (np.isfinite(matrix).all() and np.isfinite(right).all()):
        return np.full((2, len(parts)), np.nan), np.full(len(parts), np.nan)

    def solved(kept: np.ndarray) -> np.ndarray:
        return np.linalg.lstsq(matrix[:, :, kept].sum(axis=2), right[:, kept].sum(axis=1), rcond=1e-12)[0]

    every = np.arange(T)
    left_out = [solved(np.setdiff1d(every, group)) for group in np.array_split(every, min(T, GROUPS))]
    found = np.array([solved(every), *left_out]) / np.array(scale)
    return found, np.array([_spread(column) for column in found.T])


def _spread(found: np.ndarray) -> float:
    """The standard error of a number of which the first is that of all and the others miss a group each."""
    others = found[1:]
    return float(np.sqrt((len(others) - 1) / len(others) * np.sum((others - others.mean()) ** 2)))


def _of_size(part: float, error: np.ndarray, slope: np.ndarray) -> float:
    """In s, what may look late and is none: a grid smooths the motion by a ``part``, and its errors by such a part."""
    return SMOOTHED * abs(part) * rms(error) / max(rms(slope), 1e-300)


def _told(name: str, steps: float, slack: float, allowed: tuple[float, float], step: float, who: str) -> Check:
    """Late by so many ``steps``, where so many are ``allowed`` and ``slack`` is how sure that is."""
    if not np.isfinite(steps + slack):
        return unknown(name, TOO_LARGE)
    least, most = allowed
    tolerance = slack + abs(least if steps < 0.5 * (least + most) else most)
    if least - slack <= steps <= most + slack:
        return Check(name, steps, tolerance, STEPS, HOLDS, UNSURE if slack > HALF else "")
    when = "before" if steps > 0 else "after"
    return Check(name, steps, tolerance, STEPS, OFF,
                 f"{who} of a moment {abs(steps) * step:.3g} s {when} that of the positions, {abs(steps):.2g} "
                 f"times the step ({step:.3g} s)")
