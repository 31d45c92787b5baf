"""What a goal of a body is about, over time, with its bars."""

import math
from dataclasses import dataclass

import numpy as np

from app.frame.colour_scale import round_up
from app.frame.value_and_bar import value_and_bar

ROUND, PARTS = (1, 2, 5), 2.5  # steps of the numbers at the axis of values, times a power of ten; least parts of it


@dataclass(frozen=True, eq=False)
class GoalCurve:
    """Curve of a goal called ``name``: ``values`` (n,) in ``unit`` of what it is about, y of a point or a stress, and
    the half widths of its ``bars`` (n,), NaN where there is none, at ``times`` (n,) in s; the run ``ends`` at a time in
    s."""

    name: str
    symbol: str
    unit: str
    times: np.ndarray
    values: np.ndarray
    bars: np.ndarray
    ends: float

    def value_and_bar(self, k: int) -> tuple[str, str]:
        """Returns value and bar at a time as texts, "" if there is no bar."""
        return value_and_bar(float(self.values[k]), float(self.bars[k]), self.unit)


def round_levels(curve: GoalCurve) -> list[float]:
    """Returns evenly spaced round numbers, from one at or below the curve and its bars to one at or above them."""
    bars = np.nan_to_num(curve.bars)
    bottom, top = float((curve.values - bars).min()), float((curve.values + bars).max())
    step = round_up((top - bottom or abs(top) or 1.0) / PARTS, ROUND)[0]
    first = math.floor(bottom / step)
    return [step * k for k in range(first, max(math.ceil(top / step), first + 1) + 1)]
