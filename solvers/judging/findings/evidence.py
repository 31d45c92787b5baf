"""What findings have to go by: frames and their errors, both over time, and how many figures files keep of them."""

import functools
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from solvers.judging.error_norms import Errors, stress
from solvers.judging.frames import Frame
from solvers.message import Message
from solvers.scene.scene import Scene

MOST_FOLLOWED, MOST_TIMES = 4000, 400  # particles and times that are followed over time
LOOKED_AT, OF_EACH = 1024, 64  # numbers of a quantity; particles of a frame
FEWEST = 16  # different ones, from which on their figures tell how all were written
ALL_FIGURES = 15  # of a number in double precision, from which on nothing was cut off
FIGURES_OF_SINGLE = 9  # that a number in single precision is written with
SINGLE, DOUBLE = 2.0**-24, 2.0**-53  # of a number: half its last bit


@dataclass(frozen=True)
class Tracks:
    """P particles at T times in s, which are the same at all of them: what the file has of them, (T, P, D) and (T, P,
    D, D), and what they should be by the best that is known."""

    time: np.ndarray
    material_position: np.ndarray  # (P, D)
    own: dict[str, np.ndarray]  # by quantity, x, v and sigma, and F and stress where the files say them
    exact: dict[str, np.ndarray]  # by quantity: x, v and sigma


@dataclass(frozen=True)
class Evidence:
    """A run in files, with its errors against the best that is known, in the order of the frames; ``again`` gives those
    of a frame of the same times that is somehow changed, ``step`` is that of the run in s, or of the scene."""

    scene: Scene
    frames: Sequence[Frame]
    errors: Sequence[Errors]
    again: Callable[[Frame], Errors]
    step: float

    @functools.cached_property
    def tracks(self) -> Tracks | None:
        """Some of the particles at some of the times; None where they are not the same ones at all of these."""
        every = -(-len(self.frames) // MOST_TIMES)
        frames, errors = self.frames[::every], self.errors[::every]
        orders = [np.lexsort(frame.material_position.T) for frame in frames]
        X = frames[0].material_position[orders[0]]
        if any(not np.array_equal(frame.material_position[order], X)
               for frame, order in zip(frames, orders, strict=True)):
            return None
        picked = [order[::-(-len(X) // MOST_FOLLOWED)] for order in orders]
        own: dict[str, list[np.ndarray | None]] = {
            "x": [f.position for f in frames], "v": [f.velocity for f in frames],
            "sigma": [stress(self.scene, f) for f in frames], "F": [f.deformation_gradient for f in frames],
            "stress": [f.stress for f in frames]}
        said = {q: np.stack([values[at] for values, at in zip(found, picked, strict=True) if values is not None])
                for q, found in own.items()
                if all(values is not None and np.isfinite(values).all() for values in found)}
        off = {q: np.stack([e[q][at] for e, at in zip(errors, picked, strict=True)])
               for q in ("x", "v", "sigma") if q in said}
        return Tracks(np.array([f.time for f in frames]), frames[0].material_position[picked[0]], said,
                      {q: said[q] - error for q, error in off.items()})


@dataclass(frozen=True)
class StoredPrecision:
    """Numbers are known to ``relative`` of themselves, or to ``absolute`` where that is more; ``words`` says so."""

    relative: float
    absolute: float
    words: str

    def rounding(self, values: np.ndarray) -> np.ndarray:
        """By how much each value may be off for having been written, at most."""
        return np.maximum(self.relative * np.abs(values), self.absolute)


EXACT = StoredPrecision(DOUBLE, 0.0, "double precision")


def sample_numbers(arrays: Sequence[np.ndarray]) -> np.ndarray:
    """Numbers out of all arrays (P, ...), spread over each."""
    return np.concatenate([values[:: max(1, len(values) // OF_EACH)].ravel() for values in arrays])


def detect_precision(values: np.ndarray) -> StoredPrecision:
    """What the numbers of one quantity (...) were written with. Few different numbers tell nothing, and count as
    exact."""
    known = values.ravel()
    known = known[np.isfinite(known) & (known != 0)]
    known = np.unique(known[:: max(1, len(known) // LOOKED_AT)])
    if len(known) < FEWEST:
        return EXACT
    with np.errstate(over="ignore"):
        if np.array_equal(known, known.astype(np.float32)):
            return StoredPrecision(SINGLE, 0.0, "single precision")
    figures = decimals = -300  # the most that any of them needs
    for value in known.tolist():
        mantissa, _, power = np.format_float_scientific(abs(value), unique=True, trim="-").partition("e")
        count = len(mantissa.replace(".", ""))
        figures, decimals = max(figures, count), max(decimals, count - 1 - int(power))
    if figures >= ALL_FIGURES:
        return EXACT
    relative = 0.5 * 10.0 ** (1 - figures)  # of a number whose first figure is 1
    return StoredPrecision(max(relative, SINGLE) if figures <= FIGURES_OF_SINGLE else relative, 0.5 * 10.0**-decimals,
                           Message("{figures} figures", figures))
