"""The colour scale shared by estimate and truth: maps sizes of errors to colours, and has numbered ticks."""

import math
from collections.abc import Callable, Hashable, Iterable
from time import monotonic

import numpy as np

from app.colour_palette import colour_table
from app.language.translation import lazy, tr
from app.names_and_units import QUANTITIES, format_number, with_unit

#: Tops between two powers of ten, each with the number of parts into which ticks divide it, so that these are round
#: too: so few that different runs often have one scale.
TOPS = {1.0: 5, 3.0: 3}
MOST_TICKS = max(*TOPS.values()) + 1
OVER = 1.5  # times the top that the largest error may be
DECADES = 3  # that a logarithmic scale shows below its top
CALM_SECONDS = 1.4  # for which the top stays after growing, and after another run has begun
HIDDEN = 3.0  # times the top from which errors are so large that all would have one colour
ZERO = lazy("0, exact")
REMEMBERED = 64  # runs whose largest error is cached
SMALLEST = 1e-300
#: For a scene at rest, as shares of a quantity's size: the least top of the colours, so that round-off
#: is not coloured, and the least range of a plot's axis.
LEAST_TOP, LEAST_REACH = 1e-3, 0.1
BEYOND = 10  # times the largest true error: larger estimates do not extend the scale, which would hide both


class ColourScale:
    """Scale that maps sizes of errors, as shares of the largest exact value, to colours, from 0 (or, if
    ``logarithmic``, three decades below) to a round share ``top``, at most 1, which grows with the largest error of the
    run unless the scale is ``held``. Ticks are in per cent or, if ``absolute``, in the quantity's unit. ``clock``
    returns the present time in s."""

    def __init__(self, clock: Callable[[], float] = monotonic) -> None:
        self._table, self._clock = colour_table(), clock
        self._largest: dict[Hashable, float] = {}  # errors of runs, the last one seen last
        self._begun, self._is_anew, self._next = False, False, 0.0
        self.logarithmic = self.held = self.absolute = False
        self.top, self._parts = 1.0, TOPS[1.0]
        self.whole = 1.0  # the largest exact value, in the quantity's unit
        self.exceeded = False  # whether an error is above the top

    def reset(self) -> None:
        """Lets the next update set the top anew, for another quantity, unless the scale is ``held``."""
        self._begun = self._begun and self.held

    def begin_run(self) -> None:
        """Keeps the top while a visitor goes from run to run; it is fitted to the last one 1.4 s after it has begun."""
        self._is_anew, self._next = True, self._clock() + CALM_SECONDS

    @property
    def is_outdated(self) -> bool:
        """Whether it is time to fit the top to a run that has begun, by the next update."""
        return self._is_anew and not self.held and self._clock() > self._next

    @property
    def appearance(self) -> tuple[Hashable, ...]:
        """Everything on which colours and ticks depend."""
        return self.top, self.exceeded, self.logarithmic, self.absolute and self.whole

    def update(self, estimated: np.ndarray | None, true: np.ndarray | None, run: Hashable = None,
               beside: tuple[np.ndarray | None, np.ndarray | None] = (None, None), least: float = 0.0,
               settled: bool = False) -> None:
        """Sets ``top``, unless ``held``, and ``exceeded`` from a frame's errors, all shares (P,) or None.

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
            self._fit_top(max(top, known, OVER * least), settled)
        self.exceeded = max(truth, estimate) > self.top

    def _fit_top(self, size: float, settled: bool) -> None:
        """Sets the top for a largest error, if that is too large for it or the run is new, unless it must stay."""
        now = self._clock()
        waits = now < self._next and (self._is_anew or not (settled or size > HIDDEN * self.top))
        if size <= SMALLEST or (self._begun and (waits or not (self._is_anew or size > OVER * self.top))):
            return
        top, step = round_up(size / OVER, TOPS)
        self.top, self._parts = (float(f"{top:g}"), TOPS[step]) if top < 1 else (1.0, TOPS[1.0])
        self._begun, self._is_anew, self._next = True, False, now + CALM_SECONDS

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

    def ticks(self, quantity: str, says_of_what: bool = True) -> list[tuple[float, str]]:
        """Returns ticks, from the bottom up: positions 0 to 1 along the scale and the texts there, for a quantity by
        its key; the last one ``says_of_what`` it is a share, unless that is False."""
        if self.logarithmic:
            shares = [(k / DECADES, self.top * 10.0 ** (k - DECADES)) for k in range(DECADES + 1)]
        else:
            shares = [(k / self._parts, self.top * k / self._parts) for k in range(self._parts + 1)]
        words = QUANTITIES[quantity]
        texts = [with_unit(share * self.whole, words.unit) if self.absolute else f"{format_number(100 * share)} %"
                 for _, share in shares]
        if not self.logarithmic:
            texts[0] = tr(ZERO)
        if says_of_what and not self.absolute:
            texts[-1] = tr("{share} of the largest {noun}", share=texts[-1], noun=words.noun)
        if self.exceeded:
            texts[-1] = f"≥ {texts[-1]}"
        return [(at, text) for (at, _), text in zip(shares, texts, strict=True)]


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
