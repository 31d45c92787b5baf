"""The left panel: numbers of the run and plots over time."""

import json
from dataclasses import asdict
from html import escape

import viser

from app.frame.silences import NO_INDEX, why_no_index
from app.page.controls import Controls
from app.page.features.own.run import JUDGE, OwnRun
from app.page.features.own.words import lines as own_lines
from app.page.features.own.words import readout as own_readout
from app.page.panels.head import MEASUREMENTS_WIDTH
from app.page.panels.plots import LEAST_HEIGHT, Plots
from app.page.panels.readout import LINE, extra_lines, pinned_lines, readout
from app.page.stage.worst import WorstRegions
from app.page.visit.recent import Recent
from app.page.visit.session import Session
from app.page.visit.trace import Traced
from solvers.scene.scene import Scene

READOUT_HEIGHT = 352  # pixels more than the stage that readout, titles and axes need, with one estimator
TRACE_HEADING = 52  # and with a particle traced: the title of its plot
MOST_HEIGHT = 240  # of a plot


class Measurements:
    """Readout and plots of one visitor's session. Call :meth:`refresh` a few times a second."""

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

    def refresh(self, session: Session, controls: Controls, probed: str | None, worst: WorstRegions, recent: Recent,
                traced: Traced | None, presented: bool) -> None:
        """Show what has come in since the last time: the numbers of the frame that is shown, plots of all, or one
        large one if the page is ``presented``."""
        shown, history = recent.shown, session.history
        if shown is None or shown[0].scene != history.scene:
            return
        report = shown[0]
        if report.scene != self._described:
            self._described = report.scene
            self._running.content = f"<i class='lab-scene' data-scene='{escape(json.dumps(asdict(report.scene)))}'></i>"
        quantity, drawn, pinned = controls.quantity, controls.estimators.drawn, session.pinned
        self._readout.content = readout(session, history, report, quantity, drawn, probed, worst, recent.ago)
        # The plots share what the window leaves below the readout.
        left = self._client.camera.image_height - READOUT_HEIGHT - LINE * (
            extra_lines(report, history.series, quantity) + (pinned_lines(pinned, report) if pinned else 0))
        height = left // 3 if traced is None else (left - TRACE_HEADING) // 4
        height = MOST_HEIGHT if presented else max(LEAST_HEIGHT, min(MOST_HEIGHT, height))
        self._plots.have(report.scene.active_estimators, height, traced is not None, pinned is not None)
        if len(history.series.get("time", ())) < 2:
            self._plots.clear()
        else:
            valid, latest = report.valid_estimators, controls.looking.latest
            no_index = why_no_index(report.scene, valid, quantity)
            self._plots.show(history, valid, quantity, no_index, latest, pinned, drawn)
            if traced is not None and traced.scene == history.scene:
                self._plots.show_trace(traced, valid, quantity, latest, report.time)

    def show_own(self, run: OwnRun, k: int, quantity: str, probed: str | None, presented: bool) -> None:
        """Show the numbers of a visitor's own file at its time k, and plots of all its times."""
        self._readout.content = own_readout(run, k, quantity, probed)
        left = self._client.camera.image_height - READOUT_HEIGHT - LINE * own_lines(run, quantity)
        height = MOST_HEIGHT if presented else max(LEAST_HEIGHT, min(MOST_HEIGHT, left // 3))
        self._plots.have((JUDGE,), height, False, False)
        if len(run) < 2 or run.estimate is None:
            self._plots.clear()
        else:
            no_index = "" if run.true is not None else NO_INDEX
            self._plots.show(run, (JUDGE,), quantity, no_index, False, None, JUDGE)
