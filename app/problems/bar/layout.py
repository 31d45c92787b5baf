"""Layout of the bar: two lanes with the field plot below; beside a pinned run the plot is above them."""

from dataclasses import dataclass

from app.frame.field_plot import ROOM
from app.frame.layout import ComparedRunSlot, FieldPlotLayout, PlotBox, Spot, colour_bar_box, drawing_rectangle
from app.frame.primitives import StageMetrics

#: In pixels: space above the upper and below the lower lane; least lane and gap, height of a strip, distance between
#: two runs; half the height of a plot with space for keys; and the height of the number at the end of its axis.
BRACKET, LEAST_LANE, LEAST_GAP, STRIP, APART, KEYS, END = 26.0, 26.0, 20.0, 14.0, 10.0, 44.0, 36.0
LANE, MOST_LANE, GAP = 0.155, 96.0, 0.62  # of the height below the numbers; in pixels; of a lane


@dataclass(frozen=True)
class BarLayout(FieldPlotLayout):
    """Layout of the bar: the heights on the stage of the middles of the lanes of ``estimate`` and ``truth``, of
    ``crossings`` (None if they are not drawn) and of a ``heading``; a ``lane`` is so high."""

    estimate: float
    truth: float
    lane: float
    crossings: float | None
    heading: float


def make_bar_layout(metrics: StageMetrics, slot: ComparedRunSlot) -> BarLayout:
    """Returns the layout of the bar in a slot of a stage with these (rounded) metrics."""
    return _single_run_layout(metrics) if slot == ComparedRunSlot.ALONE else _paired_run_layout(metrics, slot)


def _single_run_layout(metrics: StageMetrics) -> BarLayout:
    pixel, end = metrics.pixel, colour_bar_box(metrics, metrics.high).end
    lane = min(max(LANE * end, LEAST_LANE * pixel), MOST_LANE * pixel)
    gap = max(GAP * lane, LEAST_GAP * pixel)
    estimate = end - BRACKET * pixel - 0.5 * lane
    truth = estimate - lane - gap
    low = 1.3 * metrics.line_height  # for the numbers below the plot
    high = truth - 0.5 * lane - BRACKET * pixel - 0.4 * metrics.line_height
    half = 0.5 * (high - low) / ROOM
    middle = 0.5 * (high + low)
    keys = half > KEYS * pixel  # below its name; beside the axis's numbers, wherever it is
    at = (-metrics.gutter, middle + 1.55 * metrics.line_height * keys) if metrics.gutter else None
    below = low - 2 * pixel
    remark: Spot = (0.78, below, "top-center") if metrics.gutter else (1 - END * pixel, below, "top-right")
    box = PlotBox(0.0, 1.0, middle, half, below, (0.5, below, "top-center"), remark, at, keys)
    return BarLayout(metrics, ComparedRunSlot.ALONE, drawing_rectangle(metrics.high), box, estimate, truth, lane,
                     0.5 * (estimate + truth), end - metrics.line_height)


def _paired_run_layout(metrics: StageMetrics, slot: ComparedRunSlot) -> BarLayout:
    """Returns the layout of one of two bars, half as high: a heading, the field plot, and two adjacent strips."""
    pixel, end, second = metrics.pixel, colour_bar_box(metrics, metrics.high).end, slot == ComparedRunSlot.SECOND
    low = 1.2 * metrics.line_height  # for the numbers below both
    each = 0.5 * (end - low - APART * pixel)
    start = end - (each + APART * pixel) * second
    heading = start - 1.2 * metrics.line_height
    strip = max(STRIP * pixel, 0.1 * each)
    lowest = start - each
    truth, estimate = lowest + 0.5 * strip, lowest + 1.5 * strip
    half = 0.5 * (heading - estimate - 0.5 * strip - 6 * pixel) / ROOM
    middle = heading - ROOM * half - 2 * pixel
    at = -metrics.gutter, middle + 0.5 * half
    below = low - 6 * pixel if second else None
    box = PlotBox(0.0, 1.0, middle, half, below, (0.5, below, "top-center") if below else None,
                  (1.0, middle + ROOM * half, "top-right"), at if metrics.gutter else None)
    return BarLayout(metrics, slot, drawing_rectangle(metrics.high), box, estimate, truth, strip, None, heading)
