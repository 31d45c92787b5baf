"""Marks: what is drawn on a stage, as data. A renderer draws them: the viewer, the offline player, a picture.

The stage is a plane in which x goes from 0 to 1 along the colour bar and y from 0 up, as high as there is room
(:class:`Bounds`). What has a higher z lies on top.
"""

import textwrap
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Literal, Protocol

import numpy as np

from app.colours import PALETTE, rgb
from app.frame.colour_scale import ColourScale, any_finite

Colour = tuple[int, int, int]


@dataclass(frozen=True)
class Palette:
    """The ground; particles in a plot and lines beside words; axes; lines of cells through a plot and behind a body;
    edges of cells; crossings; a particle whose error nobody knows; what is exact; outlines of domains on the map's
    colours."""

    ground: Colour
    dot: Colour
    axis: Colour
    grid: Colour
    cell: Colour
    crossing: Colour
    unknown: Colour
    exact: Colour
    outline: Colour


def _palette(ground: str) -> Palette:
    def of(name: str) -> Colour:
        return rgb(getattr(PALETTE[name], ground))

    return Palette(of("ground"), of("dot"), of("line2"), of("line"), of("cell"), of("cross"), of("cell"), of("truth"),
                   of("ground"))


LIGHT, DARK = _palette("light"), _palette("dark")


AWAY = -50.0  # where points that cannot be shown are, far outside the view
LETTER_WIDTH = 6.0  # pixels, of an average letter of usual size
LINE_HEIGHT = 16.0  # of a line of such letters, with what is around it

Anchor = Literal["top-left", "top-center", "top-right", "center-left", "center-center", "center-right", "bottom-left",
                 "bottom-center", "bottom-right"]
#: What a label is: a name left of what it names, outside of the rectangle, a half's title or why it is empty, which run
#: this is, what the marks mean, an axis's number or name, words at a step in slow motion, or words at a place of the
#: body, which every renderer writes.
Role = Literal["gutter", "title", "silence", "name", "note", "number", "caption", "step", "place"]
#: What a label belongs to, and so its colour.
Tone = Literal["plain", "faint", "estimate", "truth", "crossing"]
Sign = Literal["", "dot", "line"]  # a key in the label's tone before its words: what they explain looks like that


@dataclass(frozen=True)
class Label:
    """A text at (x, y) by its ``anchor``, ``width`` letters a line, ``size`` times as large, or with a ``sign``."""

    name: str
    text: str
    x: float
    y: float
    anchor: Anchor
    role: Role
    size: float = 1.0
    width: int = 0
    tone: Tone = "plain"
    bold: bool = False
    sign: Sign = ""


@dataclass(eq=False, slots=True)
class Dots:
    """Points (n, 3), ``size`` across and counted from an ``origin``, with colours (n, 3) or one for all (3,), 0 to 255.

    They alone show a colour exactly as it is given. Who has made them writes to the arrays no more.
    """

    name: str
    points: np.ndarray
    colours: np.ndarray
    size: float
    shape: Literal["circle", "square"] = "circle"
    origin: tuple[float, float] = (0.0, 0.0)

    def __len__(self) -> int:
        return len(self.points)


@dataclass(eq=False, slots=True)
class Lines:
    """Segments (n, 2, 3) in one colour or one for each end (n, 2, 3), of a thickness in pixels."""

    name: str
    segments: np.ndarray
    colours: Colour | np.ndarray
    thickness: float

    def __len__(self) -> int:
        return len(self.segments)


Mark = Label | Dots | Lines


@dataclass(frozen=True)
class Bounds:
    """The box that a stage is drawn in.

    Attributes
    ----------
    pixels
        For a length of one: from x = 0 to 1 of the stage.
    lettering
        Letters are so many times as large as usual.
    high
        The box's height, in lengths of one: y goes from 0 to it.
    gutter
        Room for names left of x = 0, in lengths of one; with none they stand above what they name.
    dark
        Whether the ground is dark.
    """

    pixels: float
    lettering: float = 1.0
    high: float = 0.5
    gutter: float = 0.0
    dark: bool = False

    @property
    def palette(self) -> Palette:
        """The colours that go with the ground."""
        return DARK if self.dark else LIGHT

    @property
    def pixel(self) -> float:
        """A pixel's length on the stage, of a screen on which letters have their usual size."""
        return self.lettering / self.pixels

    @property
    def line(self) -> float:
        """The height that a line of words takes on the stage."""
        return LINE_HEIGHT * self.pixel

    def settled(self) -> "Bounds":
        """The room in steps that can just be seen: a stage laid out for it is not laid out anew for a hair."""
        return replace(self, pixels=max(8.0, 8 * round(self.pixels / 8)), high=round(self.high, 2),
                       gutter=round(self.gutter, 2))

    def letters(self, length: float, size: float = 1.0) -> int:
        """How many letters of a size there is room for in a length of the stage."""
        return max(1, int(length * self.pixels / (LETTER_WIDTH * size * self.lettering)))

    def fitting(self, texts: Iterable[str], width: float, height: float) -> tuple[str, int]:
        """Returns the first text that fits into a box, and how many letters its lines have; "" where none does."""
        letters = self.letters(width)
        for text in texts:
            lines = wrap_text(text, letters).split("\n")
            if max(map(len, text.split()), default=0) <= letters and len(lines) * self.line <= height:
                return text, letters
        return "", letters

    def extent(self, text: str, size: float = 1.0) -> np.ndarray:
        """Width and height (2,) that a text of this size takes on the stage, about."""
        scale, lines = size * self.lettering / self.pixels, text.split("\n")
        return scale * np.array([LETTER_WIDTH * max(map(len, lines)), LINE_HEIGHT * len(lines)])


class Surface(Protocol):
    """What marks are drawn on. One shown under the name of another takes its place; an empty one is not seen."""

    visible: bool

    @property
    def room(self) -> Bounds: ...

    def show(self, *marks: Mark) -> None: ...

    def child(self, name: str) -> "Surface":
        """A sheet that is seen with this one."""


def error_colours(scale: ColourScale, sizes: np.ndarray | None, count: int, unknown: Colour) -> np.ndarray:
    """Colours (P, 3) of error sizes; plain grey where nothing is known."""
    if sizes is None or not any_finite(sizes):
        return np.full((count, 3), unknown, np.uint8)
    return scale.colours(sizes)


def fade_colours(ages: np.ndarray, palette: Palette) -> np.ndarray:
    """Colours (n, 3) that fade from a crossing's to the ground's, for ages (n,) from 0 to 1."""
    ground, crossing = np.array(palette.ground, np.float32), np.array(palette.crossing, np.float32)
    return (crossing + (0.85 * ages)[:, None] * (ground - crossing)).astype(np.uint8)


def in_plane(x: np.ndarray, y: np.ndarray | float, z: float = 0.0) -> np.ndarray:
    """Points (n, 3) from coordinates (n,) or one for all; written in place, for it is done with every frame."""
    points = np.empty((len(x), 3), np.float32)
    points[:, 0], points[:, 1], points[:, 2] = x, y, z
    return points


def join_points(starts: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """Line segments (n, 2, 3) between points (n, 3)."""
    return np.stack([starts, ends], axis=1)


@lru_cache(1000)
def wrap_text(text: str, width: int) -> str:
    """The text in lines of at most so many characters; as it is for 0."""
    return "\n".join(textwrap.wrap(text, width)) if width else text
