"""How many figures a file keeps: found from its numbers, whatever it was written with."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

LOOKED_AT, OF_EACH = 1024, 64  # numbers of a quantity; particles of a frame
FEWEST = 16  # different ones, from which on their figures tell how all were written
ALL_FIGURES = 15  # of a number in double precision, from which on nothing was cut off
FIGURES_OF_SINGLE = 9  # that a number in single precision is written with
SINGLE, DOUBLE = 2.0**-24, 2.0**-53  # of a number: half its last bit


@dataclass(frozen=True)
class Figures:
    """Numbers are known to ``relative`` of themselves, or to ``absolute`` where that is more; ``words`` says so."""

    relative: float
    absolute: float
    words: str

    def rounding(self, values: np.ndarray) -> np.ndarray:
        """By how much each value may be off for having been written, at most."""
        return np.maximum(self.relative * np.abs(values), self.absolute)


EXACT = Figures(DOUBLE, 0.0, "double precision")


def some(arrays: Sequence[np.ndarray]) -> np.ndarray:
    """Numbers out of all arrays (P, ...), spread over each."""
    return np.concatenate([values[:: max(1, len(values) // OF_EACH)].ravel() for values in arrays])


def kept(values: np.ndarray) -> Figures:
    """What the numbers of one quantity (...) were written with. Few different numbers tell nothing, and count as
    exact."""
    known = values.ravel()
    known = known[np.isfinite(known) & (known != 0)]
    known = np.unique(known[:: max(1, len(known) // LOOKED_AT)])
    if len(known) < FEWEST:
        return EXACT
    with np.errstate(over="ignore"):
        if np.array_equal(known, known.astype(np.float32)):
            return Figures(SINGLE, 0.0, "single precision")
    figures, decimals = _decimal(known)
    if figures >= ALL_FIGURES:
        return EXACT
    relative = 0.5 * 10.0 ** (1 - figures)  # of a number whose first figure is 1
    return Figures(max(relative, SINGLE) if figures <= FIGURES_OF_SINGLE else relative, 0.5 * 10.0**-decimals,
                   f"{figures} figures")


def _decimal(values: np.ndarray) -> tuple[int, int]:
    """The most figures and the most decimals that any of the values needs."""
    figures = decimals = -300
    for value in values.tolist():
        mantissa, _, power = np.format_float_scientific(abs(value), unique=True, trim="-").partition("e")
        count = len(mantissa.replace(".", ""))
        figures, decimals = max(figures, count), max(decimals, count - 1 - int(power))
    return figures, decimals
