"""The field plot: the quantity whose error is shown, of the particles and exact, against where they were at rest."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from app.colours import TRUTH, rgb
from app.frame.captions import counting, field_caption
from app.frame.marks import AWAY, DOT, FAINT, FLASH, Dots, Label, Lines, Mark, in_plane, joined
from app.frame.scale import LEAST_REACH, SMALLEST, largest, round_up
from app.words import QUANTITIES, with_unit
from solvers.scene.scene import Scene

CURVE_POINTS = 121
EXACT, OWN, CROSSED, OTHER = rgb(TRUTH), *(np.array(colour, np.uint8) for colour in (DOT, FLASH, FAINT))
INSTANTS = 32  # of a period at which the exact field is looked at, for the axis to hold all of it from the first on
STEPS = (1, 1.5, 2, 3, 4, 5, 6, 8)  # times a power of ten: what an axis may end at
ROOM = 1.1  # an axis goes on so far beyond its last number, and values with it
FADE = 0.985  # per frame: how slowly the axis follows when values shrink
SLACK = 0.4  # of its height that values must fall below before it does


class Axis:
    """The axis of a plot whose values come and go: it ends at round numbers, holds all that is there and moves calmly.

    It goes from -``top`` to ``top``; what is within ``ROOM`` times that is on it."""

    def __init__(self) -> None:
        self._peak, self.top = 0.0, 1.0

    def forget(self) -> None:
        """Begin anew with the next frame."""
        self._peak = 0.0

    def follow(self, largest: float, least: float) -> None:
        """Take in the ``largest`` size of a frame's values; never show less than up to ``least``."""
        begun, need = self._peak > 0, max(largest, least)
        self._peak = max(need, FADE * self._peak)
        if self._peak > SMALLEST and (not begun or need > ROOM * self.top or self._peak < SLACK * self.top):
            self.top, _ = round_up(self._peak / ROOM, STEPS)


@dataclass(frozen=True)
class PlotPlace:
    """Where a plot stands, from x = 0 to 1 of the stage: ``middle`` and ``height`` (of the upper half) of its axis.

    It is plotted against a coordinate at rest from ``start`` to ``end`` in metres, in words ``ends``;
    ``exact(scene, quantity, coordinates, t)`` is what the particles should have, and ``component`` what of it.
    """

    middle: float
    height: float
    start: float
    end: float
    ends: tuple[str, str]
    exact: Callable[[Any, str, np.ndarray, float], np.ndarray]
    component: str = ""


class FieldPlot:
    """Particles as dots of a ``size`` on the exact curve, those that have just crossed a cell boundary in magenta.

    ``raised`` is how much higher than its place the plot is, where something else needs that.
    """

    def __init__(self, place: PlotPlace, size: float):
        self._place, self._axis, self.size, self.raised = place, Axis(), size, 0.0
        self._drawn: tuple[Scene, str, int] | None = None
        self._said: tuple[int, float, float] | None = None  # of what is drawn: numbers that are none, axis and height
        self._time = 0.0
        self._dots = np.empty((0, 3), np.float32)
        self.lent = PinnedField(self)

    def draw(self, scene: Scene, quantity: str, magnified: int, at: np.ndarray, field: np.ndarray, t: float,
             crossed: np.ndarray) -> Iterator[Mark]:
        """The marks of a field.

        Parameters
        ----------
        scene
        quantity
            Key of x, v, sigma or a.
        magnified
            How many times deviations are drawn.
        at : (P,) array, m
            Where the particles were at rest.
        field : (P, 2) array, in the unit of the quantity
            Values, and their deviations from the exact ones.
        t : float, s
        crossed : (P,) array of bool
            Which have just crossed a cell boundary.
        """
        if (scene, quantity, magnified) != self._drawn or t < self._time:
            self._axis.forget()
            self._said = None
            self._begin(scene, quantity)
        self._drawn, self._time = (scene, quantity, magnified), t
        values = seen(scene, field, magnified)
        self._axis.follow(max(largest(np.abs(values)), self.lent.reach), self._reach)
        unknown = len(values) - int(np.count_nonzero(np.isfinite(values)))
        if (now := (unknown, self._axis.top, self.raised)) != self._said:
            self._said = now
            ends = self._place.middle + self.raised + ROOM * self._place.height * np.array([0, 0, -1, 1])
            axes = in_plane(np.array([0.0, 1.0, 0.0, 0.0]), ends, -0.01).reshape(2, 2, 3)
            yield Lines("field/axes", axes, FAINT, 1.0)
            top = with_unit(self._axis.top, QUANTITIES[quantity].unit)
            yield from labels(self._place, self.raised, f"−{top.split()[0]}", top,  # little room: the unit once
                              counting(field_caption(scene, self._place.component, quantity, magnified), unknown))
        self._dots = self.points(at, values)
        yield Dots("field/particles", self._dots, OWN, self.size)
        shown = self._dots[crossed]
        shown[:, 2] = 0.015
        yield Dots("field/crossed", shown, CROSSED, 1.6 * self.size)
        curve = self._level[:0]
        if scene.solution_known:
            heights, curve = self._heights(self._place.exact(scene, quantity, self._line, t)), self._level.copy()
            curve[:, 0, 1], curve[:, 1, 1] = heights[:-1], heights[1:]
        yield Lines("field/exact", curve, EXACT, 3.0)

    def places(self, particles: slice, count: int) -> np.ndarray:
        """Where the dots of ``count`` particles are, (count, 3); away while none are drawn."""
        dots = self._dots[particles]
        return dots if len(dots) == count else np.full((count, 3), AWAY, np.float32)

    def _begin(self, scene: Scene, quantity: str) -> None:
        """Another scene or quantity: how far the exact field reaches."""
        place = self._place
        self._line = np.linspace(place.start, place.end, CURVE_POINTS)
        level = in_plane(np.linspace(0, 1, CURVE_POINTS), 0.0, 0.01)
        self._level = joined(level[:-1], level[1:])  # the curve but for its heights
        self._reach = 0.0
        if scene.solution_known:
            times = scene.time_step + scene.period * np.arange(INSTANTS) / INSTANTS
            self._reach = max(largest(np.abs(place.exact(scene, quantity, self._line, t))) for t in times)
        if not scene.swings:  # round-off should not fill the plot
            self._reach = max(self._reach, LEAST_REACH * scene.size_of(quantity))

    def points(self, at: np.ndarray, values: np.ndarray) -> np.ndarray:
        """Points of the stage (n, 3) for values at coordinates (n,); away where a value is not finite."""
        place, out = self._place, np.empty((len(values), 3), np.float32)
        with np.errstate(invalid="ignore"):
            out[:, 0] = (at - place.start) / (place.end - place.start)
            heights = self._heights(values)
        out[:, 1] = np.where(np.isfinite(heights), heights, AWAY)
        out[:, 2] = 0.01
        return out

    def _heights(self, values: np.ndarray) -> np.ndarray:
        return self._place.middle + self.raised + self._place.height / self._axis.top * values


class PinnedField:
    """The particles of a pinned run, in grey behind those of a field plot and against its axis."""

    def __init__(self, plot: FieldPlot):
        self._plot = plot
        self.reach = 0.0  # of the values, which the axis should hold

    def draw(self, scene: Scene, quantity: str, magnified: int, at: np.ndarray, field: np.ndarray, t: float,
             crossed: np.ndarray) -> Iterator[Mark]:
        """As the plot's own; crossings are not marked."""
        values = seen(scene, field, magnified)
        points, self.reach = self._plot.points(at, values), largest(np.abs(values))
        points[:, 2] = 0.0
        yield self._dots(points)

    def forget(self) -> Mark:
        """The mark that shows nothing."""
        self.reach = 0.0
        return self._dots(np.empty((0, 3), np.float32))

    def _dots(self, points: np.ndarray) -> Dots:
        return Dots("field", points, OTHER, self._plot.size)


def labels(place: PlotPlace, raised: float, low: str, high: str, told: str) -> Iterator[Label]:
    """What is written at a plot: the ``low`` and ``high`` end of its axis, those of the body, and a caption."""
    middle = place.middle + raised
    below = middle - place.height - 0.035
    for name, text, y in (("low", low, middle - place.height), ("zero", "0", middle),
                          ("high", high, middle + place.height)):
        yield Label(f"field/{name}", text, -0.01, y, "center-right", "number", 0.85)
    for name, text, x in (("start", place.ends[0], 0.0), ("end", place.ends[1], 1.0)):
        yield Label(f"field/{name}", text, x, below, "top-center", "number", 0.85)
    yield Label("field/caption", told, 0.5, below, "top-center", "caption", 0.85)


def seen(scene: Scene, field: np.ndarray, magnified: int) -> np.ndarray:
    """Values (P,) as they are drawn: exact plus ``magnified`` times the deviation of a ``field`` (P, 2), where the
    exact one is known."""
    if magnified == 1 or not scene.solution_known:
        return field[:, 0]
    with np.errstate(over="ignore", invalid="ignore"):
        return field[:, 0] + (magnified - 1) * field[:, 1]
