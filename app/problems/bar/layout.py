"""Layout of the bar's runs, one below the other: a title, the field plot, and two lanes of particles."""

from dataclasses import dataclass

from app.frame.field_plot import ROOM
from app.frame.layout import ComparedRunSlot, FieldPlotLayout, PlotBox, Spot, colour_bar_box, drawing_rectangle
from app.frame.primitives import StageMetrics

#: In pixels: height of a title, gap below the plot, between the lanes and between two runs, and least height of a lane.
TITLE, GAP, BETWEEN, APART, LEAST_LANE = 22.0, 5.0, 2.0, 10.0, 13.0
LANE = 0.152  # height of a lane as a share of its run's


@dataclass(frozen=True)
class BarLayout(FieldPlotLayout):
    """Layout of a run of the bar: the heights on the stage of the middles of the lanes of ``estimate`` and ``truth``,
    of its title, the ``heading``, and of the ``legend`` (None if there is none); a ``lane`` is so high. There is a lane
    of the estimate if the run is ``judged``."""

    estimate: float
    truth: float
    lane: float
    heading: float
    legend: float | None
    judged: bool

    @property
    def lanes(self) -> tuple[float, ...]:
        """Heights on the stage of the middles of the lanes that there are, the truth's last."""
        return (self.estimate, self.truth)[not self.judged:]


def make_bar_layout(metrics: StageMetrics, slot: ComparedRunSlot, judged: bool = True) -> BarLayout:
    """Returns the layout of a run of the bar in a slot of a stage with these (rounded) metrics: of two runs each has
    half the height. The legend and the axis's ends are below the last one, where there is a gutter. A run that no
    estimator has ``judged`` has no lane of the estimate."""
    pixel, end, second = metrics.pixel, colour_bar_box(metrics, metrics.high).end, slot == ComparedRunSlot.SECOND
    alone, last = slot == ComparedRunSlot.ALONE, slot != ComparedRunSlot.FIRST
    below = 1.3 * metrics.line_height if metrics.gutter else 0.0
    each = end - below if alone else 0.5 * (end - below - APART * pixel)
    start = end - (each + APART * pixel) * second
    lowest, high = start - each, start - TITLE * pixel
    lane = max(LANE * each, LEAST_LANE * pixel)
    truth, estimate = lowest + 0.5 * lane, lowest + 1.5 * lane + BETWEEN * pixel
    low = (estimate if judged else truth) + 0.5 * lane + GAP * pixel
    half, middle = 0.5 * (high - low) / ROOM, 0.5 * (high + low)
    ends = lowest - 4 * pixel if last and metrics.gutter else None
    magnified: Spot = (1.0, low, "bottom-right")
    remark: Spot = (1.0, high, "top-right")
    name = (-metrics.gutter, middle) if metrics.gutter else None
    box = PlotBox(0.0, 1.0, middle, half, ends, magnified, remark, name)
    return BarLayout(metrics, slot, drawing_rectangle(metrics.high), box, estimate, truth, lane,
                     start - 0.5 * TITLE * pixel, ends, judged)
