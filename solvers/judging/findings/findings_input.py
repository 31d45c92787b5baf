"""Input of findings: frames and their errors, both over time, and the precision of numbers in files."""

import functools
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from solvers.judging.error_norms import Errors, frame_stress
from solvers.judging.particle_data_types import Frame
from solvers.scene.scene import Scene
from solvers.translatable_message import Message

MOST_FOLLOWED, MOST_TIMES = 4000, 400  # particles and times in trajectories
LOOKED_AT, OF_EACH = 1024, 64  # numbers of a quantity; particles of a frame
FEWEST = 16  # distinct numbers from which on the precision can be detected
FEWEST_FIGURES = 4  # from which on fewer numbers are rounded: those of an even strain, unlike a spacing of 0.125
ALL_FIGURES = 15  # digits of a double from which on it is not rounded
FIGURES_OF_SINGLE = 9  # digits of a number written in single precision
SINGLE, DOUBLE = 2.0**-24, 2.0**-53  # of a number: half its last bit


@dataclass(frozen=True)
class ParticleTrajectories:
    """Trajectories of the same P particles at T times in s: by quantity their values in the file (``own``) and the best
    known exact ones, (T, P, D) or (T, P, D, D)."""

    time: np.ndarray
    number: np.ndarray  # (P,), in the files
    material_position: np.ndarray  # (P, D)
    own: dict[str, np.ndarray]  # x, v and sigma (from F if need be), and F and stress if in the files
    exact: dict[str, np.ndarray]  # x, v and sigma


@dataclass(frozen=True)
class FindingsInput:
    """A run in files, with its errors by quantity against the best reference for each frame; ``recompute_errors``
    returns those of a modified frame, ``step`` is the time step in s of the run, or of the scene."""

    scene: Scene
    frames: Sequence[Frame]
    errors: Sequence[Errors]
    recompute_errors: Callable[[Frame], Errors]
    step: float

    @functools.cached_property
    def stored_rounding(self) -> dict[str, float]:
        """Largest rounding error of the numbers in the files of x, v and stress, as far as they are there, in SI."""
        columns = {"x": [f.position for f in self.frames],
                   "v": [f.velocity for f in self.frames if f.velocity is not None],
                   "sigma": [f.stress for f in self.frames if f.stress is not None]}
        return {q: largest_stored_rounding(arrays) for q, arrays in columns.items() if arrays}

    @functools.cached_property
    def tracks(self) -> ParticleTrajectories | None:
        """Trajectories of some particles at some times; None where particles differ between these."""
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
            "sigma": [frame_stress(self.scene, f) for f in frames], "F": [f.deformation_gradient for f in frames],
            "stress": [f.stress for f in frames]}
        said = {q: np.stack([values[at] for values, at in zip(found, picked, strict=True) if values is not None])
                for q, found in own.items()
                if all(values is not None and np.isfinite(values).all() for values in found)}
        off = {q: np.stack([e[q][at] for e, at in zip(errors, picked, strict=True)])
               for q in ("x", "v", "sigma") if q in said}
        return ParticleTrajectories(np.array([f.time for f in frames]), frames[0].number[picked[0]],
                                    frames[0].material_position[picked[0]], said,
                                    {q: said[q] - error for q, error in off.items()})


@dataclass(frozen=True)
class StoredPrecision:
    """Precision of stored numbers: ``relative``, or ``absolute`` where that is larger; ``words`` describes it."""

    relative: float
    absolute: float
    words: str

    def rounding(self, values: np.ndarray) -> np.ndarray:
        """Returns the largest rounding error of each stored value, in the values' unit and shape."""
        return np.maximum(self.relative * np.abs(values), self.absolute)


EXACT = StoredPrecision(DOUBLE, 0.0, "double precision")


def sample_numbers(arrays: Sequence[np.ndarray]) -> np.ndarray:
    """Returns numbers (n,) from all arrays (P, ...), spread evenly over the particles of each."""
    return np.concatenate([values[:: max(1, len(values) // OF_EACH)].ravel() for values in arrays])


def largest_stored_rounding(arrays: Sequence[np.ndarray]) -> float:
    """Returns the largest rounding error of the numbers in arrays (P, ...), in their unit."""
    largest = max(float(np.abs(values).max()) for values in arrays)
    return float(detect_precision(sample_numbers(arrays)).rounding(np.array(largest)))


def detect_precision(values: np.ndarray) -> StoredPrecision:
    """Returns the precision with which numbers of any shape were written; exact for few numbers of few figures."""
    known = values.ravel()
    known = known[np.isfinite(known) & (known != 0)]
    known = np.unique(known[:: max(1, len(known) // LOOKED_AT)])
    few = len(known) < FEWEST
    with np.errstate(over="ignore"):
        single = np.array_equal(known, known.astype(np.float32))
    figures = decimals = -300  # the most that any of them needs
    for value in known.tolist():
        mantissa, _, power = np.format_float_scientific(abs(value), unique=True, trim="-").partition("e")
        count = len(mantissa.replace(".", ""))
        figures, decimals = max(figures, count), max(decimals, count - 1 - int(power))
    if single and (figures >= ALL_FIGURES or not few):
        return StoredPrecision(SINGLE, 0.0, "single precision")
    if figures >= ALL_FIGURES or (few and figures < FEWEST_FIGURES):
        return EXACT
    relative = 0.5 * 10.0 ** (1 - figures)  # of a number whose first figure is 1
    return StoredPrecision(max(relative, SINGLE) if figures <= FIGURES_OF_SINGLE else relative, 0.5 * 10.0**-decimals,
                           Message("{figures} figures", figures))
