"""The axis on which numbers that people have given stand: chosen by most of them, so that one odd answer does not
squeeze the others into a corner; what lies beyond stands at its end."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

DECADES = 1.5  # that most answers span, from which on each decade has the same room
REACH = 1.0  # times the span of most answers by which others may be further out and still have a place of their own
MOST = (0.1, 0.9)  # parts of the answers that are below and above "most"
MARGIN = 0.04  # of the axis, at either end
TICKS = 5  # or fewer
SAME = 0.1  # of a number, on either side of it, where all have given the same


@dataclass(frozen=True)
class Axis:
    """From ``low`` to ``high``, of logarithms (to the base of 10) where it is ``logarithmic``."""

    low: float
    high: float
    logarithmic: bool = False

    def place(self, value: float) -> float:
        """Where a value stands, from 0 at the left to 1; what is further out at the ends."""
        return min(1.0, max(0.0, (self._inner(value) - self.low) / (self.high - self.low)))

    def beyond(self, value: float) -> int:
        """-1 or 1 for what is further out, at the left or at the right, else 0."""
        inner = self._inner(value)
        return -1 if inner < self.low else 1 if inner > self.high else 0

    @property
    def ticks(self) -> list[float]:
        """Round values within it, few enough to have their names beside each other."""
        step = _round_up((self.high - self.low) / TICKS, whole=self.logarithmic)
        first, last = math.ceil(self.low / step), math.floor(self.high / step)
        return [10.0 ** (k * step) if self.logarithmic else float(f"{k * step:.12g}") for k in range(first, last + 1)]

    def _inner(self, value: float) -> float:
        if not self.logarithmic:
            return value
        return math.log10(value) if value > 0 else -math.inf


def axis_for(values: Sequence[float], always: Sequence[float] = ()) -> Axis:
    """The axis for values, of which there is one at least; those that must be on it ``always`` are."""
    logarithmic = _spread(values) and min(always, default=1.0) > 0
    inner = sorted(math.log10(value) if logarithmic else value for value in values if value > 0 or not logarithmic)
    fixed = [math.log10(value) if logarithmic else value for value in always]
    few, many = (inner[round(part * (len(inner) - 1))] for part in MOST)
    room = REACH * (many - few)
    low = min([max(inner[0], few - room), *fixed])
    high = max([min(inner[-1], many + room), *fixed])
    if high - low <= 1e-9 * max(abs(low), abs(high)):
        room = SAME if logarithmic else SAME * abs(low) or 1.0
        low, high = low - room, high + room
    margin = MARGIN * (high - low)
    return Axis(low - margin, high + margin, logarithmic)


def _spread(values: Sequence[float]) -> bool:
    """Whether decades matter: most are above zero, and far apart."""
    ranked = sorted(values)
    few, many = (ranked[round(part * (len(ranked) - 1))] for part in MOST)
    return few > 0 and math.log10(many) - math.log10(few) > DECADES


def _round_up(step: float, whole: bool) -> float:
    """The next of 1, 2 and 5 times a power of ten, 1 at least where it must be ``whole``."""
    if whole and step <= 1:
        return 1.0
    power = 10.0 ** math.floor(math.log10(step))
    return next(factor * power for factor in (1, 2, 5, 10) if factor * power >= step * (1 - 1e-9))
