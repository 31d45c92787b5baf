"""The left panel: numbers of the run and plots over time."""

import json
from dataclasses import asdict, dataclass
from html import escape

import viser

from app.page.panels.head import MEASUREMENTS_WIDTH
from app.page.panels.plots import LEAST_HEIGHT, Past, Plots
from app.page.panels.readout import LINE
from app.page.visit.pinned import PinnedRun
from app.page.visit.trace import Traced
from solvers.scene.scene import Scene

READOUT_HEIGHT = 352  # pixels more than the stage that readout, titles and axes need, with one estimator
TRACE_HEADING = 52  # and with a particle traced: the title of its plot
MOST_HEIGHT = 240  # of a plot


@dataclass(frozen=True)
class Numbers:
    """What is to be read of a run: its ``readout`` as html, which is so many ``lines`` higher than usual, and its
    ``past`` as plots, with a line for each of the ``estimators``, drawn of those that are ``valid``.

    ``drawn`` is the estimator on the stage, at the ``time`` in s; ``no_index`` says why there is no error index. A
    ``pinned`` run is plotted too, and a ``traced`` particle. Whoever reads the page by a program is told the ``scene``.
    """

    readout: str
    lines: int
    past: Past | None
    estimators: tuple[str, ...]
    valid: tuple[str, ...]
    drawn: str | None
    time: float
    no_index: str
    pinned: PinnedRun | None = None
    traced: Traced | None = None
    scene: Scene | None = None


class Measurements:
    """Readout and plots of one visitor. Call :meth:`show` a few times a second."""

    def __init__(self, client: viser.ClientHandle):
        self._client, gui = client, client.gui
        panel = gui.add_panel()
        with panel.add_tab("Measurements", viser.Icon.CHART_LINE) as tab:
            self._readout = gui.add_html("<div class='lab-readout'>waiting for the first frame</div>")
            self._running = gui.add_html("")  # the scene, for whoever reads the page by a program
        self._described: Scene | None = None
        self._plots = Plots(client, tab)
        panel.dock_left()
        panel.set_width(MEASUREMENTS_WIDTH)

    def show(self, numbers: Numbers, quantity: str, latest: bool, presented: bool) -> None:
        """Show numbers, and plots of a quantity's errors or of their ``latest`` periods; one large plot if the page is
        ``presented``."""
        past, traced, scene = numbers.past, numbers.traced, numbers.scene
        if scene is not None and scene != self._described:
            self._described = scene
            self._running.content = f"<i class='lab-scene' data-scene='{escape(json.dumps(asdict(scene)))}'></i>"
        self._readout.content = numbers.readout
        # The plots share what the window leaves below the readout.
        left = self._client.camera.image_height - READOUT_HEIGHT - LINE * numbers.lines
        height = left // 3 if traced is None else (left - TRACE_HEADING) // 4
        height = MOST_HEIGHT if presented else max(LEAST_HEIGHT, min(MOST_HEIGHT, height))
        self._plots.have(numbers.estimators, height, traced is not None, numbers.pinned is not None)
        if past is None or len(past.series.get("time", ())) < 2:
            self._plots.clear()
            return
        self._plots.show(past, numbers.valid, quantity, numbers.no_index, latest, numbers.pinned, numbers.drawn)
        if traced is not None and traced.scene == past.scene:
            self._plots.show_trace(traced, numbers.valid, quantity, latest, numbers.time)
