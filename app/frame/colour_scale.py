"""The colour scale shared by estimate and truth: maps sizes of errors to colours, and has numbered ticks."""

import math
from collections.abc import Callable, Hashable, Iterable
from time import monotonic

import numpy as np

from app.colour_palette import colour_table
from app.language.translation import lazy, tr
from app.names_and_units import PREFIXES, format_number, with_unit

#: Tops between two powers of ten, each with the number of parts into which ticks divide it, so that these are round
#: too. Neighbours are so close that the largest error reaches three quarters of the scale or more.
TOPS = {1.0: 4, 1.2: 4, 1.5: 3, 2.0: 4, 2.5: 5, 3.0: 3, 4.0: 4, 5.0: 5, 6.0: 3, 8.0: 4}
MOST_TICKS = max(*TOPS.values()) + 1
DECADES = 3  # that a logarithmic scale shows below its top
CALM_SECONDS = 1.0  # for which the top stays after growing ...
HIDDEN = 3.0  # ... unless errors are so many times as large, and would all have one colour
ZERO = lazy("0, exact")
REMEMBERED = 64  # runs whose largest error is cached
SMALLEST = 1e-300
#: For a scene at rest, as shares of a quantity's size: the least top of the colours, so that round-off
#: is not coloured, and the least range of a plot's axis.
LEAST_TOP, LEAST_REACH = 1e-3, 0.1
BEYOND = 10  # times the largest true error: larger estimates do not extend the scale, which would hide both


class ColourScale:
    """Scale that maps sizes of errors to colours, from 0 (or, if ``logarithmic``, three decades below) to a round
    number ``top`` in the unit of the sizes, which grows with the largest error of the run unless the scale is ``held``.
    ``clock`` returns the present time in s."""

    def __init__(self, clock: Callable[[], float] = monotonic) -> None:
        self._table, self._clock = colour_table(), clock
        self._largest: dict[Hashable, float] = {}  # errors of runs, the last one seen last
        self._begun, self._next = False, 0.0
        self.logarithmic = False
        self.held = False
        self.top, self._parts = 1.0, TOPS[1.0]
        self.exceeded = False  # whether an error is above the top

    def reset(self) -> None:
        """Lets the next update set the top anew, for another quantity or run, unless the scale is ``held``."""
        self._begun = self._begun and self.held

    def update(self, estimated: np.ndarray | None, true: np.ndarray | None, run: Hashable = None,
               beside: tuple[np.ndarray | None, np.ndarray | None] = (None, None), least: float = 0.0,
               settled: bool = False) -> None:
        """Sets ``top``, unless ``held``, and ``exceeded`` from a frame's errors, all sizes (P,) in one unit or None.

        ``run`` identifies the run of the ``estimated`` and ``true`` ones, whose largest error so far counts; ``beside``
        has the estimated and true ones of a second run on the stage. The top is at least ``least``, and grows at once
        if the frame is ``settled``: a run that pauses, or has broken, may send no later one."""
        truth, estimate = (max(largest_finite(true), largest_finite(beside[1])),
                           max(largest_finite(estimated), largest_finite(beside[0])))
        top = max(truth, min(estimate, BEYOND * truth)) if truth > 0 else estimate
        known = self._largest.get(run, 0.0)
        if run is not None and top > known:
            self._largest[run] = known = top
            if len(self._largest) > REMEMBERED:
                del self._largest[next(iter(self._largest))]
        if not self.held:
            self._raise_top(max(top, known, least), settled)
        self.exceeded = max(truth, estimate) > self.top

    def _raise_top(self, size: float, settled: bool) -> None:
        """Raises the top to at least a size, unless it has just grown, the size is not far above it and the frame not
        ``settled``."""
        now = self._clock()
        waits = now < self._next and size < HIDDEN * self.top and not settled
        if size <= SMALLEST or (self._begun and (size <= self.top or waits)):
            return
        self.top, step = round_up(size, TOPS)
        self._parts = TOPS[step]
        self._begun, self._next = True, now + CALM_SECONDS

    def colours(self, sizes: np.ndarray) -> np.ndarray:
        """Returns colours (P, 3), uint8 RGB, for sizes (P,) of errors; NaN counts as above the top. Callers silence
        numpy's warnings about such sizes, once for everything drawn: that takes as long as the colours do."""
        row = np.fmax(np.fmin(255 * self.shares(sizes), 255), 0)  # fmin ignores NaN
        return self._table.take(row.astype(np.uint8), axis=0)

    def shares(self, sizes: np.ndarray) -> np.ndarray:
        """Returns the positions (P,) of sizes (P,) of errors along the scale, 0 to 1 from its bottom to its top."""
        return 1 + np.log10(sizes / self.top) / DECADES if self.logarithmic else sizes / self.top

    def gradient(self, steps: int) -> np.ndarray:
        """Returns evenly spaced colours (steps, 3), uint8 RGB, from the bottom of the scale to its top."""
        return self._table[np.linspace(0, 255, steps).astype(np.int32)]

    def ticks(self, unit: str) -> list[tuple[float, str]]:
        """Returns ticks, from the bottom up: positions 0 to 1 along the scale and the texts there, which are numbers
        with ``unit`` (without prefix: "m") at the last, or at each of a logarithmic scale."""
        if self.logarithmic:
            ticks = [(k / DECADES, with_unit(self.top * 10.0 ** (k - DECADES), unit)) for k in range(DECADES + 1)]
        else:
            n, end = self._parts, with_unit(self.top, unit)
            power = math.floor(math.log10(self.top) / 3 + 1e-9)
            size = 1000.0**power if power in PREFIXES else self.top / float(end.split()[0])
            ticks = [(0.0, tr(ZERO)), *((k / n, format_number(self.top * k / n / size)) for k in range(1, n)),
                     (1.0, end)]
        at, text = ticks.pop()
        return [*ticks, (at, f"≥ {text}" if self.exceeded else text)]


def any_finite(sizes: np.ndarray) -> bool:
    """Returns whether any of the sizes (n,), none of which is negative, is finite."""
    return bool(np.fmin.reduce(sizes, initial=np.inf) < np.inf)  # fmin ignores NaN


def largest_finite(sizes: np.ndarray | None) -> float:
    """Returns the largest finite one of sizes (n,), none of which is negative; 0 for None, or if there is none."""
    if sizes is None:
        return 0.0
    top = float(np.maximum.reduce(sizes, initial=0.0))
    return top if math.isfinite(top) else float(np.max(sizes[np.isfinite(sizes)], initial=0.0))


def round_up(value: float, steps: Iterable[float]) -> tuple[float, float]:
    """Rounds a value above 0 up to a step times a power of ten; returns the rounded value and the step, which is one of
    the ascending ``steps``, from 1 to below 10."""
    power = 10.0 ** math.floor(math.log10(value))
    return next(((step * power, step) for step in steps if value <= step * power), (10 * power, 1.0))
