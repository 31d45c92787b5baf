"""The colour scale that estimate and truth share: from sizes of errors to colours, and its numbers."""

import math
from collections import deque
from collections.abc import Iterable

import numpy as np

from app.colours import colour_table
from app.words import number, power_of_ten

#: Tops between two powers of ten, each with the number of parts into which ticks divide it, so that these are round
#: too. Neighbours are so close that the largest error reaches three quarters of the scale or more.
TOPS = {1.0: 4, 1.2: 4, 1.5: 3, 2.0: 4, 2.5: 5, 3.0: 3, 4.0: 4, 5.0: 5, 6.0: 3, 8.0: 4}
MOST_TICKS = max(*TOPS.values()) + 1
DECADES = 3  # that a logarithmic scale shows below its top
MEMORY = 1.0  # periods for which the largest error is kept in mind: errors come and go within one, and the top must not
SMALLEST = 1e-300
#: Where nothing should happen, of a quantity's size: the colours' top at least, for coloured round-off would say that
#: something does, and what the axis of a plot shows at least.
LEAST_TOP, LEAST_REACH = 1e-3, 0.1
BEYOND = 10  # times the largest true error, from which on an estimate no longer sets a scale: it would hide both


class ColourScale:
    """Maps sizes of errors to colours. The top follows the largest error of the last period, in round numbers."""

    def __init__(self) -> None:
        self._table = colour_table()
        self._peaks: deque[tuple[float, float]] = deque()  # times and errors, each larger than all that came after it
        self.logarithmic = False
        self.held = False
        self.top, self._parts = 1.0, TOPS[1.0]
        self.exceeded = False  # whether something is beyond the top, and so looks smaller than it is

    def forget(self) -> None:
        """Another quantity or another run: begin anew, unless held."""
        if not self.held:
            self._peaks.clear()

    def follow(self, estimated: np.ndarray | None, true: np.ndarray | None, periods: float,
               beside: tuple[np.ndarray | None, np.ndarray | None] = (None, None), least: float = 0.0) -> None:
        """Take in the errors of a frame at a time in periods, and of a run ``beside`` it; move the top, unless held,
        but never below ``least``."""
        truth, estimate = (max(map(largest, sizes)) for sizes in zip((true, estimated), beside[::-1], strict=True))
        if not self.held:
            top = max(truth, min(estimate, BEYOND * truth)) if truth > 0 else estimate
            self._remember(max(top, least), periods)
            if self._peaks[0][1] > SMALLEST:
                self.top, step = round_up(self._peaks[0][1], TOPS)
                self._parts = TOPS[step]
        self.exceeded = max(truth, estimate) > self.top

    def colours(self, sizes: np.ndarray) -> np.ndarray:
        """(P, 3) colours of (P,) sizes; what is not a number counts as beyond the top."""
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            share = 1 + np.log10(sizes / self.top) / DECADES if self.logarithmic else sizes / self.top
            row = np.fmax(np.fmin(255 * share, 255), 0)  # fmin takes the other one where one is not a number
        return self._table.take(row.astype(np.uint8), axis=0)

    def gradient(self, steps: int) -> np.ndarray:
        """(steps, 3) colours from the scale's bottom to its top, for the colour bar."""
        return self._table[np.linspace(0, 255, steps).astype(np.int32)]

    def ticks(self) -> list[tuple[float, str]]:
        """Positions 0 to 1 along the scale and the numbers there."""
        if self.logarithmic:
            ticks = [(k / DECADES, number(self.top * 10 ** (k - DECADES))) for k in range(DECADES + 1)]
        else:
            n = self._parts
            ticks = [(k / n, number(self.top * k / n / 10.0**self.power)) for k in range(n + 1)]
        at, text = ticks.pop()
        return [*ticks, (at, f"≥ {text}" if self.exceeded else text)]

    @property
    def power(self) -> int:
        """The power of ten that the ticks are counted in."""
        return 0 if self.logarithmic else power_of_ten(self.top)

    def _remember(self, top: float, periods: float) -> None:
        """Keep the largest errors of the last period; a frame drawn anew takes the place of what it was before."""
        while self._peaks and (self._peaks[-1][0] >= periods or self._peaks[-1][1] <= top):
            self._peaks.pop()
        self._peaks.append((periods, top))
        while self._peaks[0][0] < periods - MEMORY:
            self._peaks.popleft()


def largest(sizes: np.ndarray | None) -> float:
    """The largest of what is finite; 0 for nothing."""
    if sizes is None:
        return 0.0
    top = float(np.max(sizes, initial=0.0))
    return top if math.isfinite(top) else float(np.max(sizes[np.isfinite(sizes)], initial=0.0))


def round_up(value: float, steps: Iterable[float]) -> tuple[float, float]:
    """The next of ``steps`` times a power of ten, and that step: a scale that moves in few, round steps, from 1 on."""
    power = 10.0 ** math.floor(math.log10(value))
    return next(((step * power, step) for step in steps if value <= step * power), (10 * power, 1.0))
