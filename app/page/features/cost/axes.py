"""Logarithmic axes: what they reach over, where a value is on them, and their ticks."""

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass

ROOM = 0.12  # decades around the values
LEAST = 1.0  # decades that an axis has at least
MINOR = (2, 5)  # times a power of ten: ticks between, for which a narrow chart has no room


@dataclass(frozen=True)
class Tick:
    """A tick at ``part`` of the axis, from its low end; ``minor`` where its value is no power of ten."""

    part: float
    label: str
    minor: bool


@dataclass(frozen=True)
class LogAxis:
    """From ``low`` to ``high``, both as powers of ten."""

    low: float
    high: float

    def part(self, value: float) -> float:
        """Where a value is: 0 at the low end, 1 at the high one."""
        return (math.log10(value) - self.low) / (self.high - self.low)

    def around(self, values: Iterable[float]) -> "LogAxis":
        """This axis, longer where values need it: what has been drawn once stays within it."""
        other = around(values)
        return self if other is None else LogAxis(min(self.low, other.low), max(self.high, other.high))

    def ticks(self, label: Callable[[float], str]) -> list[Tick]:
        """At powers of ten, and at 2 and 5 times those."""
        found = []
        for power in range(math.floor(self.low), math.ceil(self.high) + 1):
            for factor in (1, *MINOR):
                value = float(f"{factor}e{power}")
                if 0 <= self.part(value) <= 1:
                    found.append(Tick(self.part(value), label(value), factor in MINOR))
        return found


def around(values: Iterable[float]) -> LogAxis | None:
    """An axis that holds these values with some room; None if there are none."""
    logs = [math.log10(value) for value in values]
    if not logs:
        return None
    middle, half = 0.5 * (min(logs) + max(logs)), max(0.5 * (max(logs) - min(logs)) + ROOM, 0.5 * LEAST)
    return LogAxis(middle - half, middle + half)
