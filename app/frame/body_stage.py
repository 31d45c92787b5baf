"""Stage of a body whose exact solution nobody knows: its particles in the colours of their estimated errors."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from app.frame.colour_scale import ColourScale
from app.frame.layout import ColourBarDrawing, Rectangle, colour_bar_box, drawing_rectangle
from app.frame.planar_layout import TITLE
from app.frame.primitives import Dots, Label, Lines, Mark, Spans, StageMetrics, Surface, error_colours, in_plane
from app.frame.stage import StageLabels, title_labels

HIGH = 0.3, 0.9  # least and greatest height of the stage
AROUND = 6.0  # pixels around the body
DIAMETER = 1.42  # of a particle's dot over the particle's width: the dots cover the body, however it turns
MOST_LINES = 400  # of the grid


@dataclass(frozen=True)
class BodyPicture:
    """Everything to draw: positions (P, 2) in m, the ``extent`` (x0, x1, y0, y1) in m in which the body moves, the
    ``width`` of a particle and of a cell (``spacing``) in m; the ``sizes`` (P,) of the errors of a quantity (x, v or
    sigma) in its unit, None if they are not to be believed; the title's ``name`` and ``facts``, and ``notes``."""

    position: np.ndarray
    extent: Rectangle
    width: float
    spacing: float
    quantity: str
    sizes: np.ndarray | None
    name: Spans
    facts: Spans
    notes: tuple[str, str]


class BodyStage:
    """Stage on the surface ``sheet``, and its colour bar on the surface ``bar``, for errors by a ``scale``."""

    def __init__(self, sheet: Surface, bar: Surface, scale: ColourScale):
        self._sheet, self._scale, self._bar = sheet, scale, ColourBarDrawing(bar, scale)

    def set_visible(self, visible: bool) -> None:
        self._sheet.visible = self._bar.sheet.visible = visible

    def draw(self, picture: BodyPicture) -> Rectangle:
        """Draws a picture; returns the rectangle that it fills."""
        metrics = self._sheet.stage_metrics.rounded()
        high = stage_height(metrics)
        self._bar.draw(picture.quantity, high)
        self._sheet.show_marks(*_marks(picture, metrics, high, self._scale))
        self.set_visible(True)
        return drawing_rectangle(high)


def _marks(picture: BodyPicture, metrics: StageMetrics, high: float, scale: ColourScale) -> Iterator[Mark]:
    per_metre, corner = body_placement(picture.extent, metrics, high)

    def place(x: np.ndarray, depth: float) -> np.ndarray:
        """Returns points (n, 3) of the stage for positions (n, 2) in m."""
        return in_plane(corner[0] + per_metre * x[:, 0], corner[1] + per_metre * x[:, 1], depth)

    yield Lines("cells", place(_grid_lines(picture), -0.02).reshape(-1, 2, 3), metrics.palette.grid, 1.0)
    with np.errstate(all="ignore"):
        colours = error_colours(scale, picture.sizes, len(picture.position), metrics.palette.unknown)
    yield Dots("particles", place(picture.position, 0.0), colours, DIAMETER * per_metre * picture.width)
    yield from body_labels(picture.name, picture.facts, picture.notes, metrics, high)


def stage_height(metrics: StageMetrics) -> float:
    """Returns the height of the stage in its own unit."""
    return min(max(metrics.high, HIGH[0]), HIGH[1])


def body_placement(extent: Rectangle, metrics: StageMetrics, high: float) -> tuple[float, tuple[float, float]]:
    """Returns the scale in stage units per m and the place of the origin, so that the ``extent`` (x0, x1, y0, y1) in m
    fills the stage below its titles."""
    pixel, end = metrics.pixel, _title_line(metrics, high)
    top = end if metrics.gutter else end - 1.3 * metrics.line_height
    x0, x1, y0, y1 = extent
    per_metre = min((1 - 2 * AROUND * pixel) / (x1 - x0), (top - 2 * AROUND * pixel) / (y1 - y0))
    return per_metre, (0.5 - 0.5 * per_metre * (x1 + x0), 0.5 * top - 0.5 * per_metre * (y1 + y0))


def body_labels(name: Spans, facts: Spans, notes: tuple[str, str], metrics: StageMetrics,
                high: float) -> Iterator[Label]:
    """Yields the labels of a body's title and of what is shown; arguments as of :class:`BodyPicture`."""
    end = _title_line(metrics, high)
    yield from title_labels(StageLabels(name=name, facts=facts), metrics, end + 0.5 * TITLE * metrics.pixel)
    yield from _notes(notes, metrics, end)


def _title_line(metrics: StageMetrics, high: float) -> float:
    """Returns the height of the lower edge of the title."""
    return colour_bar_box(metrics, high).end - TITLE * metrics.pixel


def _grid_lines(picture: BodyPicture) -> np.ndarray:
    """Returns the ends (2 n, 2) in m of the lines between cells, none where they would cover everything."""
    x0, x1, y0, y1 = picture.extent
    h, ends = picture.spacing, list[tuple[float, float]]()
    if (x1 - x0 + y1 - y0) / h < MOST_LINES:
        for x in h * np.arange(np.ceil(x0 / h), np.floor(x1 / h) + 1):
            ends += [(x, y0), (x, y1)]
        for y in h * np.arange(np.ceil(y0 / h), np.floor(y1 / h) + 1):
            ends += [(x0, y), (x1, y)]
    return np.array(ends, float).reshape(-1, 2)


def _notes(notes: tuple[str, str], metrics: StageMetrics, end: float) -> Iterator[Label]:
    """Yields the names of what is shown and of what is not, in the gutter or above the body, where there is room for
    what is before their colons."""
    first, second = notes
    if not metrics.gutter:
        first, second = (text.partition(":")[0] for text in notes)
        yield Label("estimate-title", first, 0.0, end - 2 * metrics.pixel, "top-left", "title", tone="estimate",
                    bold=True)
        yield Label("truth-title", second, 1.0, end - 2 * metrics.pixel, "top-right", "title", tone="truth")
        return
    width = metrics.letters_per_line(metrics.gutter) - 1
    for name, text, y, anchor, tone in (("estimate-title", first, 0.62, "bottom-left", "estimate"),
                                        ("truth-title", second, 0.56, "top-left", "truth")):
        yield Label(name, text, -metrics.gutter, y * end, anchor, "gutter", width=width, tone=tone,  # type: ignore
                    bold=name == "estimate-title")
