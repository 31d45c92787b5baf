"""The parts of one visitor's page that features use."""

from collections.abc import Callable
from pathlib import Path
from typing import Protocol

import viser

from app.classroom.class_context import LecturerContext, LessonContext
from app.frame.colour_scale import ColourScale
from app.language.translation import tr
from app.page.controls import Controls
from app.page.panels.browser_store_and_window import BrowserStore
from app.page.panels.frame_and_drawing_controls import FrameAndTraceControls
from app.page.panels.page_header import PresentationMode, widget_marker_html
from app.page.stage_and_readout_view import StageAndReadoutView
from app.page.viewer_canvas import ViewerCanvas
from app.page.visit.engine_links import PageEngineLinks
from app.page.visit.landscapes import Landscapes
from app.page.visit.recent_frames import RecentFrames
from app.page.visit.run_session import RunSession
from app.page.visit.status_message import Notice
from app.page.visit.traced_particle_series import ParticleTracer
from app.page.visitor_run_source import VisitorRunSource
from app.shareable_state import State
from solvers.engine.engine_messages import FrameReport
from solvers.engine.shared_frames import FrameArrays

LAST = 1e9  # order within the panel, whatever is rebuilt above


class CurrentLesson(Protocol):
    """The lesson that a visitor has open: its ``name`` in links and its ``answers`` as text for the browser to store,
    both "" if none is open. ``go_to_step`` shows a step by its number, in the core (``only``) or in all."""

    @property
    def name(self) -> str: ...

    @property
    def stored_progress(self) -> str: ...

    def open(self, name: str) -> None: ...

    def restore(self, name: str, text: str) -> None: ...

    def go_to_step(self, only: bool, step: int) -> None: ...


class CurrentBody(Protocol):
    """The body from a file that a visitor may have on the stage: whether it ``is_on``."""

    @property
    def is_on(self) -> bool: ...

    def open_file(self, name: str, file: Path) -> None: ...

    def leave(self) -> None: ...


class PageContext:
    """Everything that features share: the visitor's run (``session``), ``stage``, ``controls``, ``tabs``, the
    folder ``own_data`` and more. Features set ``lesson``, ``body``, ``is_touring`` and ``show_phase``, which shows
    a particle's phase (from 1) of one time step in slow motion. The page sets ``show_run_on_stage``, which ends
    whatever replaces the run on the stage, and ``store_state``, which stores the visitor's state in the browser's
    address."""

    show_phase: Callable[[int, int], None]
    show_run_on_stage: Callable[[], None]
    store_state: Callable[[], None]

    def __init__(self, client: viser.ClientHandle, links: PageEngineLinks, classroom: LessonContext,
                 lecturer: LecturerContext | None, opening: State,
                 on_frame: Callable[[FrameReport], None], on_points: Callable[[], None],
                 notice: Callable[[], Notice | None]):
        self.client, self.gui, self.links = client, client.gui, links
        self.classroom, self.lecturer = classroom, lecturer
        self.lesson: CurrentLesson | None = None
        self.body: CurrentBody | None = None
        self.is_touring: Callable[[], bool] = lambda: False
        self._conditions: dict[str, bool] = {}  # for computing frames
        self.recent, self.scale = RecentFrames(), ColourScale()
        self.trace = ParticleTracer(self.recent)
        self.store = BrowserStore(self.gui)
        self.presenter = PresentationMode(self.gui)
        self.canvas = ViewerCanvas(client, self.scale, self.trace, opening.scene.problem)
        self.stage, self._on_frame = StageAndReadoutView(client, self.canvas), on_frame
        self.session = RunSession(links, opening.scene, self._take_frame, opening.speed, opening.stops)
        self.history = FrameAndTraceControls(self.session, self.recent, self.trace, self.stage.draw)
        self._landscapes = Landscapes(self.session, links.histories, on_points)
        self.controls = Controls(self.gui, self.session, self.scale, self.stage.draw, self.history, self.store,
                                 self._landscapes)
        self.run = VisitorRunSource(self.session, self.recent, self.trace, notice, self._landscapes,
                                    self.history.seek)
        group = self.gui.add_tab_group()
        self.tabs = {name: group.add_tab(title, icon) for name, title, icon in (
            ("explore", tr("Explore"), viser.Icon.ADJUSTMENTS_HORIZONTAL),
            ("lessons", tr("Lessons"), viser.Icon.SCHOOL), ("cost", tr("Cost"), viser.Icon.HOURGLASS),
            ("about", tr("About"), viser.Icon.INFO_CIRCLE))}
        with self.tabs["explore"]:
            mark = widget_marker_html("lab-own-data", words=tr("file, link, numbers"))
            self.gui.add_html(mark, order=LAST - 1)
            self.own_data = self.gui.add_folder(tr("Your own data"), order=LAST, expand_by_default=False)

    @property
    def shortcuts(self) -> dict[str, Callable[[], None]]:
        """Actions of keys that belong to no feature, by the names that ``js/keys.js`` sends."""
        controls = self.controls
        return {"judge": controls.stage.next_estimator, "magnify": controls.stage.next_magnification,
                "method": controls.next_method, "present": self.presenter.begin}

    @property
    def lesson_name(self) -> str:
        """The name of the open lesson; "" if none is open."""
        return self.lesson.name if self.lesson else ""

    def set_frame_conditions(self, **conditions: bool) -> None:
        """Computes frames only while all these are true: the browser shows the page (``watched``), it receives in time
        (``keeps_up``), the stage is ``uncovered``. A condition that is not given keeps its value."""
        self._conditions |= conditions
        self.session.set_watched(all(self._conditions.values()))

    def close(self) -> None:
        self._landscapes.close()
        self.session.close()
        self.links.close()

    def _take_frame(self, report: FrameReport, arrays: FrameArrays) -> None:
        """Stores a new frame of the run, draws it and passes it to the features."""
        self.links.frames.add()
        if report.fresh:
            self.scale.begin_run()
        self.recent.add(report, arrays)
        self.trace.on_frame(report, arrays)
        self.stage.draw()
        self._on_frame(report)

    def refresh_and_pause_when_idle(self, idle_seconds: float) -> None:
        """Updates the widgets from the session, and pauses the run after ``idle_seconds`` without input."""
        if self.session.playing and not self.presenter.on and self.session.idle_seconds > idle_seconds:
            self.session.pause_until_return()
        self.controls.refresh()
        if shown := self.recent.shown_frame:
            self.controls.on_frame(*shown)
