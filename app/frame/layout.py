"""Where things stand on a stage, from the room that there is: what all problems share."""

from dataclasses import dataclass
from enum import Enum

from app.frame.marks import Anchor, Room, Tone

Rectangle = tuple[float, float, float, float]  # x0, x1, y0, y1
HALVES: tuple[Tone, Tone] = ("estimate", "truth")
EDGE = 0.015  # of what is drawn beside x = 0 and 1
#: In pixels: of the bar of colours, from it to its numbers and from these to what is below, and above it.
BAR, TICK, TICK_LINE, ABOVE = 12.0, 5.0, 17.0, 4.0


class Seat(Enum):
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

    room: Room
    seat: Seat
    rectangle: Rectangle
    field: Box


@dataclass(frozen=True)
class Top:
    """Where the bar of colours is, so ``high`` and around its ``middle``, its numbers below ``numbers``, and what it is
    of: its title and the quantity; all else stays below ``end``."""

    middle: float
    high: float
    numbers: float
    title: Spot
    quantity: Spot
    end: float


def rectangle(high: float) -> Rectangle:
    """Of all that is drawn on a stage so high."""
    return -EDGE, 1 + EDGE, 0.0, high


def top(room: Room, high: float) -> Top:
    """The top of a stage so high: the title beside the bar, or above it where there is no gutter."""
    pixel = room.pixel
    first = high - ABOVE * pixel - (0.0 if room.gutter else 1.2 * room.line)
    middle, numbers = first - 0.5 * BAR * pixel, first - (BAR + TICK) * pixel
    row = numbers - 0.5 * room.line
    title: Spot = (-room.gutter, middle, "center-left") if room.gutter else (0.0, high, "top-left")
    quantity: Spot = (-room.gutter, row, "center-left") if room.gutter else (60 * pixel, high, "top-left")
    return Top(middle, BAR * pixel, numbers, title, quantity, numbers - TICK_LINE * pixel)
