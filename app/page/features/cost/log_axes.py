"""Logarithmic axes of the Cost tab's chart, of times and of errors, and where a run is on them."""

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

from app.page.features.cost.visitor_run_list import NumberedRun

ROOM = 0.12  # margin around the values in decades
LEAST = 1.0  # decades that an axis has at least
MINOR = (2, 5)  # times a power of ten: minor ticks, hidden in a narrow chart
MOST_BELOW = 2  # decades below all errors to which a tolerance may extend the axis


@dataclass(frozen=True)
class Tick:
    """Tick at ``position`` of an axis, from 0 (low end) to 1; ``minor`` if its value is no power of ten."""

    position: float
    label: str
    minor: bool


@dataclass(frozen=True)
class LogAxis:
    """Logarithmic axis from ``low`` to ``high``, which are decimal logarithms of its values."""

    low: float
    high: float

    def position(self, value: float) -> float:
        """Returns the position of a value above 0: 0 at the low end, 1 at the high one."""
        return (math.log10(value) - self.low) / (self.high - self.low)

    def extend_to(self, values: Iterable[float]) -> "LogAxis":
        """Returns this axis, extended to contain the values, all above 0, with a margin."""
        other = axis_around(values)
        return self if other is None else LogAxis(min(self.low, other.low), max(self.high, other.high))

    def ticks(self, label: Callable[[float], str]) -> list[Tick]:
        """Returns ticks at powers of ten, and at 2 and 5 times those; ``label`` formats a value."""
        found = []
        for power in range(math.floor(self.low), math.ceil(self.high) + 1):
            for factor in (1, *MINOR):
                value = float(f"{factor}e{power}")
                if 0 <= self.position(value) <= 1:
                    found.append(Tick(self.position(value), label(value), factor in MINOR))
        return found


def axis_around(values: Iterable[float]) -> LogAxis | None:
    """Returns an axis that contains these values, all above 0, with a margin; None if there are none."""
    logs = [math.log10(value) for value in values]
    if not logs:
        return None
    middle, half = 0.5 * (min(logs) + max(logs)), max(0.5 * (max(logs) - min(logs)) + ROOM, 0.5 * LEAST)
    return LogAxis(middle - half, middle + half)


UNTIMED, UNMEASURED = LogAxis(-4.3, -0.7), LogAxis(-3.3, -0.7)  # axes before anything is known


@dataclass(frozen=True)
class Axes:
    """Axes of times in s, if any is known, and of relative errors; they only grow, so that dots stay in place."""

    times: LogAxis | None
    error_axis: LogAxis

    @property
    def time_axis(self) -> LogAxis:
        return self.times or UNTIMED

    def run_position(self, run: NumberedRun) -> tuple[float, float]:
        """Returns a run's position from left and top in %; a broken run is at the top, an untimed one at the left."""
        return (percent(self.time_axis.position(run.seconds)) if run.timed_alone else 0.0,
                0.0 if run.broken else percent(1 - self.error_axis.position(run.error_or_estimate)))


def axes_for(runs: Sequence[NumberedRun], tolerance: float, before: Axes | None = None) -> Axes:
    """Returns axes that contain the runs, the relative tolerance (NaN for none) and the axes ``before``."""
    times = [run.seconds for run in runs if run.drawable and run.timed_alone]
    errors = [run.error_or_estimate for run in runs if run.drawable and not run.broken]
    least = min(errors, default=1e-2) / 10**MOST_BELOW
    wanted = [max(tolerance, least)] if math.isfinite(tolerance) else []
    if before is None:
        up = axis_around([*errors, *wanted]) if errors else None
        return Axes(axis_around(times), up or UNMEASURED.extend_to(wanted))
    return Axes(before.times.extend_to(times) if before.times else axis_around(times),
                before.error_axis.extend_to([*errors, *wanted]))


def percent(part: float) -> float:
    """Returns a part of 1 in %, to two decimals."""
    return round(100 * part, 2)
