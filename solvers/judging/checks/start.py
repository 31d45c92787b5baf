"""Whether the particles begin as the problem's do: what is wrong with a file shows before anything has moved."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from solvers.judging.checks.check import HOLDS, OFF, Check, unknown
from solvers.judging.checks.evidence import Evidence
from solvers.judging.checks.nearby import Nearby
from solvers.judging.checks.over_time import rms
from solvers.judging.frames import Frame
from solvers.problems import PROBLEMS
from solvers.scene.scene import Scene

PLACES, SPEEDS = "x at t = 0", "v at t = 0"
FAR = 0.05  # of a cell: a particle that is given X to fewer figures is nearer
OTHER = 0.05  # of the velocity; that of half a step before the start, with which leapfrog begins, is nearer
FITS = 0.3  # of the error, that another reading leaves at most
UNITS = 7.0  # powers of ten that one unit may be of another
NONE = "no moment at t = 0 in the files"


def places(evidence: Evidence) -> Check:
    """Positions against where the problem's particles begin."""
    found = _start(evidence, "x")
    if found is None:
        return unknown(PLACES, NONE)
    frame, error = found
    size, tolerance = rms(error) * error.shape[1] ** 0.5, FAR * evidence.scene.spacing
    if size <= tolerance:
        return Check(PLACES, size, tolerance, "m", HOLDS)
    told = _fitting(error, _readings(evidence.scene, frame, error))
    return Check(PLACES, size, tolerance, "m", OFF,
                 f"at t = 0 the particles are not where those of the {evidence.scene.problem} begin, by {size:.3g} m: "
                 f"{told or 'they are others, or X or ids are'}")


def speeds(evidence: Evidence) -> Check:
    """Velocities against those that the problem begins with."""
    found = _start(evidence, "v")
    if found is None:
        return unknown(SPEEDS, NONE if _start(evidence, "x") is None else "no velocities in the files")
    frame, error = found
    assert frame.velocity is not None
    right = frame.velocity - error
    size = rms(right)
    if not size > 0:
        return unknown(SPEEDS, "the problem begins at rest")
    step = 0.5 * evidence.step * evidence.scene.angular_frequency
    off, tolerance = rms(error) / size, OTHER + step
    if off <= tolerance:
        return Check(SPEEDS, off, tolerance, "of v", HOLDS)
    factor = float(np.sum(frame.velocity * right) / np.sum(right**2))
    fits = rms(frame.velocity - factor * right) <= FITS * rms(error)
    told = f"it is {factor:.4g} times that, as of another amplitude or unit" if fits else "it is another motion"
    return Check(SPEEDS, off, tolerance, "of v", OFF,
                 f"at t = 0 the velocity is not that with which the {evidence.scene.problem} begins, by {off:.2g} of "
                 f"it: {told}")


def _start(evidence: Evidence, quantity: str) -> tuple[Frame, np.ndarray] | None:
    """The frame at t = 0 with its error; None where there is none, or it has not the quantity."""
    return next(((frame, error[quantity]) for frame, error in zip(evidence.frames, evidence.errors, strict=True)
                 if frame.time == 0 and quantity in error), None)


def _readings(scene: Scene, frame: Frame, error: np.ndarray) -> Iterator[tuple[str, Callable[[], float]]]:
    """What the positions might be, and the RMS error that is left then; of a periodic body within its period."""
    right, x, X = frame.position - error, frame.position, frame.material_position

    def within(places: np.ndarray, near: np.ndarray) -> np.ndarray:
        return PROBLEMS[scene.problem].reference.unwrapped(scene, near, places, np.zeros(len(places)))

    yield "x seems to be the displacement, not the position", lambda: rms(within(x + X, X) - right)
    factor = float(np.sum(x * right) / max(float(np.sum(right**2)), 1e-300))
    if FITS < abs(np.log10(max(abs(factor), 1e-300))) < UNITS:
        yield (f"x seems to be in another unit than X, {factor:.4g} times what it should be",
               lambda: rms(x - factor * right) / max(abs(factor), 1.0))
    if len(x) > 1:
        middle = np.broadcast_to(0.5 * (right.min(axis=0) + right.max(axis=0)), right.shape)
        far, who = Nearby(right).nearest(within(x, middle), 1)
        if len(np.unique(who)) == len(x):
            yield ("each is where another one begins: ids, or the order of the rows, are permuted",
                   lambda: float(np.sqrt(np.mean(np.minimum(far, rms(error)) ** 2))))


def _fitting(error: np.ndarray, readings: Iterator[tuple[str, Callable[[], float]]]) -> str | None:
    left, words = min((left() / rms(error), words) for words, left in readings)
    return words if left < FITS else None
