"""The plot below the stage of what a body's goal is about, over time, in its error bar as a band."""


import numpy as np
from viser import uplot

from app.colour_palette import LINES
from app.frame.goal_curve import GoalCurve, round_levels
from app.frame.value_and_bar import in_one_unit
from app.language.translation import tr
from app.names_and_units import clock_text
from app.page.panels.time_axis import EMPTY, TimeAxis, TimelineState, round_ticks
from app.page.panels.time_plots import plottable_series, series_options, set_series

LEAST_BAND = 7.0  # height in pixels at which the band is visible beside the curve
HIGHEST_NAME = 0.2  # where the curve's name does not touch the upper end, as a part of the height
ASIDE = 1.1  # end of the time axis over that of the run, for the curve's name
BAND = "rgba(224, 120, 30, 0.4)"  # the estimate's colour on any ground


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
        levels, end = round_levels(curve), ASIDE * curve.ends
        texts = in_one_unit(levels, curve.unit)
        bottom, top = levels[0], levels[-1]
        least = 0.5 * LEAST_BAND * (top - bottom) / self._axis.height
        half = np.nan_to_num(np.maximum(curve.bars, least))  # no gaps: the plot would fill some of them
        scales: dict[str, uplot.Scale] = {"x": {"time": False, "range": [0.0, end]}, "y": {"range": [bottom, top]}}
        if scales != self._plot.scales:
            self._plot.scales = scales
        self._end = end
        set_series(self._plot, plottable_series(
            curve.times, curve.values + half, curve.values - half, curve.values) if len(curve.times) > 1 else
            plottable_series(EMPTY, *np.full((3, 2), np.nan)))
        ticks = round_ticks(0.0, end, 1.0)
        marks = [[round(tick / end, 4), text] for tick, text in zip(ticks, in_one_unit(ticks, "s"), strict=True)]

        def height(value: float) -> float:
            return round((top - value) / (top - bottom), 4)

        name_height, bar = max(HIGHEST_NAME, height(float(curve.values[-1]))), curve.value_and_bar(-1)[1]
        names = [[curve.name, "dot", name_height], *[[f"± {bar}", "estimate", name_height]] * bool(bar)]
        self._axis.send({
            "title": [curve.symbol, tr("and its bar")],
            "tops": [[height(level), text] for level, text in zip(levels[1:], texts[1:], strict=True)],
            "zero": texts[0], "start": "0", "ticks": marks,
            "now": round(now.time / end, 4), "reach": [0, round(now.reach[1] / end, 4)],
            "changes": [], "first": "", "names": names, "clock": clock_text(now.time), "playing": now.playing,
            "read": self._values_at_pointer(curve), "lost": None, "says": ""})

    def _values_at_pointer(self, curve: GoalCurve) -> list[str]:
        """Returns texts of the time, value and bar of the frame at the pointer; none beyond the run."""
        if self._axis.pointed is None or (at := self.time_at(self._axis.pointed)) > curve.times[-1]:
            return []
        k = int(np.argmin(np.abs(curve.times - at)))
        value, bar = curve.value_and_bar(k)
        bar_text = f"± {bar}" if bar else f"({tr('no bar')})"
        return [clock_text(float(curve.times[k])), f"{curve.symbol} = {value} {bar_text}"]

    def _series(self) -> tuple[uplot.Series, ...]:
        edge = series_options(tr("error bar"), BAND, 0.5)
        return {"label": "t"}, edge, edge, series_options(tr("run"), LINES["dot"][self._dark], 2)
