"""The error plot of a plane problem: true and estimated errors of particles across the body, on the colours' scale."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from app.frame.colour_scale import MOST_TICKS, ZERO, ColourScale
from app.frame.layout import HALVES
from app.frame.primitives import AWAY, Anchor, Dots, Label, Lines, Mark, Sign, StageMetrics, in_plane, join_points
from app.language.translation import lazy, localise_number, tr

MOST_DRAWN = 1000  # particles with points: more would be a grey area
#: Diameters in pixels: of the point of a true error, and outer and inner one of the ring of an estimate.
TRUE_DOT, RING, HOLE = 4.5, 8.5, 5.5
#: In pixels: width of the colour bar left of the axis, its distance from it, and the number's distance from the bar.
BAR, BESIDE, NUMBER = 6.0, 6.0, 12.0
HEADING = 22.0  # height in pixels of the line above the plot
BAR_POINTS = 128
BOLD = 1.05  # width of bold letters over that of usual ones
SIGNS: tuple[Sign, Sign] = ("ring", "dot")  # of estimate and truth
NAME = lazy("Error")  # where there is no room for the plot's own


@dataclass(frozen=True)
class ErrorPlotDefinition:
    """Settings of an error plot: its horizontal axis from ``start`` to ``end`` in m at rest, with texts at its
    ``ends``, and its ``name`` (translated where it is used)."""

    start: float
    end: float
    ends: tuple[str, str]
    name: str


@dataclass(frozen=True)
class ErrorPlotBox:
    """Box of an error plot in stage coordinates: from x = ``left`` to ``right`` and from y = ``low``, no error, to
    ``high``, the top of the colour scale; whether it is ``named`` by a line above and has its ``ends`` below."""

    left: float
    right: float
    low: float
    high: float
    named: bool = True
    ends: bool = True


class ErrorPlot:
    """Error plot of one run, whose value axis is a colour ``scale``: true errors as dots, estimated ones as rings."""

    shared_axis_changed = is_outdated = False  # two runs share the colour scale, which changes before both are drawn

    def __init__(self, plotted: ErrorPlotDefinition, scale: ColourScale):
        self._plotted, self._scale = plotted, scale
        self._labelled: tuple | None = None
        self._box: ErrorPlotBox | None = None
        self._at, self._sizes, self._chosen = np.empty(0), np.empty(0), np.empty(0, int)

    def draw(self, box: ErrorPlotBox | None, metrics: StageMetrics, quantity: str, at: np.ndarray,
             estimated: np.ndarray | None, true: np.ndarray | None) -> Iterator[Mark]:
        """Yields the marks of a frame in a ``box``, or hidden ones for None. ``at`` (P,) are the particles' positions
        along the axis in m at rest, NaN for those not plotted; ``estimated`` and ``true`` are the sizes (P,) of the
        errors of a quantity (key x, v, sigma or a) on the scale, or None."""
        if at is not self._at:  # constant during a run
            self._at, self._chosen = at, plotted_particles(at)
        sizes = true if true is not None else estimated
        self._box, self._sizes = box, np.empty(0) if sizes is None else sizes
        scale, pixel, colours = self._scale, metrics.pixel, metrics.palette
        now = box, metrics, quantity, scale.appearance
        if now != self._labelled:
            self._labelled = now
            yield from self._axis_marks(metrics, quantity)
        for name, sizes, colour, size, depth in (
                ("rings", estimated, colours.estimate, RING, 0.010), ("holes", estimated, colours.ground, HOLE, 0.012),
                ("true", true, colours.exact, TRUE_DOT, 0.014)):
            points = self._stage_points(self._chosen, sizes, depth)
            yield Dots(f"plot/{name}", points, np.array(colour, np.uint8), size * pixel)

    def dot_positions(self, particles: slice, count: int) -> np.ndarray:
        """Returns the points (count, 3) of the stage where the dots of ``count`` particles (a slice of all) are drawn;
        points out of view if they are not."""
        points = self._stage_points(np.arange(len(self._at))[particles], self._sizes, 0.014)
        return points if len(points) == count else np.full((count, 3), AWAY, np.float32)

    def _stage_points(self, which: np.ndarray, sizes: np.ndarray | None, depth: float) -> np.ndarray:
        """Returns points (n, 3) of the stage for the errors of the particles ``which`` (n,), at most at the top of the
        axis; without a number they are at the height ``AWAY``. No points if there is no box, or no sizes (P,)."""
        box, plotted = self._box, self._plotted
        if box is None or sizes is None or len(sizes) != len(self._at):
            return np.empty((0, 3), np.float32)
        along = (self._at[which] - plotted.start) / (plotted.end - plotted.start)
        height = box.low + (box.high - box.low) * np.clip(self._scale.shares(sizes[which]), 0.0, 1.0)
        return in_plane(box.left + (box.right - box.left) * np.nan_to_num(along, nan=AWAY),
                        np.nan_to_num(height, nan=AWAY), depth)

    def _axis_marks(self, metrics: StageMetrics, quantity: str) -> Iterator[Mark]:
        """Yields the lines of the value axis, its numbers, and the colour bar beside it."""
        box, pixel, colours = self._box, metrics.pixel, metrics.palette
        ticks = self._scale.ticks(quantity, says_of_what=False)
        if box is None:
            yield Lines("plot/levels", np.empty((0, 2, 3), np.float32), colours.grid, 1.0)
            yield Dots("plot/bar", np.empty((0, 3), np.float32), self._scale.gradient(0), 1.0)
        else:
            heights = box.low + (box.high - box.low) * np.array([at for at, _ in ticks])
            ends = (in_plane(np.full(len(heights), x), heights, -0.005) for x in (box.left, box.right))
            yield Lines("plot/levels", join_points(*ends), colours.grid, 1.0)
            half = 0.5 * BAR * pixel
            at = in_plane(np.zeros(BAR_POINTS), np.linspace(box.low + half, box.high - half, BAR_POINTS))
            at[:, 0] = box.left - BESIDE * pixel
            yield Dots("plot/bar", at, self._scale.gradient(BAR_POINTS), BAR * pixel, "square")
        yield from _number_labels(box, pixel, ticks)


def plotted_particles(at: np.ndarray) -> np.ndarray:
    """Returns the indices, ascending, of the particles that a plot draws, for their positions ``at`` (P,) along its
    axis, NaN for those not plotted: all, or 1,000 of them at random (regular ones would form patterns)."""
    known = np.flatnonzero(np.isfinite(at))
    if len(known) > MOST_DRAWN:
        known = np.sort(np.random.default_rng(0).choice(known, MOST_DRAWN, replace=False))
    return known


def error_plot_labels(box: ErrorPlotBox | None, metrics: StageMetrics, plotted: ErrorPlotDefinition,
                      titles: tuple[str, str]) -> Iterator[Label]:
    """Yields the labels of an error plot but for the numbers, always the same ones, empty without a ``box``: its name,
    the ``titles`` of estimate and truth as keys, and the ends of its horizontal axis."""
    pixel, place = metrics.pixel, box or ErrorPlotBox(0.5, 0.5, 0.1, 0.1, False, False)
    left, right, above = place.left - (BESIDE + 0.5 * BAR) * pixel, place.right, place.high + 0.5 * HEADING * pixel
    for text, tone, sign in zip(titles, HALVES, SIGNS, strict=True):
        yield Label(f"plot/{tone}", text if place.named else "", right, above, "center-right", "note", tone=tone,
                    sign=sign)
        right -= metrics.text_width(f"{text}  ") + metrics.line_height
    name, _ = metrics.first_fitting_text((tr(plotted.name), tr(NAME)), (right - left) / BOLD, metrics.line_height)
    yield Label("plot/name", name if place.named else "", left, above, "center-left", "title", bold=True)
    ends: tuple[tuple[str, float, Anchor], ...] = ("start", place.left, "top-left"), ("end", place.right, "top-right")
    for text, (key, x, anchor) in zip(map(localise_number, plotted.ends), ends, strict=True):
        yield Label(f"plot/{key}", text if place.ends else "", x, place.low - 4 * pixel, anchor, "number")


def _number_labels(box: ErrorPlotBox | None, pixel: float, ticks: list[tuple[float, str]]) -> Iterator[Label]:
    """Yields the numbers left of an error plot, empty without a ``box``: ``ticks`` of its scale, 0 to 1 with texts."""
    left, low, high = (box.left - NUMBER * pixel, box.low, box.high) if box else (0.0, 0.0, 0.0)
    for k, (at, text) in enumerate(ticks + [(0.0, "")] * (MOST_TICKS - len(ticks))):
        number = "0" if text == tr(ZERO) else text
        yield Label(f"plot/tick{k}", number if box else "", left, low + (high - low) * at, "center-right", "number")
