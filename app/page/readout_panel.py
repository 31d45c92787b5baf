"""Readings of a run: its error over time below the stage, and all further numbers and plots in a folder."""

import json
from dataclasses import asdict, dataclass
from html import escape

import viser

from app.frame.goal_curve import GoalCurve
from app.language.translation import tr
from app.page.panels.error_timeline import ErrorTimeline
from app.page.panels.goal_timeline import GoalTimeline
from app.page.panels.readout_tables import ReadoutTables
from app.page.panels.time_axis import TimeAxis, TimelineState
from app.page.panels.time_plots import TimePlots
from app.page.visit.history import RunSeries
from app.page.visit.pinned_run import PinnedRun
from app.page.visit.traced_particle_series import TracedParticle
from solvers.scene.scene import Scene

PLOT_HEIGHT = 110  # pixels, of a plot in the fold


@dataclass(frozen=True)
class ReadoutContent:
    """Readings of a run: tables (``readout``), and sampled series (``past``) to plot for the ``estimators``, of which
    some are ``valid``.

    ``drawn`` is the estimator on the stage, ``now`` the state of the time axis, ``no_index`` why there is no error
    index, or "". A ``pinned`` run and a ``traced`` particle are plotted too. Programs that read the page get the
    ``scene``. Of a body a ``goal`` is plotted instead of errors."""

    readout: ReadoutTables
    past: RunSeries | None
    estimators: tuple[str, ...]
    valid: tuple[str, ...]
    drawn: str | None
    now: TimelineState
    no_index: str
    pinned: PinnedRun | None = None
    traced: TracedParticle | None = None
    scene: Scene | None = None
    goal: GoalCurve | None = None


class ReadoutPanel:
    """One visitor's numbers and plots below the stage. Call :meth:`show` a few times a second."""

    def __init__(self, client: viser.ClientHandle):
        self._client, gui = client, client.gui
        self._running = gui.add_html("")  # the scene, for programs that read the page
        self._described: Scene | None = None
        self._axis = TimeAxis(gui)
        self.timeline, self._goal = ErrorTimeline(self._axis), GoalTimeline(self._axis)
        self.reading = False  # whether the errors stay in view: in a lesson, or for a file

    def build(self, gui: viser.GuiApi) -> None:
        """Builds the folder of all numbers, before the tabs; the style lays it below them (``css/33-numbers.css``)."""
        gui.add_html(f"<i class='lab-numbers' data-words='{escape(tr('time, energy, steps'))}'></i>")
        fold = gui.add_folder(tr("All numbers of this run"), expand_by_default=False)
        with fold:
            self._readout = gui.add_html(f"<div class='lab-readout'>{tr('waiting for the first frame')}</div>")
        self._plots = TimePlots(self._client, fold)
        gui.add_html("<i class='lab-estimates-foot'></i>")
        self._foot = gui.add_html("")

    def set_timeline_height(self, height: int) -> None:
        """Sets the height of the plot below the stage in pixels."""
        self._axis.height = height

    def set_dark(self, dark: bool) -> None:
        for timeline in (self.timeline, self._goal):
            timeline.set_dark(dark)

    def time_at(self, fraction: float) -> float:
        """Returns the time in s at a fraction, 0 to 1, of the time axis."""
        return (self._goal if self._goal.is_shown else self.timeline).time_at(fraction)

    def show_values_at(self, fraction: float | None) -> None:
        """Shows the curves' values at a fraction, 0 to 1, of the time axis; None for nowhere."""
        self._axis.pointed = fraction

    def show(self, numbers: ReadoutContent, quantity: str, latest: bool) -> None:
        """Shows numbers, and plots of a quantity's errors ("x") over the run or its ``latest`` periods."""
        past, traced, scene = numbers.past, numbers.traced, numbers.scene
        if scene is not None and scene != self._described:
            self._described = scene
            self._running.content = f"<i class='lab-scene' data-scene='{escape(json.dumps(asdict(scene)))}'></i>"
        self._readout.content = numbers.readout.html
        self._foot.content = numbers.readout.errors if self.reading else ""
        if numbers.goal:
            self.timeline.hide()
            self._goal.show(numbers.goal, numbers.now)
            return
        self._goal.hide()
        self.timeline.set_lines(numbers.estimators, numbers.pinned is not None)
        self._plots.set_lines(numbers.estimators, PLOT_HEIGHT, traced is not None, numbers.pinned is not None)
        if past is None or len(past.series.get("time", ())) < 2:
            self.timeline.clear(numbers.now)
            self._plots.clear()
            return
        self.timeline.show(past, numbers.valid, quantity, latest, numbers.pinned, numbers.drawn, numbers.now)
        self._plots.show(past, numbers.valid, quantity, numbers.no_index, latest, numbers.pinned, numbers.drawn)
        if traced is not None and traced.scene == past.scene:
            self._plots.show_trace(traced, numbers.valid, quantity, latest, numbers.now.time)
