"""Whether the particles as a whole have gone aside, and whether axes were exchanged."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import fields, replace
from typing import Any

import numpy as np

from solvers.judging.checks.check import HOLDS, OFF, Check, unknown
from solvers.judging.checks.evidence import MOST_FOLLOWED, Evidence
from solvers.judging.checks.figures import kept, some
from solvers.judging.checks.nearby import MOST_ASKED, Nearby
from solvers.judging.checks.neighbours import departures, surroundings
from solvers.judging.checks.over_time import rms
from solvers.judging.frames import Frame
from solvers.judging.measure import Errors
from solvers.problems import PROBLEMS

ORDER = "particles where others should be"
DRIFT, AXES = "mean error of x, where symmetry allows none", "axes, and the components of F"
UNIT = "of the error of x"
ASIDE = 5e-3  # of the error's size
ROUNDED = 4.0  # times what rounding leaves of a mean
NOTHING = 1e-9  # of a cell: what the rounding of many steps may add up to
OTHERS = 0.1  # of the distance of particles: nearer to where another one should be than chance would have it
FAR, UNLIKE = 5.0, 0.5  # times that distance; of the error, by which it jumps from one particle to the next
SAME_PLACE = 1e-3  # of the distance of particles
FITS = 0.3  # of the error, that another reading of the file leaves at most
LOOKED_AT = 4  # frames


def order(evidence: Evidence) -> Check:
    """Whether the positions are right, and those of other particles: particles in another order."""
    frame, error = max(zip(evidence.frames, evidence.errors, strict=True), key=lambda pair: rms(pair[1]["x"]))
    apart = _distance(frame.material_position)
    if not np.isfinite(apart):
        return unknown(ORDER, "too few particles")
    around = Nearby(frame.position)
    far = np.minimum(around.among(frame.position - error["x"]), around.width)
    off, size = float(np.median(far)), float(np.median(np.linalg.norm(error["x"], axis=1)))
    near = surroundings(frame.material_position)
    jumps = 0.0 if near is None else float(np.median(departures(near, error["x"]))) / max(size, 1e-300)
    if size > FAR * apart and jumps > UNLIKE:
        return Check(ORDER, jumps, UNLIKE, "of the error of x", OFF,
                     f"at t = {frame.time:.4g} s the error of x jumps from particle to particle by as much as it is: "
                     "they may be numbered, or given X, in another order")
    nearer = apart / max(off, 1e-300) if size > apart else 0.0  # where all are where they belong so are the nearest
    if nearer < 1 / OTHERS:
        return Check(ORDER, nearer, 1 / OTHERS, "times nearer than the next particle", HOLDS)
    return Check(ORDER, nearer, 1 / OTHERS, "times nearer than the next particle", OFF,
                 f"at t = {frame.time:.4g} s most particles are where others should be, to {off:.2g} m: they are "
                 "numbered, or given X, in another order")


def drift(evidence: Evidence) -> Check:
    """The mean error over particles that lie symmetrically about the middle of a body that moves so is 0; of those that
    are the same with x and y exchanged it has no part across the diagonal."""
    frame = evidence.frames[0]
    across = _without_mean(evidence, frame.material_position)
    if across is None or any(not np.array_equal(f.number, frame.number) for f in evidence.frames):
        return unknown(DRIFT, "the particles do not lie symmetrically, or are not the same at all times")
    means = np.array([across(error["x"].mean(axis=0)) for error in evidence.errors])
    aside, size = np.linalg.norm(means, axis=1), max(float(np.sqrt(np.mean(np.sum(e["x"]**2, axis=1))))
                                                     for e in evidence.errors)
    if not 0 < size < np.inf:
        return unknown(DRIFT, "x has no error, or too large a one")
    k = int(np.argmax(aside))
    figures = kept(some([f.position for f in evidence.frames]))
    rounding = rms(figures.rounding(evidence.frames[k].position)) / np.sqrt(len(frame.number))
    least = ROUNDED * float(rounding) + NOTHING * evidence.scene.spacing
    measured, tolerance = float(aside[k]) / size, ASIDE + least / size
    if measured <= tolerance:
        return Check(DRIFT, measured, tolerance, UNIT, HOLDS)
    place = ", ".join(f"{c:.2g}" for c in means[k])
    return Check(DRIFT, measured, tolerance, UNIT, OFF,
                 f"at t = {evidence.frames[k].time:.4g} s the particles are {place} m aside on average, "
                 "and nothing moves the middle of a symmetrical body: they drift, or a force or mass is not symmetric")


def _without_mean(evidence: Evidence, X: np.ndarray) -> Callable[[np.ndarray], np.ndarray] | None:
    """What of a mean (D,) symmetry forbids; None where the particles have none."""
    start = PROBLEMS[evidence.scene.problem].reference.start(evidence.scene).material_position
    middle = 0.5 * (start.min(axis=0) + start.max(axis=0))
    near = Nearby(X)
    apart = _distance(X)

    def same(other: np.ndarray) -> bool:
        return bool((near.among(other) <= SAME_PLACE * apart).all())

    if same(2 * middle - X):
        return lambda mean: mean
    if X.shape[1] == 2 and same(X[:, ::-1]):
        return lambda mean: 0.5 * (mean - mean[::-1])
    return None


def _distance(X: np.ndarray) -> float:
    """Of most particles from the nearest other."""
    if len(X) < 2:
        return np.inf
    return float(np.median(Nearby(X).nearest(X[::-(-len(X) // MOST_ASKED)], 2)[0][:, 1]))


def axes(evidence: Evidence) -> Check:
    """Whether the error would be far less, were the file read otherwise."""
    frames = sorted(evidence.frames, key=lambda f: -float(np.sum((f.position - f.material_position)**2)))[:LOOKED_AT]
    frames = [_thinned(frame) for frame in frames]
    now = _sizes([evidence.again(frame) for frame in frames])
    left, words = min(((_sizes([evidence.again(other(f)) for f in frames])[q] / now[q], words)
                       for words, q, other in _readings(frames[0]) if now.get(q, 0.0) > 0),
                      default=(None, ""))
    if left is None or not 0 < left < np.inf:
        return unknown(AXES, "nothing to exchange, or no errors that could tell")
    return Check(AXES, 1 / left, 1 / FITS, "times less error if read otherwise", HOLDS if left > FITS else OFF,
                 "" if left > FITS else f"{words}: read so, the error is {left:.2g} of what it is")


def _thinned(frame: Frame) -> Frame:
    """Of some of the particles."""
    chosen = slice(None, None, -(-len(frame.number) // MOST_FOLLOWED))
    some: dict[str, Any] = {field.name: value[chosen] for field in fields(frame)
                            if isinstance(value := getattr(frame, field.name), np.ndarray)}
    return replace(frame, **some)


def _sizes(errors: list[Errors]) -> dict[str, float]:
    return {q: rms(np.concatenate([e[q].ravel() for e in errors])) for q in errors[0]}


def _readings(frame: Frame) -> Iterator[tuple[str, str, Callable[[Frame], Frame]]]:
    """What might have happened, the quantity whose error shows it, and the frame without it."""
    F, plane = frame.deformation_gradient, frame.position.shape[1] == 2
    yield ("the positions seem to be displacements", "x",
           lambda f: replace(f, position=f.position + f.material_position))
    yield ("the positions seem to be in mm", "x", lambda f: replace(f, position=1e-3 * f.position))
    if plane:
        yield ("x and y of the positions seem to be exchanged", "x",
               lambda f: replace(f, position=f.position[:, ::-1]))
        yield ("x and y of everything seem to be exchanged, or one axis to point the other way", "x",
               lambda f: replace(f, position=f.position[:, ::-1], material_position=f.material_position[:, ::-1]))
    if frame.velocity is not None:
        if plane:
            yield ("x and y of the velocities seem to be exchanged", "v",
                   lambda f: replace(f, velocity=_given(f.velocity)[:, ::-1]))
        yield ("the velocities seem to have the other sign", "v",
               lambda f: replace(f, velocity=-_given(f.velocity)))
    if F is not None and frame.stress is None:
        if plane:
            yield ("F seems to be transposed", "sigma",
                   lambda f: replace(f, deformation_gradient=_given(f.deformation_gradient).transpose(0, 2, 1)))
        yield ("F seems to be its inverse, dX/dx", "sigma",
               lambda f: replace(f, deformation_gradient=np.linalg.pinv(_given(f.deformation_gradient))))
        yield ("F seems to be the gradient of the displacement, F - I", "sigma",
               lambda f: replace(f, deformation_gradient=_given(f.deformation_gradient) + np.eye(F.shape[1])))


def _given(values: np.ndarray | None) -> np.ndarray:
    assert values is not None
    return values
