"""The plot below the stage of what a body's goal is about, over time, in its error bar as a band."""

from dataclasses import dataclass

import numpy as np
from viser import uplot

from app.colour_palette import LINES
from app.language.translation import tr
from app.names_and_units import with_unit
from app.page.panels.time_axis import EMPTY, TimeAxis, TimelineState, clock_text, round_ticks
from app.page.panels.time_plots import plottable_series, series_options, set_series

MARGIN = 0.08  # above and below the curve, over its range
ASIDE = 1.1  # end of the time axis over that of the run, for the curve's name
BAND = "rgba(224, 120, 30, 0.4)"  # the estimate's colour on any ground


@dataclass(frozen=True, eq=False)
class GoalCurve:
    """Curve of a goal called ``name``: ``values`` (n,) in ``unit`` of what it is about, y of a point or a stress, and
    the half widths of its ``bars`` (n,), NaN where there is none, at ``times`` (n,) in s; the run ``ends`` at a time in
    s."""

    name: str
    symbol: str
    unit: str
    times: np.ndarray
    values: np.ndarray
    bars: np.ndarray
    ends: float


class GoalTimeline:
    """One visitor's plot of a goal, on the time ``axis``; hidden until :meth:`show`."""

    def __init__(self, axis: TimeAxis):
        self._axis, self._dark, self._end = axis, False, 1.0
        self._plot = axis.add_plot(self._series(), ({"series": (1, 2), "fill": BAND, "dir": -1},))
        self._plot.visible = False

    def set_dark(self, dark: bool) -> None:
        self._dark = dark
        self._plot.series = self._series()

    def hide(self) -> None:
        self._plot.visible = False

    def time_at(self, fraction: float) -> float:
        """Returns the time in s at a fraction, 0 to 1, of the time axis."""
        return fraction * self._end

    @property
    def is_shown(self) -> bool:
        return self._plot.visible

    def show(self, curve: GoalCurve, now: TimelineState) -> None:
        """Draws the curve of a goal in its band, and the axis."""
        self._plot.visible, self._plot.height = True, self._axis.height
        low, high = (curve.values + sign * np.nan_to_num(curve.bars) for sign in (-1, 1))
        bottom, top = float(low.min()), float(high.max())
        margin = MARGIN * (top - bottom) or 1.0
        bottom, top, end = bottom - margin, top + margin, ASIDE * curve.ends
        scales: dict[str, uplot.Scale] = {"x": {"time": False, "range": [0.0, end]}, "y": {"range": [bottom, top]}}
        if scales != self._plot.scales:
            self._plot.scales = scales
        self._end = end
        gap = np.full(2, np.nan)
        set_series(self._plot, plottable_series(curve.times, high, low, curve.values) if len(curve.times) > 1 else
                   plottable_series(EMPTY, gap, gap, gap))
        ticks = round_ticks(0.0, end, 1.0)
        marks = [[round(tick / end, 4), with_unit(tick, "s")] for tick in ticks]

        def height(value: float) -> float:
            return round((top - value) / (top - bottom), 4)

        self._axis.send({
            "title": [curve.symbol, tr("and its bar")],
            "tops": [[height(top - margin), with_unit(top - margin, curve.unit)]],
            "zero": with_unit(bottom, curve.unit), "start": "0", "ticks": marks,
            "now": round(now.time / end, 4), "reach": [0, round(now.reach[1] / end, 4)],
            "changes": [], "first": "", "names": [[curve.name, "dot", height(float(curve.values[-1]))]],
            "clock": clock_text(now.time), "playing": now.playing, "read": [], "lost": None, "says": ""})

    def _series(self) -> tuple[uplot.Series, ...]:
        edge = series_options(tr("error bar"), BAND, 0.5)
        return {"label": "t"}, edge, edge, series_options(tr("run"), LINES["dot"][self._dark], 2)
