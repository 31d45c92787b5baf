"""The error over time below the stage: curves in per cent, and as html the axis, the curves' names, the present, stored
frames and cell changes."""

from collections.abc import Sequence

import numpy as np
import viser
from viser import uplot

from app.colour_palette import LINES, PINNED
from app.frame.colour_scale import largest_finite, round_up
from app.frame.error_view_captions import TRUE
from app.language.translation import lazy, localise_number, tr, trn
from app.names_and_units import clock_text, format_number, functions_name, in_periods, per_cent, with_unit
from app.page.panels.time_axis import EMPTY, TimeAxis, TimelineState, round_ticks
from app.page.panels.time_plots import clip_estimate, pinned_curves, plottable_series, series_options, set_series
from app.page.visit.history import RunSeries
from app.page.visit.pinned_run import PinnedRun
from solvers.scene.estimator_registry import ESTIMATORS
from solvers.scene.scene import Scene

ENDS = (1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 8)  # times a power of ten: possible ends of the time's axis
TOPS = (1, 1.2, 2, 4, 6, 8)  # of that of the errors, whose halves are round, too
HEADROOM, ASIDE = 1.04, 1.13  # over the largest error, and beside the last time, for the curves' names
BINS = 150  # intervals of the time's axis in which cell changes are counted
MOST_LETTERS = 7  # of a number on the axis of errors, beside its name

UNSTABLE, LOST = lazy("unstable from {time} on"), lazy("lost from {time} on")


class ErrorTimeline:
    """One visitor's plot of error over time below the stage. Call :meth:`show` a few times a second."""

    def __init__(self, axis: TimeAxis):
        self._axis = axis
        self._plots: dict[tuple[tuple[str, ...], bool], viser.GuiUplotHandle] = {}
        self._estimators: tuple[str, ...] = ()
        self._ends: tuple[float, float, float] | None = None  # of the axes: times, and the error
        self._scale_key: object = None
        self._dark = False
        self._read: tuple[np.ndarray, dict[str, np.ndarray]] = EMPTY, {}  # times, and the curves' shares by name

    def set_dark(self, dark: bool) -> None:
        self._dark = dark
        for (estimators, pinned), plot in self._plots.items():
            plot.series = self._series(estimators, pinned)

    def set_lines(self, estimators: tuple[str, ...], pinned: bool) -> None:
        """Prepares the plot: a line for each estimator (by name), and for a pinned run if ``pinned``."""
        wanted = estimators, pinned
        if wanted not in self._plots:
            self._plots[wanted] = self._axis.add_plot(self._series(estimators, pinned))
            self._ends = None
        for which, plot in self._plots.items():
            plot.visible = which == wanted
        self._estimators, self._plot = estimators, self._plots[wanted]
        self._plot.height = self._axis.height

    def show(self, past: RunSeries, valid: tuple[str, ...], quantity: str, latest: bool, pinned: PinnedRun | None,
             estimator: str | None, now: TimelineState) -> None:
        """Draws a run's error norms of a quantity ("x") until now, as shares of its largest exact value, of the
        ``valid`` estimators; with ``latest`` only its last periods; a ``pinned`` run in grey, by the same
        ``estimator``."""
        series, size = past.latest_periods_series if latest else past.series, past.scene.size_of(quantity)
        time = series["time"]
        of_other = size if pinned is None else pinned.scene.size_of(quantity)
        grey = [curve / of_other for curve in pinned_curves(pinned, past, series, quantity, estimator, latest)[0]]
        true = series[f"error_{quantity}"] / size
        estimated = [clip_estimate(series[f"{name}/estimate_{quantity}"] / size, true) if name in valid
                     else np.full(len(time), np.nan) for name in self._estimators]
        self._grow_axes(past, (quantity, latest), time, [*grey, true, *estimated], now.time)
        set_series(self._plot, plottable_series(time - (self._ends or (0.0,))[0], *grey, true, *estimated))
        self._read = time, {tr(TRUE): true, **dict(zip(self._estimators, estimated, strict=True))}
        named = [(tr(TRUE), "truth", true), *((name, name.replace("-", ""), curve) for name, curve in
                                              zip(self._estimators, estimated, strict=True) if name in valid)]
        if pinned:
            named.append((functions_name(pinned.follows) if pinned.follows else tr("pinned"), "pinned", grey[0]))
        self._send_axis_and_marks(past, series, named, now)

    def time_at(self, fraction: float) -> float:
        """Returns the time in s at a fraction, 0 to 1, of the time axis."""
        start, end, _ = self._ends or (0.0, 1.0, 1.0)
        return start + fraction * (end - start)

    def hide(self) -> None:
        """Hides all curves, until the next :meth:`set_lines`."""
        for plot in self._plots.values():
            plot.visible = False

    def clear(self, now: TimelineState) -> None:
        set_series(self._plot, plottable_series(EMPTY, *(np.full(2, np.nan) for _ in self._plot.data[1:])))
        self._axis.send({"tops": [], "start": "", "ticks": [], "now": 0, "reach": [0, 0], "changes": [],
                    "first": "", "names": [], "clock": clock_text(now.time), "playing": now.playing, "read": [],
                    "lost": None, "says": ""})

    def _grow_axes(self, past: RunSeries, curve_key: object, time: np.ndarray, curves: Sequence[np.ndarray],
                   now: float) -> None:
        """Sets the ends of both axes, which only grow within a run and ``curve_key``; the present, ``now`` in s, may be
        later than the last sample of a broken run."""
        most = max(map(largest_finite, curves))
        start, of_time = float(time[0]) if time[0] > past.scene.period else 0.0, unit_of_time(past.scene)
        end = round_up(ASIDE * (max(float(time[-1]), now) - start) / of_time, ENDS)[0] * of_time
        top, _ = round_up(HEADROOM * most, TOPS) if most > 0 else (0.01, 0)
        if self._ends and self._scale_key == (past.scene, curve_key) and not start:
            end, top = max(end, self._ends[1]), max(top, self._ends[2])
        self._scale_key = past.scene, curve_key
        ends = start, start + end if start else end, top
        if ends != self._ends:
            self._ends = ends
            self._plot.scales = {"x": {"time": False, "range": [0.0, ends[1] - ends[0]]}, "y": {"range": [0.0, top]}}

    def _send_axis_and_marks(self, past: RunSeries, series: dict[str, np.ndarray],
                             named: Sequence[tuple[str, str, np.ndarray]], now: TimelineState) -> None:
        """Sends everything around the curves, of which ``named`` has name, colour and values (T,)."""
        start, end, top = self._ends or (0.0, 1.0, 1.0)

        def part(time: float) -> float:
            return round(min(1.0, max(0.0, (time - start) / (end - start))), 4)

        def height(share: float) -> float:
            return round(1 - min(1.0, share / top), 4)

        of_time, swings = unit_of_time(past.scene), past.scene.swings
        ticks = round_ticks(start, end, of_time) if not start else []
        last = "" if not ticks else in_periods(ticks[-1] / of_time) if swings else with_unit(ticks[-1], "s")
        # A unit with a prefix, shown once.
        factor = 1 / of_time if swings or not ticks else float(last.split()[0].replace(",", ".")) / ticks[-1]
        marks = [[part(tick), localise_number(f"{tick * factor:.4g}") if tick != ticks[-1] else last] for tick in ticks]
        begin = "0" if not start else in_periods(start / of_time) if swings else with_unit(start, "s")
        changes, many = self._cell_changes(series, start, end)
        # From 1000 % on as a factor, which is shorter: the labels have little room.
        tops = [(height(share), per_cent(share) if share < 10 else f"{format_number(share)} x")
                for share in (top, 0.5 * top)]
        if len(tops[0][1]) > MOST_LETTERS:  # of rounding errors: beside the axis' name there is room for one
            tops = tops[:1]
        said = {"tops": tops, "start": begin, "ticks": marks, "now": part(now.time),
                "reach": [*map(part, now.reach)], "changes": changes, "first": tr("first crossing") if changes else "",
                "many": trn("{count:,} cell change so far", "{count:,} cell changes so far", many),
                "names": [[name, colour, height(float(curve[-1]))] for name, colour, curve in named
                          if np.isfinite(curve[-1])],
                "clock": clock_text(now.time), "playing": now.playing,
                "read": self._values_at_pointer(past.scene),
                "lost": None if now.lost is None else part(now.lost), "says": "" if now.lost is None else
                tr(UNSTABLE if now.unstable else LOST, time=clock_text(now.lost))}
        self._axis.send(said)

    def _values_at_pointer(self, scene: Scene) -> list[str]:
        """Returns texts of the time and each curve's value at the pointer; none beyond the run."""
        time, curves = self._read
        if self._axis.pointed is None or not curves or (at := self.time_at(self._axis.pointed)) > time[-1]:
            return []
        values = {name: float(np.interp(at, time, curve)) for name, curve in curves.items()}
        periods = f" = {in_periods(at / scene.period)}" * scene.swings
        return [with_unit(at, "s") + periods, *(f"{name} {per_cent(value)}" for name, value in values.items()
                                                if np.isfinite(value))]

    @staticmethod
    def _cell_changes(series: dict[str, np.ndarray], start: float, end: float) -> tuple[list[float], int]:
        """Returns where particles have changed their cell, as fractions of the time axis from ``start`` to ``end`` in
        s, at most 150, and how many cell changes there are in all."""
        time, count = series["time"], series.get("crossings")
        if count is None or not len(count) or not np.isfinite(count[-1]):
            return [], 0
        at = (time[1:] - start)[np.diff(count) > 0] / (end - start)
        bins = np.unique(np.floor(BINS * at[(at >= 0) & (at <= 1)]))
        return np.round((bins + 0.5) / BINS, 4).tolist(), int(count[-1])

    def _series(self, estimators: tuple[str, ...], pinned: bool) -> tuple[uplot.Series, ...]:
        """Returns the styles of time and all lines; the truth's is broad and beneath the estimators'."""
        grey = [series_options(tr("pinned, true"), PINNED, 2.5),
                series_options(tr("pinned"), PINNED, 1.5, (5, 3))] if pinned else []
        lines = [series_options(name, LINES[name.replace("-", "")][self._dark], 2, ESTIMATORS[name].dashes)
                 for name in estimators]
        return {"label": "t"}, *grey, series_options(tr(TRUE), LINES["truth"][self._dark], 4), *lines


def unit_of_time(scene: Scene) -> float:
    """Returns the unit of the time axis in s: the scene's period, or 1 s if its motion does not oscillate."""
    return scene.period if scene.swings else 1.0
