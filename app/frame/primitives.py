"""Marks: the primitives drawn on a stage, as data. Renderers draw them: the viewer, the offline player, pictures.

The stage is a plane with x from 0 to 1 along the colour bar and y from 0 to its height (:class:`StageMetrics`). Marks
with a higher z are on top."""

import textwrap
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any, Literal, Protocol

import numpy as np

from app.colour_palette import PALETTE, rgb
from app.frame.colour_scale import ColourScale, any_finite

Colour = tuple[int, int, int]


@dataclass(frozen=True)
class Palette:
    """Colours of a light or dark stage: background; plotted particles and lines beside labels; axes; grid lines; cell
    edges; crossings; particles without a known error; exact curve; outlines of domains; deviations from the exact
    curve; the curve before a change; estimated errors."""

    ground: Colour
    dot: Colour
    axis: Colour
    grid: Colour
    cell: Colour
    crossing: Colour
    unknown: Colour
    exact: Colour
    outline: Colour
    stem: Colour
    before: Colour
    estimate: Colour


#: Names of a palette's colours.
_NAMES = ("ground", "dot", "line2", "line", "cell", "cross", "cell", "truth", "ground", "stem", "before", "estimate")
LIGHT, DARK = (Palette(*(rgb(getattr(PALETTE[name], ground)) for name in _NAMES)) for ground in ("light", "dark"))

AWAY = -50.0  # coordinate of points that cannot be shown, far outside the view
LETTER_WIDTH = 6.0  # pixels of an average letter of usual size
LINE_HEIGHT = 16.0  # pixels of a line of such letters, with its margins

Anchor = Literal["top-left", "top-center", "top-right", "center-left", "center-center", "center-right", "bottom-left",
                 "bottom-center", "bottom-right"]
#: Role of a label: a name in the gutter, left of the rectangle, a half's title or why it is empty, the name of the
#: run, the legend of marks, an axis's number or name, text at a step in slow motion, text at a point of the body,
#: which every renderer writes, or text upon particles, with a ground of its own.
Role = Literal["gutter", "title", "silence", "name", "note", "number", "caption", "step", "place",
               "chip"]
Span = tuple[str, str]  # a kind, which sets the style of a text, and the text
Spans = tuple[Span, ...]
SEPARATOR: Span = ("", " · ")
#: What a label belongs to, which sets its colour.
Tone = Literal["plain", "faint", "estimate", "truth", "crossing", "before"]
Sign = Literal["", "dot", "line", "ring"]  # legend key before the text, in the label's tone


@dataclass(frozen=True)
class Label:
    """Text whose ``anchor`` is at (x, y) of the stage, wrapped at ``width`` letters (0: not), ``size`` times as large
    as usual letters, with a ``sign`` before it. ``name`` identifies the label on its surface. The text may be given in
    ``spans`` of several styles (:meth:`of_spans`)."""

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
    spans: Spans = ()

    @classmethod
    def of_spans(cls, name: str, spans: Spans, x: float, y: float, anchor: Anchor, role: Role, **style: Any) -> "Label":
        """Returns a label whose text consists of ``spans``; renderers that know one style show the plain text."""
        return cls(name, "".join(text for _, text in spans), x, y, anchor, role, **style, spans=spans)


@dataclass(eq=False, slots=True)
class Dots:
    """Points (n, 3) relative to an ``origin``, of diameter ``size``, all in stage coordinates, with colours (n, 3), or
    (3,) for all, from 0 to 255. Only dots show colours unchanged. The arrays must not be modified afterwards."""

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
    """Segments (n, 2, 3) in stage coordinates, in a colour or one per end (n, 2, 3), uint8 RGB; thickness in pixels."""

    name: str
    segments: np.ndarray
    colours: Colour | np.ndarray
    thickness: float

    def __len__(self) -> int:
        return len(self.segments)


Mark = Label | Dots | Lines


@dataclass(frozen=True)
class StageMetrics:
    """Size of a stage and its letters: ``pixels`` from x = 0 to 1, the factor ``lettering`` on the usual size of
    letters, the height ``high`` (y goes from 0 to it), the width ``gutter`` left of x = 0 for names (if 0, names are
    above what they name), and whether the background is ``dark``. Lengths are in units of the stage's width."""

    pixels: float
    lettering: float = 1.0
    high: float = 0.5
    gutter: float = 0.0
    dark: bool = False

    @property
    def palette(self) -> Palette:
        """Colours for the dark or light background."""
        return DARK if self.dark else LIGHT

    @property
    def pixel(self) -> float:
        """Stage length of a pixel, on a screen on which letters have their usual size."""
        return self.lettering / self.pixels

    @property
    def line_height(self) -> float:
        """Stage height of a line of text of usual size."""
        return LINE_HEIGHT * self.pixel

    def rounded(self) -> "StageMetrics":
        """Returns the metrics rounded to just visible steps, so that tiny changes cause no new layout."""
        return replace(self, pixels=max(8.0, 8 * round(self.pixels / 8)), high=round(self.high, 2),
                       gutter=round(self.gutter, 2))

    def letters_per_line(self, length: float, size: float = 1.0) -> int:
        """Returns how many letters, ``size`` times as large as usual, fit into a length of the stage; at least 1."""
        return max(1, int(length * self.pixels / (LETTER_WIDTH * size * self.lettering)))

    def first_fitting_text(self, texts: Iterable[str], width: float, height: float) -> tuple[str, int]:
        """Returns the first text that fits, wrapped, into a stage width and height, or "", and the letters per line."""
        letters = self.letters_per_line(width)
        for text in texts:
            lines = wrap_text(text, letters).split("\n")
            if max(map(len, text.split()), default=0) <= letters and len(lines) * self.line_height <= height:
                return text, letters
        return "", letters

    def text_width(self, text: str, size: float = 1.0) -> float:
        """Returns the approximate stage width of a text, ``size`` times as large as usual."""
        return size * self.lettering / self.pixels * LETTER_WIDTH * max(map(len, text.split("\n")))

    def text_extent(self, text: str) -> np.ndarray:
        """Returns the approximate stage width and height (2,) of a text of usual size."""
        return np.array([self.text_width(text), self.line_height * len(text.split("\n"))])


class Surface(Protocol):
    """Interface of what marks are drawn on. A mark replaces one of the same name; an empty one is hidden."""

    visible: bool

    @property
    def stage_metrics(self) -> StageMetrics: ...

    def show_marks(self, *marks: Mark) -> None: ...

    def add_child(self, name: str) -> "Surface":
        """Returns a new surface with this name, which is visible only while its parent is."""


def error_colours(scale: ColourScale, sizes: np.ndarray | None, count: int, unknown: Colour) -> np.ndarray:
    """Returns colours (P, 3), uint8 RGB, of P = ``count`` particles on a scale for the sizes (P,) of their errors; the
    colour ``unknown`` for all particles if sizes are None or none is finite."""
    if sizes is None or not any_finite(sizes):
        return np.full((count, 3), unknown, np.uint8)
    return scale.colours(sizes)


def in_plane(x: np.ndarray, y: np.ndarray | float, z: float = 0.0) -> np.ndarray:
    """Returns points (n, 3), float32, from coordinates x (n,), y (n,) or one for all, and one z for all."""
    points = np.empty((len(x), 3), np.float32)
    points[:, 0], points[:, 1], points[:, 2] = x, y, z
    return points


def join_points(starts: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """Returns line segments (n, 2, 3) from points ``starts`` to ``ends``, both (n, 3)."""
    return np.stack([starts, ends], axis=1)


@lru_cache(1000)
def wrap_text(text: str, width: int) -> str:
    """Returns a text with line breaks, at most ``width`` characters a line; unchanged if that is 0."""
    return "\n".join(textwrap.wrap(text, width)) if width else text
