"""The three plots over time of the left panel: error norms, error indices and grid crossings.

The truth and every estimator has a line of its own, the truth's broad and beneath. A chart that is given other series
forgets its range, and one that is removed may still be sent data: so each set of estimators has plots of its own, made
when it is first used and hidden while another set runs.
"""

from __future__ import annotations

import numpy as np
import viser

from app.colours import ESTIMATOR_LINES, TRUTH
from app.page.history import History
from app.page.panels.choices import SYMBOLS
from app.scale import BEYOND, largest
from app.words import power_of_ten, power_text

INDEX_RANGE = (0.05, 20.0)  # of the index plot; an index above is drawn at its edge
CROSSINGS, PERFECT = "#cc0078", "#c3c9d1"
LEAST_HEIGHT, LABEL_HEIGHT = 76, 15  # pixels, of a plot and of the label below the last
_FONT, _LABEL_FONT = "10px sans-serif", "11px sans-serif"
_FROM_ZERO = {"range": {"min": {"soft": 0, "mode": 1, "pad": 0}, "max": {"soft": 0, "mode": 1, "pad": 0.2}}}
_RATIOS = {"y_scale": {"distr": 3, "range": list(INDEX_RANGE)},
           "y_axis": {"splits": [0.1, 1, 10], "values": ["0.1", "1", "10"]}}
_EMPTY = np.array([0.0, 1e-9])  # what an empty plot holds
_GRID = {"stroke": "#e6e9ee", "width": 1}


class Plots:
    """Call :meth:`show` a few times a second, or :meth:`clear` when there is nothing to show."""

    def __init__(self, client: viser.ClientHandle, tab: viser.GuiTabHandle):
        self._gui, self._tab = client.gui, tab
        self._sets: dict[tuple[str, ...], list[tuple[viser.GuiHtmlHandle, viser.GuiUplotHandle]]] = {}
        self._estimators: tuple[str, ...] = ()
        self.have((), LEAST_HEIGHT)

    def have(self, estimators: tuple[str, ...], height: int) -> None:
        """Have a line for each of these estimators, in plots of this height in pixels."""
        if estimators not in self._sets:
            self._sets[estimators] = self._build(estimators, height)
        for names, pairs in self._sets.items():
            for element in (element for pair in pairs for element in pair):
                if element.visible != (names == estimators):
                    element.visible = names == estimators
        self._estimators = estimators
        self._headings, self._plots = zip(*self._sets[estimators], strict=True)
        for plot, with_label in zip(self._plots, (0, 0, LABEL_HEIGHT), strict=True):
            if plot.height != height + with_label:
                plot.height = height + with_label

    def show(self, history: History, valid: tuple[str, ...], quantity: str, unit: str, no_index: str) -> None:
        """Draw a run: the truth and the ``valid`` ones of its estimators; ``no_index`` says why there is no index."""
        series = history.series
        time = series["time"]
        nothing = np.full(len(time), np.nan)
        true = series[f"error_{quantity}"]
        estimated = [_bounded(series[f"{name}/estimate_{quantity}"], true) if name in valid else nothing
                     for name in self._estimators]
        power = power_of_ten(max(largest(values) for values in (*estimated, true)))
        _set(self._headings[0], _heading(f"error norm of {SYMBOLS[quantity]} / {power_text(power)}{unit}"))
        self._plots[0].data = _finite(time, *(values / 10.0**power for values in (true, *estimated)))
        _set(self._headings[1], _heading(f"error index of {SYMBOLS[quantity]}: estimated / true", no_index))
        indices = [np.minimum(series[f"{name}/index_{quantity}"], INDEX_RANGE[1]) if name in valid else nothing
                   for name in self._estimators]
        self._plots[1].data = _finite(time, np.ones(len(time)), *indices)
        self._show_crossings(history)

    def clear(self) -> None:
        """Show nothing: no time has passed."""
        for plot in self._plots:
            plot.data = _finite(_EMPTY, *(np.full(2, np.nan) for _ in plot.data[1:]))

    def _build(self, estimators: tuple[str, ...],
               height: int) -> list[tuple[viser.GuiHtmlHandle, viser.GuiUplotHandle]]:
        """Each plot below its heading."""
        lines = [{"label": name, "stroke": colour, "width": 2, "dash": list(dash), "points": {"show": False}}
                 for name in estimators for colour, dash in (ESTIMATOR_LINES[name],)]
        true = {"label": "true", "stroke": TRUTH, "width": 3.5, "points": {"show": False}}
        perfect = {"label": "perfect", "stroke": PERFECT, "width": 2.5, "points": {"show": False}}
        crossings = {"label": "crossings", "stroke": CROSSINGS, "width": 1.5, "points": {"show": False}}
        with self._tab:
            return [(self._gui.add_html(_heading(title)), self._plot(tuple(drawn), height, **axes))
                    for title, drawn, axes in (("error norm", [true, *lines], {}),
                                               ("error index", [perfect, *lines], _RATIOS),
                                               ("grid crossings per second", [crossings], {"x_label": "t / s"}))]

    def _show_crossings(self, history: History) -> None:
        time, rate = history.crossings_per_second()
        power = power_of_ten(largest(rate))
        _set(self._headings[2],
             _heading(f"grid crossings per second{' / ' * bool(power)}{power_text(power)}",
                      "" if history.scene.has("crossings") else "not counted: the effect \"grid crossings\" is off"))
        self._plots[2].data = _finite(time, rate / 10.0**power) if len(time) > 1 else (_EMPTY, _EMPTY)

    def _plot(self, series: tuple[dict, ...], height: int, y_scale: dict | None = None,
              y_axis: dict | None = None, x_label: str = "") -> viser.GuiUplotHandle:
        start = np.array([0.0, 1e-3])
        label = {"label": x_label, "labelSize": LABEL_HEIGHT, "labelFont": _LABEL_FONT} if x_label else {}
        axes = ({"size": 24, "font": _FONT, "grid": _GRID, "ticks": {"stroke": "#c6ccd4", "width": 1, "size": 4},
                 **label},
                {"size": 40, "font": _FONT, "grid": _GRID, "ticks": {"show": False}, **(y_axis or {})})
        return self._gui.add_uplot((start, *(np.full(2, np.nan) for _ in series)), ({"label": "t"}, *series),
                                   axes=axes, scales={"x": {"time": False}, "y": y_scale or _FROM_ZERO},
                                   height=height + LABEL_HEIGHT * bool(x_label), padding=(8, 20, 0, 0),
                                   legend={"show": False})


def _bounded(estimated: np.ndarray, true: np.ndarray) -> np.ndarray:
    """An estimate that has lost its way leaves the plot instead of flattening the truth."""
    truth = largest(true)
    return np.where(estimated <= BEYOND * truth, estimated, np.nan) if truth > 0 else estimated


def _finite(time: np.ndarray, *values: np.ndarray) -> tuple[np.ndarray, ...]:
    """What the plots take: what is infinite is not drawn, and a series of nothing has one zero.

    Without it the plot finds no range and draws the other series neither.
    """
    drawn = [np.where(np.isfinite(v), v, np.nan) for v in values]
    for series in drawn:
        if np.isnan(series).all():
            series[0] = 0.0
    return (time, *drawn)


def _set(element: viser.GuiHtmlHandle, content: str) -> None:
    """Send html only when it has changed."""
    if element.content != content:
        element.content = content


def _heading(text: str, remark: str = "") -> str:
    """A plot's title, and below why it is empty. Not the plot's own: the viewer builds a plot anew when it changes."""
    return f"<div class='lab-heading'>{text}{f'<br><span>{remark}</span>' if remark else ''}</div>"
