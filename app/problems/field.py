"""The field plot: the quantity whose error is shown, of the particles and exact, against where they were at rest."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import viser

from app import drawing
from app.axis import ROOM, Axis
from app.colours import TRUTH
from app.frame.captions import counting, field_caption
from app.scale import LEAST_REACH, largest
from app.words import QUANTITIES, with_unit
from solvers.scene.scene import Scene

CURVE_POINTS = 121
INSTANTS = 32  # of a period at which the exact field is looked at, for the axis to hold all of it from the first on


@dataclass(frozen=True)
class Place:
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
    """Particles as dots on the exact curve, those that have just crossed a cell boundary in magenta."""

    def __init__(self, s: viser.SceneApi, problem: str, place: Place, size: float):
        def name(part: str) -> str:
            return f"/{problem}/field/{part}"

        self.root = s.add_frame(f"/{problem}/field", show_axes=False)
        self._place, self._axis = place, Axis()
        self._drawn: tuple[Scene, str, int] | None = None
        self._said: tuple[int, float] | None = None  # of what is drawn: numbers that are none, and the axis
        self._time = 0.0
        self._curve = drawing.lines(s, name("exact"), drawing.rgb(TRUTH), 3.0)
        self._dots = drawing.points(s, name("particles"), size)
        self._crossed = drawing.points(s, name("crossed"), 1.6 * size)
        for cloud, colour in ((self._dots, drawing.DOT), (self._crossed, drawing.FLASH)):
            cloud.colors = np.array(colour, np.uint8)  # of all: one each would cost a fifth of the bytes
        high, low = place.middle + place.height, place.middle - place.height
        ends = place.middle + ROOM * place.height * np.array([0, 0, -1, 1])
        drawing.lines(s, name("axes"), drawing.FAINT, 1.0).points = drawing.in_plane(
            np.array([0.0, 1.0, 0.0, 0.0]), ends, -0.01).reshape(2, 2, 3)
        self._numbers = [drawing.label(s, name(f"number{k}"), " ", -0.01, y, "center-right", 0.85)
                         for k, y in enumerate((low, high))]
        drawing.label(s, name("zero"), "0", -0.01, place.middle, "center-right", 0.85)
        below = low - 0.035
        drawing.label(s, name("start"), place.ends[0], 0.0, below, "top-center", 0.85)
        drawing.label(s, name("end"), place.ends[1], 1.0, below, "top-center", 0.85)
        self._caption = drawing.label(s, name("caption"), " ", 0.5, below, "top-center", 0.85)
        self.lent = Dots(self, s, name("pinned"), size)

    def draw(self, scene: Scene, quantity: str, magnified: int, at: np.ndarray, field: np.ndarray, t: float,
             crossed: np.ndarray) -> None:
        """Show the ``field`` (P, 2) of particles at rest ``at`` (P,) in metres: values and their deviations from the
        exact, which are drawn ``magnified`` times. ``crossed`` (P,) says which have just crossed a cell boundary."""
        if (scene, quantity, magnified) != self._drawn or t < self._time:
            self._axis.forget()
            self._said = None
            self._begin(scene, quantity)
        self._drawn, self._time = (scene, quantity, magnified), t
        values = seen(scene, field, magnified)
        self._axis.follow(max(largest(np.abs(values)), self.lent.reach), self._reach)
        unknown = len(values) - int(np.count_nonzero(np.isfinite(values)))
        if (unknown, self._axis.top) != self._said:
            self._said = unknown, self._axis.top
            self._caption_it(scene, quantity, magnified, unknown)
            self._number(QUANTITIES[quantity].unit)
        points = self.points(at, values)
        drawing.put(self._dots, points)
        shown = points[crossed]
        shown[:, 2] = 0.015
        drawing.put_few(self._crossed, shown)
        if scene.solution_known:
            heights, curve = self._heights(self._place.exact(scene, quantity, self._line, t)), self._level.copy()
            curve[:, 0, 1], curve[:, 1, 1] = heights[:-1], heights[1:]
            drawing.put(self._curve, curve)

    def places(self, particles: slice, count: int) -> np.ndarray:
        """Where the dots of ``count`` particles are, (count, 3); away while none are drawn."""
        dots = self._dots.points[particles]
        return dots if len(dots) == count else np.full((count, 3), drawing.AWAY, np.float32)

    def _begin(self, scene: Scene, quantity: str) -> None:
        """Another scene or quantity: how far the exact field reaches."""
        place = self._place
        self._line = np.linspace(place.start, place.end, CURVE_POINTS)
        level = drawing.in_plane(np.linspace(0, 1, CURVE_POINTS), 0.0, 0.01)
        self._level = drawing.joined(level[:-1], level[1:])  # the curve but for its heights
        self._curve.visible = scene.solution_known
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
        out[:, 1] = np.where(np.isfinite(heights), heights, drawing.AWAY)
        out[:, 2] = 0.01
        return out

    def _heights(self, values: np.ndarray) -> np.ndarray:
        return self._place.middle + self._place.height / self._axis.top * values

    def _number(self, unit: str) -> None:
        top = with_unit(self._axis.top, unit)
        for handle, text in zip(self._numbers, (f"−{top.split()[0]}", top), strict=True):  # little room: the unit once
            drawing.write(handle, text)

    def _caption_it(self, scene: Scene, quantity: str, magnified: int, unknown: int) -> None:
        text = counting(field_caption(scene, self._place.component, quantity, magnified), unknown)
        drawing.write(self._caption, text)


class Dots:
    """The particles of a pinned run, in grey behind those of a field plot and against its axis."""

    def __init__(self, plot: FieldPlot, s: viser.SceneApi, name: str, size: float):
        self._plot, self._dots = plot, drawing.points(s, name, size)
        self._dots.colors = np.array(drawing.FAINT, np.uint8)
        self.reach = 0.0  # of the values, which the axis should hold

    def draw(self, scene: Scene, quantity: str, magnified: int, at: np.ndarray, field: np.ndarray, t: float,
             crossed: np.ndarray) -> None:
        """As the plot's own; crossings are not marked."""
        values = seen(scene, field, magnified)
        points, self.reach = self._plot.points(at, values), largest(np.abs(values))
        points[:, 2] = 0.0
        drawing.put(self._dots, points)

    def forget(self) -> None:
        """Show nothing."""
        self.reach = 0.0
        drawing.put_few(self._dots, np.empty((0, 3), np.float32))


def seen(scene: Scene, field: np.ndarray, magnified: int) -> np.ndarray:
    """Values (P,) as they are drawn: exact plus ``magnified`` times the deviation of a ``field`` (P, 2), where the
    exact one is known."""
    if magnified == 1 or not scene.solution_known:
        return field[:, 0]
    with np.errstate(over="ignore", invalid="ignore"):
        return field[:, 0] + (magnified - 1) * field[:, 1]
