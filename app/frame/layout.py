"""Layout of a stage within its bounds, common to all problems, and the colour bar."""

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum

import numpy as np

from app.frame.colour_scale import MOST_TICKS, ColourScale
from app.frame.primitives import Anchor, Dots, Label, StageMetrics, Surface, Tone, in_plane
from app.language.translation import tr
from app.names_and_units import QUANTITIES

Rectangle = tuple[float, float, float, float]  # x0, x1, y0, y1
HALVES: tuple[Tone, Tone] = ("estimate", "truth")
EDGE = 0.015  # drawn beyond x = 0 and 1
#: In pixels: height of the colour bar, distance to its numbers, from these to the rest, and space above it.
BAR, TICK, TICK_LINE, ABOVE = 10.0, 4.0, 17.0, 4.0
POINTS = 256  # of the colour bar


class ComparedRunSlot(Enum):
    """Slot of a run on the stage: alone, or the first or second of two."""

    ALONE, FIRST, SECOND = range(3)


Spot = tuple[float, float, Anchor]  # position and anchor of a text


@dataclass(frozen=True)
class PlotBox:
    """Box of a plot in stage coordinates: from x = ``left`` to ``right``, the zero of its values at the height
    ``middle`` and the ends of their axis ``half`` above and below. Labels of the horizontal axis are at the height
    ``below``; the factor ``magnified`` and a ``remark`` are at spots; its name begins at a point ``at``. None if
    something does not fit."""

    left: float
    right: float
    middle: float
    half: float
    below: float | None
    magnified: Spot | None
    remark: Spot
    at: tuple[float, float] | None = None


@dataclass(frozen=True)
class StageLayout:
    """Layout of a run in a ``slot`` of a stage: its rounded metrics, and the ``rectangle`` of everything."""

    stage_metrics: StageMetrics
    slot: ComparedRunSlot
    rectangle: Rectangle


@dataclass(frozen=True)
class FieldPlotLayout(StageLayout):
    """Layout of a run with a field plot, which is in the box ``field``."""

    field: PlotBox


@dataclass(frozen=True)
class ColourBarBox:
    """Box of the colour bar in stage coordinates: its height ``high`` around the height ``middle``, the heights of its
    ``numbers`` and of the ``end``, below which everything else is, and the spots of its title and quantity."""

    middle: float
    high: float
    numbers: float
    title: Spot
    quantity: Spot
    end: float


def drawing_rectangle(high: float) -> Rectangle:
    """Returns the rectangle (x0, x1, y0, y1) of everything drawn on a stage of the height ``high``, without gutter."""
    return -EDGE, 1 + EDGE, 0.0, high


def colour_bar_box(metrics: StageMetrics, high: float) -> ColourBarBox:
    """Returns the box of the colour bar at the top of a stage with these metrics and the height ``high``; its title is
    above the bar if the stage has no gutter."""
    pixel = metrics.pixel
    first = high - ABOVE * pixel - (0.0 if metrics.gutter else 1.2 * metrics.line_height)
    middle, numbers = first - 0.5 * BAR * pixel, first - (BAR + TICK) * pixel
    row = numbers - 0.5 * metrics.line_height
    title: Spot = (-metrics.gutter, middle, "center-left") if metrics.gutter else (0.0, high, "top-left")
    quantity: Spot = (-metrics.gutter, row, "center-left") if metrics.gutter else (60 * pixel, high, "top-left")
    return ColourBarBox(middle, BAR * pixel, numbers, title, quantity, numbers - TICK_LINE * pixel)


class ColourBarDrawing:
    """Colour bar of a scale, drawn on a surface of its own as square points, which alone show colours unchanged."""

    def __init__(self, sheet: Surface, scale: ColourScale):
        self.sheet, self._scale = sheet, scale
        self._drawn: tuple | None = None

    def draw(self, quantity: str, high: float) -> None:
        """Draws the bar on a stage of the height ``high``, unless nothing has changed; ``quantity`` is the key (x, v,
        sigma or a) of the quantity whose errors the scale measures."""
        scale, metrics = self._scale, self.sheet.stage_metrics
        now = (metrics, high, quantity, *scale.appearance)
        if now == self._drawn:
            return
        place = colour_bar_box(metrics.rounded(), high)
        if self._drawn is None or now[:2] != self._drawn[:2]:
            ends = place.high / 2
            self.sheet.show_marks(Dots("bar", in_plane(np.linspace(ends, 1 - ends, POINTS), place.middle),
                                       scale.gradient(POINTS), place.high, "square"))
        self._drawn = now
        self.sheet.show_marks(*colour_bar_labels(place, metrics, quantity, scale.ticks(quantity)))


def colour_bar_labels(place: ColourBarBox, metrics: StageMetrics, quantity: str,
                      ticks: list[tuple[float, str]]) -> Iterator[Label]:
    """Yields the labels of a colour bar: its titles, beside it in the gutter or above it, with a quantity's name (by
    its key), and ``ticks``, positions 0 to 1 along the bar with their texts, without those that the last one covers."""
    last = 1 - 1.2 * metrics.text_width(ticks[-1][1]) if ticks else 1.0
    ticks = [(at, text) for at, text in ticks if at == 1 or at + 0.6 * metrics.text_width(text) < last]
    for name, text, (x, y, anchor) in (("title", tr("Error of"), place.title),
                                       ("quantity", str(QUANTITIES[quantity]), place.quantity)):
        yield Label(name, text, x, y, anchor, "gutter" if metrics.gutter else "caption", bold=True)
    for k, (at, text) in enumerate(ticks + [(0.5, "")] * (MOST_TICKS - len(ticks))):
        anchor = "top-left" if at == 0 else "top-right" if at == 1 else "top-center"
        yield Label(f"tick{k}", text, at, place.numbers, anchor, "number")
