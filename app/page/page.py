"""The page: one visitor's stage, panels and session, tied together."""

import secrets
import threading
from time import thread_time

import viser

from app import state
from app.access.log_limit import log_failure
from app.frame.colour_scale import ColourScale
from app.frame.headline import Headline
from app.language.message_translation import translate_message
from app.language.translation import language, tr, with_language
from app.page.canvas import Canvas
from app.page.controls import Controls
from app.page.display_source import Source
from app.page.features.board.panel import BoardPanel, LecturerContext, stage_of
from app.page.features.budget.panel import BudgetFold
from app.page.features.cost.panel import CostTab
from app.page.features.lesson.marking import Classroom
from app.page.features.lesson.panel import Player
from app.page.features.slow_motion import SlowMotion, SlowStep
from app.page.features.upload.panel import UploadPanel
from app.page.headline import HeadlinePanel
from app.page.live_run import LiveRun
from app.page.opening_tour import OPENING, OpeningTour
from app.page.panels.about_tab import add_about
from app.page.panels.browser_store import LETTERS, BrowserStore, LayoutMetrics, Window, follow_keys
from app.page.panels.history_controls import HistoryControls
from app.page.panels.page_header import PresentationMode, ProblemButtons, set_up
from app.page.panels.suggestions import Suggestions
from app.page.readout_panel import Measurements
from app.page.sharing import Sharing, link, parts
from app.page.visit.engine_links import PageLinks
from app.page.visit.frame_buffer import FrameBuffer
from app.page.visit.particle_trace import Trace
from app.page.visit.session import Session
from app.viewer.connection import stands_still
from app.viewer.viser_patches import speak
from app.viewer.widgets import number
from solvers.engine.engine_messages import FrameReport
from solvers.engine.shared_frames import FrameArrays

REFRESH_SECONDS = 0.2  # for numbers, plots and notices; the stage follows every frame
UNTOUCHED = 20 * 60.0  # seconds after which a run rests that nobody asks anything of; a presented one goes on
PATIENCE = 2.0  # seconds in which a browser has to take what is sent, if anything is to be computed for it
RESTING = 12  # times a refresh's work, for each stage that moves, until the next: frames come first


class Page:
    """One client's page. Frames draw on the engine's reader thread. The browser calls it by its ``token``."""

    def __init__(self, client: viser.ClientHandle, pool: PageLinks, classroom: Classroom,
                 lectern: LecturerContext | None = None):
        self.client, self._ready, self._links, self._classroom = client, False, pool, classroom
        self.token, self.language = secrets.token_urlsafe(12), language()
        self._closed, self._drawing, self._refreshing = threading.Event(), threading.Lock(), threading.Lock()
        self._keeping = threading.Lock()
        self._watched = self._takes = True  # the browser shows the page, and takes what is sent to it
        self._stands = threading.Event()  # the frame that has come is the last for now
        speak(client)
        self._recent = FrameBuffer()
        self._trace = Trace(self._recent)
        self._scale = ColourScale()
        set_up(client.gui)
        client.gui.add_html(f"<i class='lab-visitor' data-visitor='{self.token}'></i>")
        self._store = BrowserStore(client.gui)
        self._presenter = PresentationMode(client.gui)
        self._notice, self._speaker = client.gui.add_html(""), HeadlinePanel(client.gui)
        self._canvas = Canvas(client, self._scale, self._trace, OPENING.scene.problem)
        self._measurements = Measurements(client)
        self._session = Session(pool, OPENING.scene, self._on_frame, OPENING.speed, OPENING.stops)
        self._slow = SlowMotion(client, self._canvas, self._session, self._redraw)
        self._own = UploadPanel(client, self._session, self._redraw, self._slow.end,
                            lambda scene: self._controls.load(scene))
        self._tabs(client)
        run = LiveRun(self._session, self._recent, self._trace, self._cost.notice)
        self._sources = self._own, SlowStep(self._slow, run), run  # the first that is on is seen
        self._controls.begin()
        self._sparks = Suggestions(client.gui, self._session, lambda: self._controls.state, self._controls.show,
                              self._looking.back_to)
        self._story = OpeningTour(client.gui, self._session, self._open, self._controls.usual_speed)
        self._store.heard["story"] = self._story.hear
        self._replay.on_click(lambda _: self._story.hear("play"))
        if classroom.lesson:
            self._player.open(classroom.lesson)
        self._window = Window(self._store, self._fit, self._shade)
        self._store.heard["seek"], self._store.heard["read"] = self._seek, self._point
        follow_keys(self._store, {"judge": self._controls.stage.next_judge, "magnify": self._controls.stage.next_factor,
                                  "method": self._controls.next_method, "code": self._sharing.show_code,
                                  "phase": self._slow.forward, "phase back": self._slow.back,
                                  "present": self._presenter.begin})
        self._lectern, self._board, self._covered, self._at = lectern, None, False, ""
        if lectern:
            self._cover(True, 0)
            self._board = BoardPanel(client, self._store, lectern, self._cover)
        self._store.heard["cost"] = self._cost.open
        self._problems = ProblemButtons(client.gui, self._store, self._controls.choose_problem)
        self._store.heard["spark"], self._store.heard["budget"] = self._sparks.press, self._budget.press
        self._store.listen(self._follow_link, self._player.restore)
        self._ready = True
        self._redraw()
        threading.Thread(target=with_language(self._refresh_loop), name="page-refresh", daemon=True).start()

    def attend(self, watched: bool) -> None:
        """The browser shows the page, or no longer: then nothing is computed or sent for it."""
        self._watched = watched
        self._session.attend(watched and self._takes and not self._covered)

    def fall_silent(self) -> None:
        """Nothing is drawn or said from now on."""
        self._closed.set()
        self._stands.set()
        for under_way in (self._drawing, self._refreshing):  # each comes to its end, whatever it does meanwhile
            with under_way:
                pass

    def close(self) -> None:
        """The visitor has gone, or is to see something else."""
        self.fall_silent()
        self._slow.close()
        self._own.close()
        self._player.close()
        self._session.close()
        self._links.close()
        self._cost.jobs.close()
        self._budget.jobs.close()
        if self._board:
            self._board.close()

    def _tabs(self, client: viser.ClientHandle) -> None:
        self._looking = looking = HistoryControls(self._session, self._recent, self._trace, self._redraw)
        self._controls = Controls(client.gui, self._session, self._scale, self._redraw, looking, self._slow,
                                  self._store)
        self._budget = BudgetFold(client.gui, self._session, lambda: self._controls.state, self._controls.show)
        self._measurements.build(client.gui)
        self._controls.open_on(OPENING)
        tabs = client.gui.add_tab_group()
        with tabs.add_tab(tr("Explore"), viser.Icon.ADJUSTMENTS_HORIZONTAL) as explore:
            client.gui.add_html("<div class='lab-sparks-here'></div>")  # on a phone
            self._controls.build(explore)
            self._sharing = Sharing(client.gui, self._store, self._controls)
            self._own.build(client.gui)
        with tabs.add_tab(tr("Lessons"), viser.Icon.SCHOOL) as lessons:
            self._player = Player(client, lessons, self._classroom, self._controls, self._store, self._keep)
        with tabs.add_tab(tr("Cost"), viser.Icon.HOURGLASS):
            self._cost = CostTab(client, self._session, self._controls.load)
        with tabs.add_tab(tr("About"), viser.Icon.INFO_CIRCLE):
            client.gui.add_html("<i class='lab-replay'></i>")
            self._replay = client.gui.add_button(tr("Replay the introduction"),
                                                   hint=tr("the introduction to this page, in four steps"))
            add_about(client.gui)

    def _on_frame(self, report: FrameReport, arrays: FrameArrays) -> None:
        self._links.frames.add()
        if report.fresh:
            self._scale.forget()
        self._recent.add(report, arrays)
        self._trace.follow(report, arrays)
        self._redraw()
        if not report.playing:
            self._stands.set()
        if self._ready:
            self._slow.follow(report)
            self._own.follow()
            self._cost.follow(report, self._session.history)

    def _open(self) -> None:
        """Puts the opening on the stage, without new widgets if nothing has been changed: they would take long."""
        session = self._session
        if self._controls.state == OPENING and session.playing and not session.refused:
            session.reset()
        else:
            self._controls.show(OPENING)

    def _follow_link(self, link: str) -> None:
        """Show what the address says; what it cannot mean is refused in words."""
        lesson, text = parts(link)
        with self._store.keep_after():
            if lesson:
                self._player.open(lesson)
            try:
                if text:
                    self._controls.show(state.read(text))
            except state.StateError as error:
                self._session.refuse(tr("The link cannot be followed: {reason}", reason=translate_message(str(error))))

    def _keep(self) -> None:
        """Have the browser keep what is seen: in its address, and the answers to a lesson."""
        with self._keeping:  # else a refresh could put what was before in the place of what is
            lesson = self._player.name
            self._store.keep(link(self._controls.state, lesson), lesson, self._player.answers)

    @property
    def _source(self) -> Source:
        """What is on the stage now."""
        return next(source for source in self._sources if source.on)

    def _redraw(self) -> None:
        if not self._ready or self._closed.is_set():
            return
        with self._drawing:
            choice = self._controls.choice
            if (sight := self._source.sight(choice)) is not None:
                self._canvas.draw(sight, choice)

    def _fit(self, size: LayoutMetrics) -> None:
        """The window is another one."""
        self._measurements.timeline.height = max(20, round(size.plot_height))
        if self._canvas.lettering.fit(size.width, size.height, size.left, size.letters / LETTERS):
            self._redraw()

    def _shade(self, dark: bool) -> None:
        """The window is to be dark, or light."""
        set_up(self.client.gui, dark)
        self._canvas.shade(dark)
        self._measurements.timeline.shade(dark)
        self._redraw()

    def _cover(self, covered: bool, step: int) -> None:
        """The board covers the stage, where nothing need move then; or lets it be seen, at this step of the lesson."""
        self._covered = covered
        self.attend(self._watched)
        if self._lectern and not covered:
            self._presenter.begin()
            self._player.turn(self._lectern.board.core, step)
            if (stage := stage_of(self._lectern.board, step)) != self._at:
                self._at = stage
                self._controls.show(state.read(stage))

    def _point(self, said: object) -> None:
        """The visitor reads the curves over time at a part of their axis, or no longer."""
        self._measurements.timeline.point(float(said) if number(said, 0, 1) else None)  # type: ignore[arg-type]

    def _seek(self, said: object) -> None:
        """The visitor has pointed at a place of the plot over time, a part of its axis."""
        if number(said, 0, 1) and self._source.at_once is False:
            assert isinstance(said, float | int)
            self._looking.seek(self._measurements.timeline.time_at(said))

    def _refresh_loop(self) -> None:
        """Refresh now and then, and soon when the stage has come to a stand: what is said goes with what is seen."""
        rest = 0.0
        while not self._closed.wait(REFRESH_SECONDS):
            self._stands.wait(rest)
            self._stands.clear()
            begun = thread_time()
            if (takes := stands_still(self.client) < PATIENCE) != self._takes:
                self._takes = takes
                self.attend(self._watched)
            try:
                with self._refreshing:
                    if self._session.watched and not self._closed.is_set():
                        self._refresh()
            except Exception as error:  # one bad refresh must not silence the page for the rest of the visit
                log_failure("the page could not be refreshed", error)
            rest = max(0.0, RESTING * self._links.playing * (thread_time() - begun) - REFRESH_SECONDS)

    def _refresh(self) -> None:
        source, choice, canvas, presented = self._source, self._controls.choice, self._canvas, self._presenter.on
        if numbers := source.numbers(choice, canvas.picture, canvas.probe.text):
            self._measurements.reading = bool(self._player.name) or self._own.shown is not None
            self._controls.judges.show(numbers.readout.judged)
            self._measurements.show(numbers, choice.quantity, choice.latest)
            self._budget.show(numbers, choice, bool(self._player.name))
        if self._session.playing and not presented and self._session.untouched > UNTOUCHED:
            self._session.rest()
        notice = self._own.notice() or source.notice()
        self._notice.content = "" if notice is None else notice.html
        if canvas.picture is not None:
            told = self._story.said(self._recent.shown) if isinstance(source, LiveRun) else Headline()
            self._speaker.say(told or source.sentence(choice, canvas.picture), source.at_once)
        self._presenter.name(self._session.scene)
        mine = isinstance(source, LiveRun) and not self._player.name
        self._story.follow(mine)
        self._sparks.refresh(mine and not self._story.beat)
        self._controls.refresh()
        if shown := self._recent.shown:
            self._controls.hear(*shown)
        self._problems.show(self._session.scene.problem, bool(self._controls.problem.visible))
        self._keep()
        self._cost.refresh()
        canvas.camera.settle()
