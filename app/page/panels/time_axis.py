"""The time axis below the stage, and the box of the plots over time on it (``js/timeline.js`` draws the axis)."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

import numpy as np
import viser
from viser import uplot

from app.frame.colour_scale import round_up

EMPTY = np.array([0.0, 1.0])  # what an empty plot holds
TICKS = 4  # of the time's axis, at least


@dataclass(frozen=True)
class TimelineState:
    """State of the time axis: present ``time`` and ``reach`` of stored frames (from, to), in s; whether the run plays;
    and the time in s since when it is ``lost`` or, if that is set, ``unstable``."""

    time: float
    reach: tuple[float, float]
    playing: bool
    lost: float | None = None
    unstable: bool = False


class TimeAxis:
    """One visitor's time axis; ``height`` in pixels of the plots, and where ``pointed`` is, 0 to 1, to read values."""

    def __init__(self, gui: viser.GuiApi):
        self._gui = gui
        self._box = gui.add_folder(None)
        self._html = gui.add_html("")
        self.height = 62
        self.pointed: float | None = None  # fraction of the axis at the pointer

    def add_plot(self, series: tuple[uplot.Series, ...],
                 bands: tuple[uplot.Band, ...] | None = None) -> viser.GuiUplotHandle:
        """Adds an empty plot without axes; ``series`` begins with the time."""
        nothing: uplot.Axis = {"show": False}
        with self._box:
            self._gui.add_html("<i class='lab-timeline'></i>")
            return self._gui.add_uplot(
                (EMPTY, *(np.full(2, np.nan) for _ in series[1:])), series, legend={"show": False}, bands=bands,
                axes=(nothing, nothing), scales={"x": {"time": False, "range": [0.0, 1.0]}, "y": {"range": [0.0, 1.0]}},
                height=self.height, padding=(2, 0, 0, 0))

    def send(self, said: dict[str, object]) -> None:
        """Sends the browser everything around the curves."""
        text = json.dumps(said, separators=(",", ":"), ensure_ascii=False)
        self._html.content = f"<i class='lab-times' data-said='{escape(text)}'></i>"


def round_ticks(start: float, end: float, unit: float) -> Sequence[float]:
    """Returns the times in s after ``start`` and up to ``end`` at which an axis has ticks: round numbers of units."""
    step = round_up((end - start) / unit / TICKS / 1.0001, (1, 2, 5))[0] * unit
    return [start + k * step for k in range(1, int((end - start) / step * 1.0001) + 1)]
