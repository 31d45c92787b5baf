"""The left panel: numbers of the run and three plots over time."""

from __future__ import annotations

import html

import numpy as np
import viser

from app.colours import ESTIMATE, TRUTH
from app.history import History
from app.panels.furniture import MEASUREMENTS_WIDTH
from app.scale import BEYOND, largest, power_of_ten, power_text
from app.session import Session

SYMBOLS = {"x": "x", "v": "v", "sigma": "σ", "a": "a"}
READOUT_HEIGHT = 404  # pixels of the window that are not plot: heading, numbers, titles and axes
INDEX_RANGE = (0.05, 20.0)  # of the index plot; an index above is drawn at its edge
_FONT, _LABEL_FONT = "10px sans-serif", "11px sans-serif"
_FROM_ZERO = {"range": {"min": {"soft": 0, "mode": 1, "pad": 0}, "max": {"soft": 0, "mode": 1, "pad": 0.2}}}
_EMPTY = np.array([0.0, 1e-9])  # what an empty plot holds
_GRID = {"stroke": "#e6e9ee", "width": 1}


class Measurements:
    """Readout and plots of one visitor's session. Call :meth:`refresh` a few times a second."""

    def __init__(self, client: viser.ClientHandle):
        self._client, gui = client, client.gui
        panel = gui.add_panel()
        with panel.add_tab("Measurements", viser.Icon.CHART_LINE):
            self._readout = gui.add_html("<div class='lab-readout'>waiting for the first frame</div>")
            pair = ({"label": "estimated", "stroke": ESTIMATE, "width": 2},
                    {"label": "true", "stroke": TRUTH, "width": 2})
            self._errors_heading = gui.add_html(_heading("error norm"))
            self._errors = _plot(gui, pair, legend=True)
            gui.add_html(_heading("error index: estimated / true"))
            self._index = _plot(gui,
                                ({"label": "index", "stroke": ESTIMATE, "width": 2},
                                 {"label": "perfect", "stroke": "#6b7480", "width": 1, "dash": [5, 4]}),
                                y_scale={"distr": 3, "range": list(INDEX_RANGE)},
                                y_axis={"splits": [0.1, 1, 10], "values": ["0.1", "1", "10"]})
            self._crossings_heading = gui.add_html(_heading("grid crossings per second"))
            self._crossings = _plot(gui, ({"label": "crossings", "stroke": "#cc0078", "width": 1.5},))
        panel.dock_left()
        panel.set_width(MEASUREMENTS_WIDTH)

    def refresh(self, session: Session, estimator: str | None, quantity: str, unit: str,
                probed: str | None) -> None:
        """Show what has come in since the last time."""
        if session.report is None:
            return
        self._fit_height()
        history = session.history
        series = history.series
        self._readout.content = _readout(session, series, estimator, quantity, probed)
        time = series.get("time", np.zeros(0))
        if len(time) < 2:
            for plot in (self._errors, self._index, self._crossings):
                plot.data = tuple(_EMPTY for _ in plot.data)
            return
        nothing = np.full(len(time), np.nan)
        estimated, true = series.get(f"{estimator}/estimate_{quantity}", nothing), series[f"error_{quantity}"]
        estimated = _bounded(estimated, true)
        power = power_of_ten(max(largest(estimated), largest(true)))
        _set(self._errors_heading, _heading(f"error norm of {SYMBOLS[quantity]} / {power_text(power)}{unit}"))
        self._errors.data = _finite(time, estimated / 10.0**power, true / 10.0**power)
        index = np.minimum(series.get(f"{estimator}/index_{quantity}", nothing), INDEX_RANGE[1])
        self._index.data = _finite(time, index, np.ones(len(time)))
        self._refresh_crossings(history)

    def _fit_height(self) -> None:
        """Let the three plots share what the window leaves below the readout."""
        height = max(96, min(240, (self._client.camera.image_height - READOUT_HEIGHT) // 3))
        for plot in (self._errors, self._index, self._crossings):
            if plot.height != height:
                plot.height = height

    def _refresh_crossings(self, history: History) -> None:
        time, rate = history.crossings_per_second()
        power = power_of_ten(largest(rate))
        _set(self._crossings_heading, _heading(f"grid crossings per second{' / ' * bool(power)}{power_text(power)}"))
        self._crossings.data = _finite(time, rate / 10.0**power) if len(time) > 1 else (_EMPTY, _EMPTY)


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


def _heading(text: str) -> str:
    """A plot's title. Not the plot's own: the viewer builds a plot anew, and forgets its range, when it changes."""
    return f"<div class='lab-heading'>{text}</div>"


def _plot(gui: viser.GuiApi, series: tuple[dict, ...], legend: bool = False,
          y_scale: dict | None = None, y_axis: dict | None = None) -> viser.GuiUplotHandle:
    start = np.array([0.0, 1e-3])
    axes = ({"label": "t / s", "labelSize": 15, "size": 24, "font": _FONT, "labelFont": _LABEL_FONT, "grid": _GRID,
             "ticks": {"stroke": "#c6ccd4", "width": 1, "size": 4}},
            {"size": 40, "font": _FONT, "grid": _GRID, "ticks": {"show": False}, **(y_axis or {})})
    return gui.add_uplot((start, *(np.full(2, np.nan) for _ in series)), ({"label": "t"}, *series), axes=axes,
                         scales={"x": {"time": False}, "y": y_scale or _FROM_ZERO}, height=126, padding=(8, 20, 0, 0),
                         legend={"show": legend, "live": False})


def _readout(session: Session, series: dict[str, np.ndarray], estimator: str | None, quantity: str,
             probed: str | None) -> str:
    report = session.report
    scene = report.scene
    real = "–" if report.real_speed is None or not report.playing else f"{report.real_speed:.3g}"
    capped = " <span class='lab-capped'>CAPPED</span>" if session.capped else ""
    state = "" if report.playing else " <b>stopped</b>" if report.reason else " <b>paused</b>"
    rows = [("time", f"{report.time:.4g} s = {report.time / scene.period:.2f} periods{state}"),
            ("steps", f"{report.step:,} of {scene.time_step:.3g} s"),
            ("solver", f"{report.rate:.1f} M particle-steps/s on {html.escape(report.arch)}"),
            ("speed", f"asked {session.speed:.3g}, real {real} s/s{capped}")]
    drift = _energy_drift(series)
    if drift is not None:
        rows.append(("energy", f"out of balance by {drift:+.2%}"))
    index = series.get(f"{estimator}/index_{quantity}", _EMPTY[:0])
    if len(index) and np.isfinite(index[-1]):
        apart = series[f"{estimator}/apart_{quantity}"][-1]
        rows.append(("estimate", f"index {index[-1]:.2f}, distance {apart:.2f}"))
    rows.append(("region", html.escape(probed) if probed else "drag a rectangle on the stage to read errors in it"))
    cells = "".join(f"<tr><td>{name}</td><td>{text}</td></tr>" for name, text in rows)
    return f"<div class='lab-readout'><table>{cells}</table></div>"


def _energy_drift(s: dict[str, np.ndarray]) -> float | None:
    """(E - W - E0)/E0 now, W the body force's work, or None where the energy is not followed."""
    if "kinetic" not in s or not len(s["kinetic"]):
        return None
    total = s["kinetic"] + s["strain"]
    drift = (total[-1] - s["work"][-1] - total[0]) / total[0] if total[0] > 0 else np.nan
    return float(drift) if np.isfinite(drift) else None
