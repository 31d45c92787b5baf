"""The plots over time of the left panel: a traced particle, error norms, error indices and grid crossings.

A chart that is given other series loses its range, and one that is removed may still be sent data. So each set of
estimators has plots of its own, built on first use and hidden while another set runs."""

from collections.abc import Sequence
from html import escape

import numpy as np
import viser
from viser import uplot

from app.colour_palette import PINNED, TRUTH
from app.frame.colour_scale import BEYOND, largest_finite
from app.frame.error_view_captions import NOT_COUNTED, TRUE
from app.language.translation import lazy, tr
from app.names_and_units import QUANTITIES, format_number, format_power_of_ten, power_of_ten
from app.page.panels.readout_tables import name_with_line_sample
from app.page.panels.time_axis import EMPTY
from app.page.visit.history import RunSeries
from app.page.visit.pinned_run import PinnedRun
from app.page.visit.traced_particle_series import TracedParticle
from solvers.scene.estimator_registry import ESTIMATORS
from solvers.scene.scene import Scene

INDEX_RANGE = (0.05, 20.0)  # of the index plot; an index above is drawn at its edge
CROSSINGS, PERFECT = "#cc0078", "#c3c9d1"
APART = 0.05  # periods by which a pinned run may be late without a gap at the end of its curves
LEAST_HEIGHT = 64  # pixels, of a plot
LEAST_SPACE = 16  # pixels between two numbers of an axis: the smallest plot has two
_FONT = "10px sans-serif"
_FROM_ZERO: uplot.Scale = {"range": {"min": {"soft": 0, "mode": 1, "pad": 0},
                                     "max": {"soft": 0, "mode": 1, "pad": 0.2}}}
_RATIOS: uplot.Scale = {"distr": 3, "range": list(INDEX_RANGE)}
_RATIO_MARKS: uplot.Axis = {"splits": (0.1, 1, 10), "values": ("0.1", "1", "10")}
#: Units of time, with the shortest time in s for each: an axis shows three decimals.
_TIMES = (("s", 1.0, 1e-2), ("ms", 1e-3, 1e-5), ("µs", 1e-6, 0.0))
_GRID: uplot.Axis_Grid = {"stroke": "#e6e9ee", "width": 1}
_TICKS: uplot.Axis_Ticks = {"stroke": "#c6ccd4", "width": 1, "size": 4}
#: Tooltips of the plots' titles.
NORM = lazy("root of the mean square over all particles: the broad line is the true error, the others estimate it")
INDEX = lazy("estimated over true error, summed over the run so far; on the grey line, at 1, an estimate is perfect")
CROSSED = lazy("particles that pass from one cell of the grid into the next, in a second of simulated time")
TRACE = lazy("true error and its estimates at the particle that is traced; magenta: where it crosses a cell boundary")
ABOVE = lazy("{estimator} is above the plot, at {index}")
BELOW = lazy("{estimator} is below the plot, at {index}")
HeadedPlot = tuple[viser.GuiHtmlHandle, viser.GuiUplotHandle]
PlotSet = tuple[list[HeadedPlot], viser.GuiHtmlHandle]  # and the label of their times


class TimePlots:
    """One visitor's plots over time. Call :meth:`show` a few times a second, or :meth:`clear` if there is no run."""

    def __init__(self, client: viser.ClientHandle, tab: viser.GuiFolderHandle):
        self._gui, self._tab = client.gui, tab
        self._sets: dict[tuple[tuple[str, ...], bool], PlotSet] = {}
        self._estimators: tuple[str, ...] = ()
        self.set_lines((), LEAST_HEIGHT, False, False)

    def set_lines(self, estimators: tuple[str, ...], height: int, traced: bool, pinned: bool) -> None:
        """Prepares plots (height in px): a line per estimator and ``pinned`` run, and a ``traced`` particle's plot."""
        wanted = estimators, pinned
        if wanted not in self._sets:
            self._sets[wanted] = self._build(estimators, height, pinned)
        for which, (pairs, label) in self._sets.items():
            label.visible = which == wanted
            for k, (heading, plot) in enumerate(pairs):
                heading.visible = plot.visible = which == wanted and (traced or k > 0)
        self._estimators = estimators
        (self._trace, *pairs), self._time_label = self._sets[wanted]
        self._headings, self._plots = zip(*pairs, strict=True)
        for plot in (self._trace[1], *self._plots):
            plot.height = height

    def show(self, history: RunSeries, valid: tuple[str, ...], quantity: str, no_index: str, latest: bool,
             pinned: PinnedRun | None, estimator: str | None) -> None:
        """Draws a run or its ``latest`` periods: true and ``valid`` estimated errors of a quantity ("x"). ``no_index``
        is the reason for no error index, or "". A ``pinned`` run is grey, with the ``estimator`` on the stage."""
        series, words = history.latest_periods_series if latest else history.series, QUANTITIES[quantity]
        time = series["time"]
        nothing = np.full(len(time), np.nan)
        grey, grey_index, grey_rate = pinned_curves(pinned, history, series, quantity, estimator, latest)
        errors, unit = self._errors(series, valid, quantity, grey)
        of_time, second = _time_unit(time[-1], history.scene)
        self._time_label.content = _time_label(of_time)
        # The legend of the presented plot, where the readout is hidden.
        meant = *map(name_with_line_sample, (TRUE, *valid)), tr("over {time}", time=of_time)
        lines = "".join(f"<span>{text}</span>" for text in meant)
        title = tr("error norm of {symbol} / {unit}", symbol=words.symbol, unit=unit) \
            + f"<br>{tr('grey: pinned')}" * bool(grey) + f"<div class='lab-lines'>{lines}</div>"
        self._headings[0].content = _heading(title, NORM, kind="lab-presented")
        set_series(self._plots[0], plottable_series(second * time, *errors))
        (low, high), ends = INDEX_RANGE, {name: series[f"{name}/index_{quantity}"][-1] for name in valid}
        beyond = no_index or "; ".join(tr(ABOVE if index > high else BELOW, estimator=name, index=format_number(index))
                                       for name, index in ends.items()
                                       if np.isfinite(index) and not low <= index <= high)
        title = tr("error index of {symbol}: estimated / true", symbol=words.symbol)
        self._headings[1].content = _heading(title, INDEX, beyond)
        indices = [np.minimum(series[f"{name}/index_{quantity}"], INDEX_RANGE[1]) if name in valid else nothing
                   for name in self._estimators]
        clipped = (np.minimum(values, INDEX_RANGE[1]) for values in grey_index)
        set_series(self._plots[1], plottable_series(second * time, *clipped, np.ones(len(time)), *indices))
        self._show_crossings(history, series, grey_rate, second)

    def show_trace(self, traced: TracedParticle, valid: tuple[str, ...], quantity: str, latest: bool,
                   shown: float) -> None:
        """Draws a particle's errors of a quantity ("x"); its crossings and the time ``shown``, in s, are marked."""
        series, (heading, plot) = traced.latest_periods_series if latest else traced.series, self._trace
        time, (errors, unit) = series["time"], self._errors(series, valid, quantity)
        if len(time) < 2:
            set_series(plot, plottable_series(EMPTY, *(np.full(2, np.nan) for _ in plot.data[1:])))
            return
        first = next((values for values in errors if np.isfinite(values).any()), np.zeros(len(time)))
        crossed = np.where(traced.crossing_marks(time), first, np.nan)
        at = np.where(np.arange(len(time)) == np.argmin(np.abs(time - shown)), first, np.nan)
        error = tr("error of {symbol} / {unit}", symbol=QUANTITIES[quantity].symbol, unit=unit)
        heading.content = _heading(f"{traced.title}<br>{error}", TRACE,
                                   kind=f"lab-traced' data-particle='{traced.particle}")
        set_series(plot, (*plottable_series(_time_unit(time[-1], traced.scene)[1] * time, *errors), crossed, at))

    def _errors(self, series: dict[str, np.ndarray], valid: tuple[str, ...], quantity: str,
                grey: Sequence[np.ndarray] = ()) -> tuple[list[np.ndarray], str]:
        """Returns the curves ``grey``, true and estimated, divided by a power of ten, and the unit with that power."""
        true = series[f"error_{quantity}"]
        estimated = [clip_estimate(series[f"{name}/estimate_{quantity}"], true) if name in valid
                     else np.full(len(true), np.nan) for name in self._estimators]
        errors = [*grey, true, *estimated]
        power = power_of_ten(max(largest_finite(values) for values in errors))
        return [values / 10.0**power for values in errors], f"{format_power_of_ten(power)}{QUANTITIES[quantity].unit}"

    def clear(self) -> None:
        self._time_label.content = _time_label("t / s")
        for plot in self._plots:
            set_series(plot, plottable_series(EMPTY, *(np.full(2, np.nan) for _ in plot.data[1:])))

    def _build(self, estimators: tuple[str, ...], height: int, pinned: bool) -> PlotSet:
        grey = [series_options(tr("pinned, true"), PINNED, 2.5),
                series_options(tr("pinned"), PINNED, 1.5, (5, 3))] if pinned else []
        lines = [series_options(name, ESTIMATORS[name].colour, 2, ESTIMATORS[name].dashes) for name in estimators]
        true, perfect = series_options(tr(TRUE), TRUTH, 3.5), series_options(tr("perfect"), PERFECT, 2.5)
        crossings = series_options(tr("crossings"), CROSSINGS, 1.5)
        marks = _marks(tr("crossed"), CROSSINGS, 7), _marks(tr("shown"), "black", 5)
        with self._tab:
            return [self._plot(tr("particle"), (true, *lines, *marks), height),
                    self._plot(tr("error norm"), (*grey, true, *lines), height),
                    self._plot(tr("error index"), (*grey[1:], perfect, *lines), height, _RATIOS, _RATIO_MARKS),
                    self._plot(tr("grid crossings per second"), (*grey[:1], crossings), height)], \
                self._gui.add_html(_time_label("t / s"))

    def _show_crossings(self, history: RunSeries, series: dict[str, np.ndarray], grey: list[np.ndarray],
                        second: float) -> None:
        """Draws crossings per second; ``second`` is the length of a second in units of the time axis."""
        time, rate = history.crossings_per_second(series)
        time = np.append(series["time"][:1], time)  # start with the other plots, and include the first rate
        power = power_of_ten(max(map(largest_finite, (*grey, rate))))
        self._headings[2].content = _heading(
            f"{tr('grid crossings per second')}{' / ' * bool(power)}{format_power_of_ten(power)}", CROSSED,
            "" if history.scene.has("crossings") else tr(NOT_COUNTED))
        rates = [np.append(values[:1], values) / 10.0**power for values in (*grey, rate)]
        if len(time) < 3:  # nothing to draw yet, over the time that has passed
            time, rates = series["time"][[0, -1]], [np.full(2, np.nan) for _ in rates]
        set_series(self._plots[2], plottable_series(second * time, *rates))

    def _plot(self, heading: str, series: tuple[uplot.Series, ...], height: int, y_scale: uplot.Scale = _FROM_ZERO,
              y_axis: uplot.Axis | None = None) -> HeadedPlot:
        x: uplot.Axis = {"size": 24, "font": _FONT, "grid": _GRID, "ticks": _TICKS}
        y: uplot.Axis = {"size": 40, "space": LEAST_SPACE, "font": _FONT, "grid": _GRID, "ticks": {"show": False}}
        return self._gui.add_html(_heading(heading)), self._gui.add_uplot(
            (EMPTY, *(np.full(2, np.nan) for _ in series)), ({"label": "t"}, *series), legend={"show": False},
            axes=(x, {**y, **(y_axis or {})}), scales={"x": {"time": False}, "y": y_scale},
            height=height, padding=(8, 20, 0, 0))


def pinned_curves(pinned: PinnedRun | None, history: RunSeries, series: dict[str, np.ndarray], quantity: str,
                  drawn: str | None, latest: bool) -> list[list[np.ndarray]]:
    """Returns a pinned run's curves at the times of ``series`` (n,), stretched to equal periods: [true and estimated
    norm], [error index], [crossings per second]; or three []. ``drawn`` is the estimator if the run has it."""
    if pinned is None:
        return [[], [], []]
    run, estimator = pinned.history, pinned.estimator(drawn)
    stretch = history.scene.period / run.scene.period
    theirs, none = run.latest_periods_series if latest else run.series, np.zeros(0)
    own, true = theirs.get("time", none), theirs.get(f"error_{quantity}", none)

    def on_axis(times: np.ndarray, own: np.ndarray, values: np.ndarray) -> np.ndarray:
        if not len(own) or len(values) != len(own):
            return np.full(len(times), np.nan)
        ended = times > stretch * own[-1] + APART * history.scene.period
        return np.where(ended, np.nan, np.interp(times, stretch * own, values))

    estimated = clip_estimate(theirs.get(f"{estimator}/estimate_{quantity}", np.full(len(true), np.nan)), true)
    time = series["time"]
    return [[on_axis(time, own, true), on_axis(time, own, estimated)],
            [on_axis(time, own, theirs.get(f"{estimator}/index_{quantity}", none))],
            [on_axis(history.crossings_per_second(series)[0], *run.crossings_per_second(theirs))]]


def set_series(plot: viser.GuiUplotHandle, data: tuple[np.ndarray, ...]) -> None:
    """Sets a plot's arrays, abscissa first; sends nothing if they are unchanged, as while a run is paused."""
    if not all(np.array_equal(own, new, equal_nan=True) for own, new in zip(plot.data, data, strict=True)):
        plot.data = data


def series_options(label: str, colour: str, width: float, dashes: tuple[int, ...] = ()) -> uplot.Series:
    """Returns plot options for a line without points: its ``width`` and ``dashes`` are in pixels."""
    return {"label": label, "stroke": colour, "width": width, "dash": dashes, "points": {"show": False}}


def _marks(label: str, colour: str, size: float) -> uplot.Series:
    """Returns plot options for points of a ``size`` in pixels that do not affect the plot's range."""
    return {"label": label, "stroke": colour, "width": 0, "auto": False,
            "points": {"show": True, "size": size, "fill": colour, "stroke": colour}}


def clip_estimate(estimated: np.ndarray, true: np.ndarray) -> np.ndarray:
    """Returns estimated errors, limited to a multiple of the largest true one so that its curve stays visible."""
    truth = largest_finite(true)
    return np.minimum(estimated, BEYOND * truth) if truth > 0 else estimated


def plottable_series(time: np.ndarray, *values: np.ndarray) -> tuple[np.ndarray, ...]:
    """Returns time and values (n,) each, with NaN for infinite ones, and one 0 in series that would have no range."""
    drawn = [np.where(np.isfinite(v), v, np.nan) for v in values]
    for series in drawn:
        if np.isnan(series).all():
            series[0] = 0.0
    return (time, *drawn)


def _time_unit(end: float, scene: Scene) -> tuple[str, float]:
    """Returns the label of the time axis for times up to ``end`` in s, and how many of its units a second has."""
    if scene.swings:
        return tr("t in periods"), 1 / scene.period
    unit, size = next((unit, size) for unit, size, shortest in _TIMES if end >= shortest or end <= 0)
    return f"t / {unit}", 1 / size


def _time_label(of_time: str) -> str:
    return f"<div class='lab-time'>{of_time}</div>"


def _heading(text: str, hint: str = "", remark: str = "", kind: str = "") -> str:
    """Returns the html of a plot's title with a tooltip ``hint``, a ``remark`` below and CSS classes (``kind``)."""
    below = f"<br><span>{remark}</span>" if remark else ""
    return f"<div class='lab-heading {kind}' title='{escape(tr(hint) if hint else '')}'>{text}{below}</div>"
