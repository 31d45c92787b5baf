"""A body's run on the stage: its frames, as far as they are computed, and what they show."""

import math
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from app.frame.colour_scale import largest_finite
from app.frame.goal_curve import GoalCurve
from app.frame.layout import Rectangle
from solvers.bodies.body_run_worker import FIELDS, BodyRunSummary, BodySample
from solvers.bodies.estimate import QUANTITIES
from solvers.bodies.goal import Goal
from solvers.bodies.goal_values import GoalValue

PADDING, ROUND = 0.03, 0.1  # of the body's longer side: around the motion so far; and steps in which the view grows


@dataclass(frozen=True)
class BodySource:
    """A body to run: its ``file``, which its owner calls ``name``, with other values of some fields (``changes``)."""

    file: Path
    name: str
    changes: dict[str, float] = field(default_factory=dict)


class ShownBody:
    """Run of a ``source``: ``body`` has its fields as in JSON, the ``table`` its particles, ``result`` is that of
    ``mpm-lab run`` once it has ended, ``largest`` the largest estimated error so far by quantity. One thread adds
    samples, any may read."""

    def __init__(self, source: BodySource, table: Path, begins: dict):
        summary = BodyRunSummary(**begins)
        self.source, self.body, self.warnings = source, summary.body, summary.warnings
        self.cells_step, self.particles, self.samples = summary.cells_step, summary.particles, summary.samples
        self.width = summary.width
        self._table = np.memmap(table, np.float32, "r", shape=(summary.samples + 1, summary.particles, FIELDS))
        self.times, self._samples = [0.0], list[BodySample]()
        self.goals = {name: Goal(one["value"], tuple(one["at"])) for name, one in self.body["goals"].items()}
        self.result: dict | None = None
        self._low, self._high = np.min(self.position(0), axis=0), np.max(self.position(0), axis=0)
        self._side = float((self._high - self._low).max())
        self.largest = dict.fromkeys(QUANTITIES, 0.0)

    def add(self, sample: dict) -> None:
        """Adds a sample that the worker has sent."""
        one = BodySample(**sample)
        x = self.position(len(self.times))
        self._low, self._high = np.minimum(self._low, x.min(axis=0)), np.maximum(self._high, x.max(axis=0))
        for column, quantity in enumerate(QUANTITIES, 2):
            found = largest_finite(self._table[len(self.times), :, column])
            self.largest[quantity] = max(self.largest[quantity], found)
        self._samples.append(one)
        self.times.append(one.time)

    @property
    def spacing(self) -> float:
        """Width of a cell in m."""
        return 1 / self.body["cells_per_metre"]

    @property
    def extent(self) -> Rectangle:
        """Rectangle x0, x1, y0, y1 in m of the motion so far, and room around it."""
        step = ROUND * self._side
        low = step * np.floor((self._low - PADDING * self._side) / step)
        high = step * np.ceil((self._high + PADDING * self._side) / step)
        return float(low[0]), float(high[0]), float(low[1]), float(high[1])

    def position(self, k: int) -> np.ndarray:
        """Returns the positions (P, 2) in m of the particles in frame ``k``."""
        return np.array(self._table[k, :, :2])

    def error_sizes(self, k: int, quantity: str) -> np.ndarray | None:
        """Returns the sizes (P,) of the estimated errors of a quantity in frame ``k``; None if it has none."""
        if quantity not in QUANTITIES or self.estimated_until < self.times[k]:
            return None
        return np.array(self._table[k, :, 2 + list(QUANTITIES).index(quantity)])

    def believed_sizes(self, k: int, quantity: str) -> np.ndarray | None:
        """Returns :meth:`error_sizes`, None also once they are known not to be believed."""
        trust = self.trust(quantity)
        return None if trust and trust[1] == "none" else self.error_sizes(k, quantity)

    def magnitude(self, quantity: str) -> float:
        """Returns what errors of a quantity are small against, in its unit: size, speed of waves, and stiffness."""
        body = self.body
        return {"x": self._side, "v": math.sqrt(body["youngs_modulus"] / body["density"]),
                "sigma": body["youngs_modulus"]}[quantity]

    @property
    def estimated_until(self) -> float:
        """Time in s of the last frame so far with an estimate."""
        return max((one.time for one in self._samples if not one.ended), default=0.0)

    @property
    def estimate_ended(self) -> bool:
        """Whether the companions have become useless in some frame so far, so that later ones have no estimate."""
        return bool(self._samples and self._samples[-1].ended)

    @property
    def remarks(self) -> list[str]:
        """Sentences on what limits the estimate, so far or at the end."""
        if self.result is not None:
            return self.result["remarks"]
        return [self._samples[-1].ended] if self.estimate_ended else []

    def trust(self, quantity: str) -> tuple[float, str] | None:
        """Returns delta and how far to believe the estimate of a quantity ("number", "30 %", "none"); None before the
        end, and for a quantity without an estimate."""
        estimate = (self.result or {}).get("estimate", {}).get(quantity)
        return estimate and (estimate["delta"], estimate["trust"])

    def goal_value(self, name: str) -> GoalValue | None:
        """Returns a goal's value so far, at the end that of the result; None before the first sample."""
        if self.result is not None:
            return GoalValue(**self.result["goals"][name])
        return GoalValue(*self._samples[-1].values[name]) if self._samples else None

    def curve(self, name: str) -> GoalCurve:
        """Returns the curve over time of what a goal is about, with its bars."""
        goal, now = self.goals[name], [one.now[name] for one in self._samples]
        axis = goal.parts[1]
        start = 0.0 if goal.is_stress else goal.at["xy".index(axis)]
        values, bars = np.array([(start, 0.0), *((value, math.nan if bar is None else bar) for value, bar in now)]).T
        return GoalCurve(name, f"σ {axis}" if goal.is_stress else axis, "Pa" if goal.is_stress else "m",
                         np.array(self.times), values, bars, self.body["t_end"])
