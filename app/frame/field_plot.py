"""The field plot: the particles' values of a quantity, the exact curve, and the differences as stems."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from time import monotonic
from typing import Any

import numpy as np

from app.frame.colour_scale import LEAST_REACH, SMALLEST, largest_finite, round_up
from app.frame.error_view_captions import FieldPlotCaption, add_unknown_count, field_plot_caption
from app.frame.layout import ComparedRunSlot, FieldPlotLayout
from app.frame.primitives import AWAY, Dots, Label, Lines, Mark, Role, in_plane, join_points
from app.language.translation import tr
from app.names_and_units import QUANTITIES, with_unit
from solvers.scene.scene import Scene

CURVE_POINTS = 121
INSTANTS = 32  # per period, at which the exact field is evaluated to set the range of the axis
STEPS = (1, 1.5, 2, 3, 4, 6, 8)  # times a power of ten: possible ends of an axis
SETTLING = 1.4  # seconds after a change for which the curve before it is shown and the axis only grows
ROOM = 1.1  # length of the axis over its last number
FADE = 0.985  # decay of the peak per frame when values shrink
SLACK = 0.4  # share of the axis below which it shrinks
MOST_STEMS = 2000  # particles with stems: more would be a grey area
#: Diameters of a particle in pixels: usual and least, and the part that it fills of the distance to the next one, so
#: that the exact line is seen between them; thickness of lines.
DOT, LEAST_DOT, FILLS = 4.0, 2.3, 0.85
CURVE_WIDTH, STEM, RING_WIDTH = 2.5, 1.5, 1.75
RING = 2.5  # pixels of the radius of a ring beyond that of its particle
_TURNS = np.linspace(0, 2 * np.pi, 17)
CIRCLE = np.stack([np.cos(_TURNS), np.sin(_TURNS), np.zeros(17)], axis=1).astype(np.float32)
NO_STEMS = Lines("field/stems", np.empty((0, 2, 3), np.float32), (0, 0, 0), STEM)
BEYOND = 0.01  # share of the axis by which dots may be outside it


class ValueAxis:
    """Value axis from -``top`` to ``top``, a round number in the unit of the values, which contains all values and
    shrinks slowly. The field plots of two runs share one. ``clock`` returns the present time in s."""

    def __init__(self, clock: Callable[[], float] = monotonic) -> None:
        self.clock, self._held_until = clock, -math.inf
        self._peak, self.top = 0.0, 1.0

    def reset(self) -> None:
        """Lets the next update set the top of the axis anew."""
        self._peak, self._held_until = 0.0, -math.inf

    def hold(self) -> None:
        """Lets the axis only grow until 1.4 s from now, when the next update sets its top anew."""
        self._held_until = self.clock() + SETTLING

    @property
    def is_outdated(self) -> bool:
        """Whether the axis has been held and may be set anew by now."""
        return -math.inf < self._held_until < self.clock()

    def update(self, largest: float, least: float) -> None:
        """Adjusts ``top`` to the ``largest`` size of a frame's values, which may be a tenth above it, or to ``least``
        if that is larger."""
        if self.is_outdated:
            self.reset()
        begun, need = self._peak > 0, max(largest / ROOM, least)
        holds = self.clock() < self._held_until
        self._peak = max(need, FADE * self._peak)
        if self._peak > SMALLEST and (not begun or need > self.top or (self._peak < SLACK * self.top and not holds)):
            self.top, _ = round_up(self._peak, STEPS)


@dataclass(frozen=True)
class FieldPlotDefinition:
    """Settings of a field plot: its horizontal axis from ``start`` to ``end`` in m, with texts at its ``ends``.

    ``exact(scene, quantity, X, t)`` returns exact values (n,) at reference positions X (n,) in m and the time t in s,
    and ``where(scene, X, t)`` their positions along the axis (n,) in m."""

    start: float
    end: float
    ends: tuple[str, str]
    exact: Callable[[Any, str, np.ndarray, float], np.ndarray]
    where: Callable[[Any, np.ndarray, float], np.ndarray]


class FieldPlot:
    """Field plot: particles as dots around the exact curve, with stems from it; those that have changed their cell
    have rings. It shares the value axis of a plot ``beside`` it."""

    def __init__(self, plotted: FieldPlotDefinition, beside: "FieldPlot | None" = None):
        self._plotted, self._beside = plotted, beside
        self.axis: ValueAxis = beside.axis if beside else ValueAxis()
        self._values: tuple[np.ndarray, np.ndarray] | None = None  # places and values of the particles drawn last
        self._before: tuple[np.ndarray, np.ndarray] | None = None  # those before a change of the run ...
        self._before_until = -math.inf  # ... which are shown until then
        self._drawn: tuple[Scene, str, int, FieldPlotLayout] | None = None
        self._labelled: tuple[int, float] | None = None  # as drawn: count of NaN values, and end of the axis
        self._time = 0.0
        self._dots = np.empty((0, 3), np.float32)

    @property
    def shared_axis_changed(self) -> bool:
        """Whether the plot that shares the value axis has changed it since this one was drawn."""
        return self._labelled is not None and self._labelled[1] != self.axis.top

    @property
    def is_outdated(self) -> bool:
        """Whether the plot has to be drawn again, although no frame has come."""
        return self.axis.is_outdated or (self._before is not None and self.axis.clock() > self._before_until)

    @property
    def shows_before(self) -> bool:
        """Whether this plot, or the one beside it, shows the curve before a change."""
        return self._before is not None or (self._beside is not None and self._beside.shows_before)

    def draw(self, places: FieldPlotLayout, scene: Scene, quantity: str, magnified: int, at: np.ndarray,
             field: np.ndarray, t: float, crossed: np.ndarray) -> Iterator[Mark]:
        """Yields the marks of the field of a quantity (key x, v, sigma or a) at the time t in s in a layout ``places``.

        ``at`` (P,) are the particles' positions along the axis in m; ``field`` (P, 2) has their values and the
        deviations from the exact ones, in the unit of the quantity, which are drawn with the factor ``magnified``;
        ``crossed`` (P,) of bool are those that are marked as having changed their cell."""
        if (now := (scene, quantity, magnified, places)) != self._drawn or t < self._time:
            if self._drawn and scene != self._drawn[0] and now[1:] == self._drawn[1:]:
                self.axis.hold()
                self._keep_curve_before()
            elif self._drawn is None or now[:3] != self._drawn[:3] or t < self._time:
                self.axis.reset()
            self._labelled = None
            self._prepare_value_range(places, scene, quantity)
        self._drawn, self._time = now, t
        values = magnify_deviation(scene, field, magnified)
        known = np.isfinite(values)
        self.axis.update(largest_finite(np.abs(values)), self._reach)
        unknown = len(values) - int(np.count_nonzero(known))
        if (said := (unknown, self.axis.top)) != self._labelled:
            self._labelled = said
            yield from self._axis_marks(places, scene, quantity, magnified, unknown)
        self._dots, self._values = self._stage_points(at, values, known), (at, values)
        yield self._curve_before(places)
        yield from self._exact_curve_marks(places, scene, quantity, t)
        yield self._deviation_stems(places, scene, field, magnified)
        metrics = places.stage_metrics
        apart = (self._box.right - self._box.left) / max(1, len(values))
        size = min(DOT * metrics.pixel, max(FILLS * apart, LEAST_DOT / metrics.pixels))
        yield Dots("field/particles", self._dots, self._ink, size)
        rings = (0.5 * size + RING * metrics.pixel) * CIRCLE + self._dots[crossed][:, None]
        rings[:, :, 2] = 0.016
        yield Lines("field/crossed", np.stack([rings[:, :-1], rings[:, 1:]], axis=2).reshape(-1, 2, 3),
                    metrics.palette.crossing, RING_WIDTH)

    def dot_positions(self, particles: slice, count: int) -> np.ndarray:
        """Returns the points (count, 3) of the stage where the dots of ``count`` particles (a slice of all) are drawn;
        points out of view if the plot is not drawn."""
        dots = self._dots[particles]
        return dots if len(dots) == count else np.full((count, 3), AWAY, np.float32)

    def _keep_curve_before(self) -> None:
        """Keeps what is drawn, at the first of several changes, until 1.4 s after the last one."""
        clock = self.axis.clock()
        if self._before is None and self._beside is None:
            self._before = self._values
        self._before_until = clock + SETTLING

    def _curve_before(self, places: FieldPlotLayout) -> Lines:
        """Returns the curve through the particles' values before a change, while it is to be seen."""
        if self.axis.clock() > self._before_until:
            self._before = None
        curve = np.empty((0, 2, 3), np.float32)
        if self._before is not None:
            at, values = self._before
            known = np.isfinite(values) & (np.abs(values) < ROOM * self.axis.top)
            points = in_plane(self._abscissae(at[known]), self._heights(values[known]), 0.006)
            curve = join_points(points[:-1], points[1:])
        return Lines("field/before", curve, places.stage_metrics.palette.before, CURVE_WIDTH)

    def _prepare_value_range(self, places: FieldPlotLayout, scene: Scene, quantity: str) -> None:
        """Prepares the plot of another scene, quantity or layout: stores its box, and the range of the exact field."""
        self._at: np.ndarray | None = None
        plotted, box, self._least = self._plotted, places.field, 0.5 * DOT * places.stage_metrics.pixel
        self._box, self._per_metre = box, (box.right - box.left) / (plotted.end - plotted.start)
        self._line = np.linspace(plotted.start, plotted.end, CURVE_POINTS)
        level = in_plane(np.linspace(box.left, box.right, CURVE_POINTS), box.middle, 0.01)
        self._level = join_points(level[:-1], level[1:])  # the curve of a field that is zero
        self._reach = 0.0
        if not scene.swings:  # round-off should not fill the plot
            self._reach = LEAST_REACH * scene.size_of(quantity)
        else:
            times = scene.time_step + scene.period * np.arange(INSTANTS) / INSTANTS
            self._reach = max(largest_finite(np.abs(plotted.exact(scene, quantity, self._line, t))) for t in times)

    def _axis_marks(self, places: FieldPlotLayout, scene: Scene, quantity: str, magnified: int,
                    unknown: int) -> Iterator[Mark]:
        """Yields the axes with their labels; ``unknown`` is the number of particles without a value."""
        box, colours = self._box, places.stage_metrics.palette
        self._ink = np.array(colours.dot, np.uint8)
        end = ROOM * box.half
        axes = in_plane(np.array([box.left, box.right, box.left, box.left]),
                        box.middle + np.array([0, 0, -end, end]), -0.005).reshape(2, 2, 3)
        yield Lines("field/axes", axes, colours.axis, 1.0)
        words = field_plot_caption(scene, quantity)
        number = with_unit(self.axis.top, QUANTITIES[quantity].unit)
        yield from plot_labels(places, self._plotted.ends,
                               FieldPlotCaption(words.name, add_unknown_count(words.remark, unknown)), magnified,
                               number)

    def _exact_curve_marks(self, places: FieldPlotLayout, scene: Scene, quantity: str, t: float) -> Iterator[Mark]:
        """Yields the exact curve at the time t in s."""
        curve = self._level
        if scene.swings:
            curve = curve.copy()
            heights = self._heights(self._plotted.exact(scene, quantity, self._line, t))
            curve[:, 0, 1], curve[:, 1, 1] = heights[:-1], heights[1:]
            along = self._abscissae(self._plotted.where(scene, self._line, t))
            curve[:, 0, 0], curve[:, 1, 0] = along[:-1], along[1:]
        yield Lines("field/exact", curve, places.stage_metrics.palette.exact, CURVE_WIDTH)

    def _deviation_stems(self, places: FieldPlotLayout, scene: Scene, field: np.ndarray, magnified: int) -> Lines:
        """Returns stems from exact values to the particles', where they are longer than a dot."""
        dots = self._dots
        if len(dots) > MOST_STEMS:
            return NO_STEMS
        long = np.float32(self._box.half / self.axis.top * magnified) * field[:, 1]
        drawn = np.flatnonzero(np.abs(long) > self._least)
        if not len(drawn):
            return NO_STEMS
        drawn = drawn[dots[drawn, 1] > AWAY]
        segments = np.repeat(dots[drawn, None], 2, axis=1)
        segments[:, 0, 1] -= long[drawn]
        segments[:, :, 2] = 0.008
        return Lines("field/stems", segments, places.stage_metrics.palette.stem, STEM)

    def _stage_points(self, at: np.ndarray, values: np.ndarray, known: np.ndarray) -> np.ndarray:
        """Returns points (n, 3) of the stage for values (n,) at positions ``at`` (n,) in m along the axis; where
        ``known`` (n,) is false, or the position is off the axis, at the height ``AWAY``."""
        box, out = self._box, np.empty((len(values), 3), np.float32)
        if at is not self._at:  # constant in the plane
            self._at, self._across = at, self._abscissae(at)
            self._near = np.abs(self._across - 0.5 * (box.left + box.right)) <= (0.5 + BEYOND) * (box.right - box.left)
        out[:, 0], out[:, 2] = self._across, 0.012
        out[:, 1] = np.where(known & self._near, self._heights(values), AWAY)
        return out

    def _abscissae(self, at: np.ndarray) -> np.ndarray:
        return self._box.left + self._per_metre * (at - self._plotted.start)

    def _heights(self, values: np.ndarray) -> np.ndarray:
        return self._box.middle + self._box.half / self.axis.top * values


def plot_labels(places: FieldPlotLayout, ends: tuple[str, str], words: FieldPlotCaption, magnified: int,
                number: str) -> Iterator[Label]:
    """Yields the labels of a field plot in a layout, always the same ones: the text ``number`` at the upper end of its
    value axis, the texts ``ends`` at those of the other, name and remark from ``words``, and the factor ``magnified``
    of deviations."""
    box, metrics = places.field, places.stage_metrics
    beside = box.left > 0 or metrics.gutter > 0  # otherwise only the upper number fits, within the plot
    left = box.at is not None and box.at[0] < 0  # the name stands beside the zero
    crowded = left and 1.2 * metrics.text_width(words.name) + metrics.text_width(" 0") > metrics.gutter
    for key, text, y in (("low", f"−{number}", -box.half), ("zero", "" if crowded else "0", 0.0)):
        yield Label(f"field/{key}", text if beside else "", box.left - 0.01, box.middle + y, "center-right", "number")
    yield Label("field/high", f"+{number}", box.left - 0.01 if beside else 0.01,
                box.middle + (box.half if beside else ROOM * box.half), "center-right" if beside else "top-left",
                "number")
    below, written = box.below or 0.0, box.below is not None
    if metrics.text_width("  ".join(ends)) > box.right - box.left:  # too narrow for both: as one
        ends = f"{ends[0].rpartition(' ')[0]}–{ends[1]}", ""
    yield Label("field/start", ends[0] if written else "", box.left, below, "top-left", "number")
    yield Label("field/end", ends[1] if written else "", box.right, below, "top-right", "number")
    x, y, anchor = box.magnified or box.remark
    larger = tr("error × {magnified}", magnified=magnified) if box.magnified and magnified > 1 else ""
    yield Label("field/magnified", larger, x, y, anchor, "caption")
    x, y, anchor = box.remark
    named = words.name if box.at is None and places.slot == ComparedRunSlot.ALONE else ""  # else the scale has it
    yield Label("field/remark", ": ".join(filter(None, (named, words.remark))), x, y, anchor, "caption")
    x, y = box.at or (0.0, 0.0)
    role: Role = "gutter" if x < 0 else "title"
    size = 1.1 if x >= 0 else 1.0  # in the gutter it stands beside the axis's numbers
    yield Label("field/name", words.name if box.at else "", x, y, "center-left", role, size, bold=True)


def magnify_deviation(scene: Scene, field: np.ndarray, magnified: int) -> np.ndarray:
    """Returns the values (P,) to plot, from those of a ``field`` and their deviations from the exact ones (P, 2), in
    one unit: with deviations ``magnified`` times as large; only these deviations if the scene does not oscillate."""
    if scene.swings and magnified == 1:
        return field[:, 0]
    with np.errstate(over="ignore", invalid="ignore"):
        return field[:, 0] + (magnified - 1) * field[:, 1] if scene.swings else magnified * field[:, 1]
