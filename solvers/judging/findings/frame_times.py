"""Checks that the motion goes on from frame to frame as the times in the files do.

Each frame is dated by itself: its time is that at which the exact motion is nearest to its positions and velocities,
each weighed by its own error. A clock of the motion that stops, jumps or runs backwards between frames shows frames
that are exchanged, repeated or missing, and times in another unit, long before a lag of the whole motion would.
"""

from dataclasses import dataclass

import numpy as np

from solvers.judging.findings.finding import HOLDS, OFF, Finding, unknown
from solvers.judging.findings.findings_input import FindingsInput, ParticleTrajectories, largest_stored_rounding
from solvers.judging.findings.time_consistency import FEW, FEWEST_TIMES, TOO_LARGE
from solvers.problems import PROBLEMS
from solvers.scene.scene import Scene
from solvers.translatable_message import Message

NAME = "times from frame to frame"
FOLLOWED = 300  # particles
DATES = 120  # times in a period that are tried, between which a parabola is fitted
SURE = 3.0  # times the uncertainty of an interval, by which one may be off; sound runs of ours reached 1.4
OFF_BY = 0.4  # of an interval: a frame that is missing makes 0.5 of it, and no method so much of a motion that holds
ROUNDS = 3  # of weighing positions and velocities by what is left of them
LOST = 0.3  # of the motion: frames farther from it at all times have no date
LEAST_LEFT = 1e-6  # of the mean square of a quantity: what is taken to be left of it at least


@dataclass(frozen=True)
class FrameDates:
    """Times (T,) in s within a period at which the exact motion is nearest to each of T frames, and by how much the one
    from a frame to the next is uncertain (T - 1,) in s: what is left of the motion changes by as much between them."""

    dates: np.ndarray
    uncertainty: np.ndarray


def date_frames(tracks: ParticleTrajectories, scene: Scene) -> FrameDates:
    """Returns the dates of the frames by their positions and velocities."""
    some = slice(None, None, -(-len(tracks.material_position) // FOLLOWED))
    X, reference, step = tracks.material_position[some], PROBLEMS[scene.problem].reference, scene.period / DATES
    exact = {"x": reference.displacement, "v": reference.velocity}
    seen = {"x": tracks.own["x"][:, some] - X, "v": tracks.own["v"][:, some]}

    def solution(times: np.ndarray) -> dict[str, np.ndarray]:
        return {q: np.stack([exact[q](scene, X, float(t)).ravel() for t in times]) for q in seen}

    own, tried = {q: values.reshape(len(values), -1) for q, values in seen.items()}, solution(step * np.arange(DATES))
    squares = {q: _mean_squares(own[q], tried[q]) for q in seen}
    weight = {q: 1 / float(np.mean(tried[q] ** 2)) for q in seen}
    rows = np.arange(len(tracks.time))
    for _ in range(ROUNDS):
        far = np.sum([squares[q] * weight[q] for q in seen], axis=0)
        best = np.argmin(far, axis=1)
        weight = {q: 1 / max(float(np.median(squares[q][rows, best])), LEAST_LEFT * float(np.mean(tried[q]**2)))
                  for q in seen}
    before, here, after = (far[rows, (best + shift) % DATES] for shift in (-1, 0, 1))
    bend = np.maximum(before - 2 * here + after, 1e-300)
    dates = step * (best + np.clip(0.5 * (before - after) / bend, -0.5, 0.5))
    left = {q: own[q] - found for q, found in solution(dates).items()}
    rounding = {q: largest_stored_rounding(list(tracks.own[q])) for q in seen}
    changes = np.sum([(np.mean(np.diff(left[q], axis=0)**2, axis=1) + 2 * rounding[q]**2) * weight[q] for q in seen],
                     axis=0)
    rate = 0.5 * bend / step**2  # mean square of the weighed motion's rate
    parts = [np.mean(left[q]**2, axis=1) / float(np.mean(tried[q]**2)) for q in seen]
    lost = np.mean(parts, axis=0) > LOST**2
    uncertain = np.sqrt(changes / np.minimum(rate[1:], rate[:-1]))
    return FrameDates(dates, np.where(lost[1:] | lost[:-1], np.inf, uncertain))


def _mean_squares(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Returns the mean square (T, M) of each difference of fields (T, n) and (M, n)."""
    square = (one**2).sum(axis=1)[:, None] - 2 * one @ other.T + (other**2).sum(axis=1)
    return np.maximum(square, 0.0) / one.shape[1]


def check_frame_times(evidence: FindingsInput) -> Finding:
    """Checks for each interval between frames that the motion goes on by as much as the times say, within a period."""
    tracks, scene = evidence.tracks, evidence.scene
    if tracks is None or len(tracks.time) < FEWEST_TIMES:
        return unknown(NAME, FEW)
    if "v" not in tracks.own:
        return unknown(NAME, "no velocities in the files, without which a motion that returns has two dates")
    if not (scene.solution_known and scene.swings):
        return unknown(NAME, "the solution is not known at every time, or does not return")
    found, said = date_frames(tracks, scene), np.diff(tracks.time)
    gone, due = (_within_half(scene.period, interval) for interval in (np.diff(found.dates), said))
    off, interval = np.abs(_within_half(scene.period, gone - due)), np.maximum(np.abs(gone), np.abs(due))
    limit = np.maximum(OFF_BY * interval, SURE * found.uncertainty)
    if not np.isfinite(off).all():
        return unknown(NAME, TOO_LARGE)
    wrong = off > limit
    k = int(np.argmax(wrong)) if wrong.any() else int(np.argmax(off / limit))
    if not wrong.any():
        return Finding(NAME, HOLDS, float(off[k]), float(limit[k]), "s")
    if np.median(gone / due) < -1 + OFF_BY:
        says = Message("from frame to frame the motion runs backwards: v has the other sign, or the times")
    else:
        says = Message("from t = {first:.4g} to {second:.4g} s the motion goes on by {gone:.3g} s, not by {said:.3g} s "
                       "({count:,} of {every:,} intervals between frames are off): frames are exchanged, repeated or "
                       "missing, or times are in another unit", tracks.time[k], tracks.time[k + 1], gone[k], said[k],
                       int(wrong.sum()), len(said))
    return Finding(NAME, OFF, float(off[k]), float(limit[k]), "s", says)


def _within_half(period: float, times: np.ndarray) -> np.ndarray:
    """Returns the times in s less whole periods, from half a period before 0 to half of one after it."""
    return (times + 0.5 * period) % period - 0.5 * period
