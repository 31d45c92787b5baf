"""Checks of the particles' positions in a problem: at the start, their order and their mean; and whether the file has
another meaning than assumed."""

from collections.abc import Callable, Iterator
from dataclasses import fields, replace
from typing import Any

import numpy as np

from solvers.judging.error_norms import Errors
from solvers.judging.findings.finding import HOLDS, OFF, Finding, compare, unknown
from solvers.judging.findings.findings_input import MOST_FOLLOWED, FindingsInput, detect_precision, sample_numbers
from solvers.judging.findings.neighbour_comparison import MOST_ASKED, NeighbourSearch, departures, find_neighbours
from solvers.judging.findings.time_series_fitting import rms
from solvers.judging.particle_data_types import Frame
from solvers.problems import PROBLEMS
from solvers.scene.scene import Scene
from solvers.translatable_message import Message

ORDER = "particles where others should be"
DRIFT, AXES = "mean error of x, where symmetry allows none", "axes, and the components of F"
UNIT, NEARER = "of the error of x", "times nearer than the next particle"
ASIDE = 5e-3  # of the error's size
NOTHING = 1e-9  # of a cell: what the rounding of many steps may add up to
OTHERS = 0.1  # of the distance of particles: nearer to where another one should be than chance would have it
FAR, UNLIKE = 5.0, 0.5  # times that distance; of the error, by which it jumps from one particle to the next
SAME_PLACE = 1e-3  # of the distance of particles
FITS = 0.3  # of the error, that another reading of the file leaves at most
LOOKED_AT = 4  # frames
PLACES, SPEEDS = "x at t = 0", "v at t = 0"
FROM_START = 0.05  # of a cell, which allows for rounded X
OTHER_SPEED = 0.05  # of the velocity; that of half a step before the start, with which leapfrog begins, is nearer
POWERS = 7.0  # powers of ten that one unit may be of another
NONE = "no data at t = 0 in the files"


def check_initial_positions(evidence: FindingsInput) -> Finding:
    """Checks positions at t = 0 against those of the problem's particles, within 5 % of a cell."""
    found = _start_frame(evidence, "x")
    if found is None:
        return unknown(PLACES, NONE)
    frame, error = found
    size = rms(error) * error.shape[1] ** 0.5
    tolerance = FROM_START * evidence.scene.spacing + evidence.stored_rounding["x"]
    if size <= tolerance:
        return Finding(PLACES, HOLDS, size, tolerance, "m")
    readings = _readings_of_start(evidence.scene, frame, error)
    left, words = min((left() / rms(error), words) for words, left in readings)
    told = words if left < FITS else Message("they are others, or X or ids are")
    return Finding(PLACES, OFF, size, tolerance, "m",
                   Message("at t = 0 the particles are {size:.3g} m off the initial positions of the {problem}: {told}",
                           size, Message(evidence.scene.problem), told))


def check_initial_velocities(evidence: FindingsInput) -> Finding:
    """Checks velocities at t = 0 against the problem's, relative to their RMS."""
    found = _start_frame(evidence, "v")
    if found is None:
        return unknown(SPEEDS, NONE if _start_frame(evidence, "x") is None else "no velocities in the files")
    frame, error = found
    assert frame.velocity is not None
    right = frame.velocity - error
    size = rms(right)
    if not size > 0:
        return unknown(SPEEDS, "the problem begins at rest")
    off, tolerance = rms(error) / size, OTHER_SPEED + 0.5 * evidence.step * evidence.scene.angular_frequency
    tolerance += evidence.stored_rounding["v"] / size
    if off <= tolerance:
        return Finding(SPEEDS, HOLDS, off, tolerance, "of v")
    factor = float(np.sum(frame.velocity * right) / np.sum(right**2))
    fits = rms(frame.velocity - factor * right) <= FITS * rms(error)
    told = Message("it is {factor:.4g} times that, as of another amplitude or unit", factor) if fits else \
        Message("it is another motion")
    return Finding(SPEEDS, OFF, off, tolerance, "of v",
                   Message("at t = 0 the velocity differs from the initial velocity of the {problem} by {off:.2g} of "
                           "it: {told}", Message(evidence.scene.problem), off, told))


def _start_frame(evidence: FindingsInput, quantity: str) -> tuple[Frame, np.ndarray] | None:
    """Returns the frame at t = 0 with its error (P, ...); None without such a frame, or if it lacks the quantity."""
    return next(((frame, error[quantity]) for frame, error in zip(evidence.frames, evidence.errors, strict=True)
                 if frame.time == 0 and quantity in error), None)


def _readings_of_start(scene: Scene, frame: Frame, error: np.ndarray) -> Iterator[tuple[str, Callable[[], float]]]:
    """Yields possible meanings of the positions in words, each with a function for the RMS error in m that it leaves,
    for a periodic body within its period. ``error`` (P, D) is in m."""
    right, x, X = frame.position - error, frame.position, frame.material_position

    def within(places: np.ndarray, near: np.ndarray) -> np.ndarray:
        return PROBLEMS[scene.problem].reference.unwrap_positions(scene, near, places, np.zeros(len(places)))

    yield Message("x seems to be the displacement, not the position"), lambda: rms(within(x + X, X) - right)
    factor = float(np.sum(x * right) / max(float(np.sum(right**2)), 1e-300))
    if FITS < abs(np.log10(max(abs(factor), 1e-300))) < POWERS:
        yield (Message("x seems to be in another unit than X, {factor:.4g} times what it should be", factor),
               lambda: rms(x - factor * right) / max(abs(factor), 1.0))
    if len(x) > 1:
        middle = np.broadcast_to(0.5 * (right.min(axis=0) + right.max(axis=0)), right.shape)
        far, who = NeighbourSearch(right).nearest(within(x, middle), 1)
        if len(np.unique(who)) == len(x):
            yield (Message("each is at the initial position of another one: ids or rows are permuted"),
                   lambda: float(np.sqrt(np.mean(np.minimum(far, rms(error)) ** 2))))


def check_order(evidence: FindingsInput) -> Finding:
    """Checks for particles in another order, whose positions are right but belong to other particles."""
    frame, error = max(zip(evidence.frames, evidence.errors, strict=True), key=lambda pair: rms(pair[1]["x"]))
    apart = _spacing(frame.material_position)
    if not np.isfinite(apart):
        return unknown(ORDER, "too few particles")
    around = NeighbourSearch(frame.position)
    far = np.minimum(around.nearest_distances(frame.position - error["x"]), around.width)
    off, size = float(np.median(far)), float(np.median(np.linalg.norm(error["x"], axis=1)))
    near = find_neighbours(frame.material_position)
    jumps = 0.0 if near is None else float(np.median(departures(near, error["x"]))) / max(size, 1e-300)
    if size > FAR * apart and jumps > UNLIKE:
        return Finding(ORDER, OFF, jumps, UNLIKE, UNIT,
                       Message("at t = {time:.4g} s the error of x jumps between neighbouring particles by its own "
                               "size: their ids or X may be in another order", frame.time))
    nearer = apart / max(off, 1e-300) if size > apart else 0.0  # where all are where they belong so are the nearest
    return Finding(ORDER, HOLDS, nearer, 1 / OTHERS, NEARER) if nearer < 1 / OTHERS else Finding(
        ORDER, OFF, nearer, 1 / OTHERS, NEARER,
        Message("at t = {time:.4g} s most particles are where others should be, within {off:.2g} m: their ids or X are "
                "in another order", frame.time, off))


def check_mean_error(evidence: FindingsInput) -> Finding:
    """Checks the mean error of x, which is 0 over particles that are symmetric about the middle of a body with such a
    motion; if they are symmetric under exchange of x and y, its part across the diagonal is 0."""
    frame = evidence.frames[0]
    across = _forbidden_mean(evidence, frame.material_position)
    if across is None or any(not np.array_equal(f.number, frame.number) for f in evidence.frames):
        return unknown(DRIFT, "the particles do not lie symmetrically, or are not the same at all times")
    means = np.array([across(error["x"].mean(axis=0)) for error in evidence.errors])
    aside, size = np.linalg.norm(means, axis=1), max(float(np.sqrt(np.mean(np.sum(e["x"]**2, axis=1))))
                                                     for e in evidence.errors)
    if not 0 < size < np.inf:
        return unknown(DRIFT, "x has no error, or too large a one")
    k = int(np.argmax(aside))
    figures = detect_precision(sample_numbers([f.position for f in evidence.frames]))
    rounding = rms(figures.rounding(evidence.frames[k].position))  # all may be rounded the same way: a lattice, shifted
    least = float(rounding) + NOTHING * evidence.scene.spacing
    place = ", ".join(f"{c:.2g}" for c in means[k])
    return compare(DRIFT, float(aside[k]) / size, ASIDE + least / size, UNIT,
                   Message("at t = {time:.4g} s the particles are {place} m off on average, but the centre of a "
                           "symmetric body cannot move: they drift, or a force or mass is not symmetric",
                           evidence.frames[k].time, place))


def _forbidden_mean(evidence: FindingsInput, X: np.ndarray) -> Callable[[np.ndarray], np.ndarray] | None:
    """Returns a function for the part of a mean error (D,) that symmetry of X (P, D) forbids; None without symmetry."""
    start = PROBLEMS[evidence.scene.problem].reference.start(evidence.scene).material_position
    middle = 0.5 * (start.min(axis=0) + start.max(axis=0))
    near = NeighbourSearch(X)
    apart = _spacing(X)

    def same(other: np.ndarray) -> bool:
        return bool((near.nearest_distances(other) <= SAME_PLACE * apart).all())

    if same(2 * middle - X):
        return lambda mean: mean
    if X.shape[1] == 2 and same(X[:, ::-1]):
        return lambda mean: 0.5 * (mean - mean[::-1])
    return None


def _spacing(X: np.ndarray) -> float:
    """Returns the median distance in m of particles at X (P, D) from their nearest neighbours."""
    if len(X) < 2:
        return np.inf
    return float(np.median(NeighbourSearch(X).nearest(X[::-(-len(X) // MOST_ASKED)], 2)[0][:, 1]))


def check_alternative_readings(evidence: FindingsInput) -> Finding:
    """Checks whether the error would be far smaller if the file were interpreted differently."""
    frames = sorted(evidence.frames, key=lambda f: -float(np.sum((f.position - f.material_position)**2)))[:LOOKED_AT]
    some: list[dict[str, Any]] = [{field.name: value[::-(-len(frame.number) // MOST_FOLLOWED)]
                                   for field in fields(frame)
                                   if isinstance(value := getattr(frame, field.name), np.ndarray)} for frame in frames]
    frames = [replace(frame, **chosen) for frame, chosen in zip(frames, some, strict=True)]
    now = _rms_errors([evidence.recompute_errors(frame) for frame in frames])
    left, words = min(((_rms_errors([evidence.recompute_errors(other(f)) for f in frames])[q] / now[q], words)
                       for words, q, other in _readings(frames[0]) if now.get(q, 0.0) > 0), default=(None, ""))
    if left is None or not 0 < left < np.inf:
        return unknown(AXES, "nothing to exchange, or no errors that could tell")
    return Finding(AXES, HOLDS if left > FITS else OFF, 1 / left, 1 / FITS, "times less error if read otherwise",
                   "" if left > FITS else Message("{how}: read so, the error is {left:.2g} of what it is", words, left))


def _rms_errors(errors: list[Errors]) -> dict[str, float]:
    return {q: rms(np.concatenate([e[q].ravel() for e in errors])) for q in errors[0]}


def _readings(frame: Frame) -> Iterator[tuple[str, str, Callable[[Frame], Frame]]]:
    """Yields possible mistakes in words, the quantity whose error shows each, and a function that corrects a frame."""
    F, plane = frame.deformation_gradient, frame.position.shape[1] == 2
    yield (Message("the positions seem to be displacements"), "x",
           lambda f: replace(f, position=f.position + f.material_position))
    yield Message("the positions seem to be in mm"), "x", _with_array("position", lambda x: 1e-3 * x)
    if plane:
        yield (Message("x and y of the positions seem to be exchanged"), "x",
               _with_array("position", lambda x: x[:, ::-1]))
        yield (Message("x and y of everything seem to be exchanged, or one axis to point the other way"), "x",
               lambda f: replace(f, position=f.position[:, ::-1], material_position=f.material_position[:, ::-1]))
    if frame.velocity is not None:
        if plane:
            yield (Message("x and y of the velocities seem to be exchanged"), "v",
                   _with_array("velocity", lambda v: v[:, ::-1]))
        yield Message("the velocities seem to have the other sign"), "v", _with_array("velocity", lambda v: -v)
    if F is not None and frame.stress is None:
        if plane:
            yield Message("F seems to be transposed"), "sigma", _with_array("deformation_gradient",
                                                                            lambda F: F.transpose(0, 2, 1))
        yield Message("F seems to be its inverse, dX/dx"), "sigma", _with_array("deformation_gradient", np.linalg.pinv)
        yield (Message("F seems to be the gradient of the displacement, F - I"), "sigma",
               _with_array("deformation_gradient", lambda F: F + np.eye(F.shape[1])))


def _with_array(name: str, change: Callable[[Any], Any]) -> Callable[[Frame], Frame]:
    """Returns a function that returns a frame with its array called ``name`` changed by ``change``."""
    return lambda f: replace(f, **{name: change(getattr(f, name))})
