"""The field plot of the bar over the whole stage, without lanes and colour bar."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from app.frame.field_plot import ROOM, FieldPlot
from app.frame.layout import ComparedRunSlot, FieldPlotLayout, PlotBox, Rectangle, drawing_rectangle
from app.frame.primitives import Label, Lines, Mark, StageMetrics, Surface, in_plane, join_points
from app.language.translation import tr
from app.names_and_units import format_number, functions_name, main_settings_text
from app.problems.bar.stage import BarStage, legend_labels
from solvers.engine.engine_messages import FrameReport
from solvers.engine.shared_frames import FrameArrays
from solvers.problems.bar.scene import BarScene

LOWEST, HIGHEST = 0.3, 1.3  # least and greatest height of the picture
TITLE = 1.08  # size of its letters


class FieldOverStage:
    """Picture of a frame's field of the bar, on the surface ``sheet``, with every particle marked that has changed its
    cell since the start."""

    def __init__(self, sheet: Surface):
        self.sheet, self._plot = sheet, FieldPlot(BarStage.PLOT)
        self._layout: FieldPlotLayout | None = None

    def draw(self, scene: BarScene, report: FrameReport, arrays: FrameArrays) -> Rectangle:
        """Draws a frame of a scene that has the values of a field; returns the rectangle of the picture."""
        metrics = self.sheet.stage_metrics.rounded()
        metrics = replace(metrics, high=min(max(metrics.high, LOWEST), HIGHEST))
        if self._layout is None or self._layout.stage_metrics != metrics:
            self._layout = _layout(metrics)
            self.sheet.show_marks(*_still_marks(self._layout, scene))
        assert report.holds.plotted
        self.sheet.show_marks(
            *self._plot.draw(self._layout, scene, report.holds.plotted, 1, arrays.position[:, 0], arrays.plotted,
                             report.time, arrays.steps_since_crossing >= 0),
            Label("time", f"t = {format_number(report.time)} s", 1.0, metrics.high, "top-right", "title", TITLE))
        return self._layout.rectangle


def _layout(metrics: StageMetrics) -> FieldPlotLayout:
    """Returns the layout of a plot as high as the stage, with a line of words above and below it."""
    line = metrics.line_height
    half, middle = 0.5 * (metrics.high - 3 * line) / ROOM, 0.5 * metrics.high
    below = middle - ROOM * half - 0.2 * line
    box = PlotBox(0.0, 1.0, middle, half, below, None, (0.5, metrics.high, "top-center"),
                  (-metrics.gutter, middle) if metrics.gutter else None)
    return FieldPlotLayout(metrics, ComparedRunSlot.ALONE, drawing_rectangle(metrics.high), box)


def _still_marks(places: FieldPlotLayout, scene: BarScene) -> Iterator[Mark]:
    """Yields the edges of the cells, the run's name above the plot, and the legend below it."""
    box, metrics = places.field, places.stage_metrics
    edges = np.arange(scene.cells + 1) * scene.spacing
    low, high = (in_plane(edges, box.middle + side * ROOM * box.half, -0.02) for side in (-1, 1))
    yield Lines("cells", join_points(low, high), metrics.palette.grid, 1.0)
    name = functions_name(scene.method)
    yield Label("run", name, 0.0, metrics.high, "top-left", "title", TITLE, bold=True)
    beside = 1.1 * metrics.text_width(name, TITLE) + 10 * metrics.pixel
    room = 1 - beside - metrics.text_width("t = 0.2222 s ")
    said, _ = metrics.first_fitting_text((main_settings_text(scene), ""), room, metrics.line_height)
    yield Label("settings", said, beside, metrics.high, "top-left", "note", tone="faint")
    yield from legend_labels(tr(BarStage.MARKED), metrics, box.below)
