"""Where things stand on a stage in the room that there is, as all problems share it, and the bar of colours."""

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum

import numpy as np

from app.frame.colour_scale import MOST_TICKS, ColourScale
from app.frame.primitives import Anchor, Bounds, Dots, Label, Surface, Tone, in_plane
from app.language.translation import tr
from app.words import QUANTITIES

Rectangle = tuple[float, float, float, float]  # x0, x1, y0, y1
HALVES: tuple[Tone, Tone] = ("estimate", "truth")
EDGE = 0.015  # of what is drawn beside x = 0 and 1
#: In pixels: of the bar of colours, from it to its numbers and from these to what is below, and above it.
BAR, TICK, TICK_LINE, ABOVE = 12.0, 5.0, 17.0, 4.0
POINTS = 256  # of the bar of colours


class RunSlot(Enum):
    """Where a run is drawn: alone, or as the first or second of two."""

    ALONE, FIRST, SECOND = range(3)


Spot = tuple[float, float, Anchor]  # where a text is, and how it is anchored


@dataclass(frozen=True)
class Box:
    """Where a plot stands: from x = ``left`` to ``right``, its zero at ``middle`` and the ends of its axis ``half``
    above and below. What is at the axis's ends is written ``below`` it; how many times errors are ``magnified``, and
    a ``remark``, at spots; its name begins at a point ``at``, with a key of what is drawn if there is room for
    ``keys``. None is what has no room."""

    left: float
    right: float
    middle: float
    half: float
    below: float | None
    magnified: Spot | None
    remark: Spot
    at: tuple[float, float] | None = None
    keys: bool = False


@dataclass(frozen=True)
class Places:
    """Where a run's things stand: in a ``rectangle`` of a settled ``room``, with the plot of the field in a box."""

    room: Bounds
    seat: RunSlot
    rectangle: Rectangle
    field: Box


@dataclass(frozen=True)
class ColourBarBox:
    """The bar of colours: ``high`` around ``middle``, numbers below ``numbers``, its title, all else below ``end``."""

    middle: float
    high: float
    numbers: float
    title: Spot
    quantity: Spot
    end: float


def drawing_rectangle(high: float) -> Rectangle:
    """Of all that is drawn on a stage so high."""
    return -EDGE, 1 + EDGE, 0.0, high


def colour_bar_box(room: Bounds, high: float) -> ColourBarBox:
    """The top of a stage so high: the title beside the bar, or above it where there is no gutter."""
    pixel = room.pixel
    first = high - ABOVE * pixel - (0.0 if room.gutter else 1.2 * room.line)
    middle, numbers = first - 0.5 * BAR * pixel, first - (BAR + TICK) * pixel
    row = numbers - 0.5 * room.line
    title: Spot = (-room.gutter, middle, "center-left") if room.gutter else (0.0, high, "top-left")
    quantity: Spot = (-room.gutter, row, "center-left") if room.gutter else (60 * pixel, high, "top-left")
    return ColourBarBox(middle, BAR * pixel, numbers, title, quantity, numbers - TICK_LINE * pixel)


class ColourBar:
    """Draws the scale on a sheet of its own, in square points: they alone show a colour as it is."""

    def __init__(self, sheet: Surface, scale: ColourScale):
        self.sheet, self._scale = sheet, scale
        self._drawn: tuple[Bounds, float, str, float, bool, bool] | None = None

    def draw(self, quantity: str, high: float) -> None:
        """Show the scale as it is now, with the key of the quantity whose error it measures, on a stage so ``high``."""
        scale, room = self._scale, self.sheet.room
        now = (room, high, quantity, scale.top, scale.logarithmic, scale.exceeded)
        if now == self._drawn:
            return
        if self._drawn is None or now[:2] != self._drawn[:2]:
            place = colour_bar_box(room.settled(), high)
            ends = place.high / 2
            self.sheet.show(Dots("bar", in_plane(np.linspace(ends, 1 - ends, POINTS), place.middle),
                                 scale.gradient(POINTS), place.high, "square"))
        self._drawn = now
        place, unit = colour_bar_box(room.settled(), high), QUANTITIES[quantity].unit
        self.sheet.show(*bar_labels(place, room.gutter > 0, quantity, scale.ticks(unit)))


def bar_labels(place: ColourBarBox, gutter: bool, quantity: str, ticks: list[tuple[float, str]]) -> Iterator[Label]:
    """What the bar measures, beside it in a ``gutter`` or above it, and its numbers."""
    for name, text, (x, y, anchor) in (("title", tr("Error of"), place.title),
                                       ("quantity", str(QUANTITIES[quantity]), place.quantity)):
        yield Label(name, text, x, y, anchor, "gutter" if gutter else "caption", bold=True)
    for k, (at, text) in enumerate(ticks + [(0.5, "")] * (MOST_TICKS - len(ticks))):
        anchor = "top-left" if at == 0 else "top-right" if at == 1 else "top-center"
        yield Label(f"tick{k}", text, at, place.numbers, anchor, "number")
