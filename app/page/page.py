"""The page: one visitor's stage, panels and session, tied together."""

import logging
import secrets
import threading
from html import escape
from time import monotonic, thread_time

import numpy as np
import viser

from app.drawing import RECTANGLE, ColourBar, enlarge
from app.frame.view import View, look
from app.page.controls import Controls
from app.page.features.cost.panel import CostTab
from app.page.features.lesson.classroom import Classroom
from app.page.features.lesson.panel import Player
from app.page.features.own.panel import OwnCode
from app.page.features.own.run import OwnRun
from app.page.features.own.words import sentence as said_of_file
from app.page.features.slow.panel import SlowMotion
from app.page.measurements import Measurements
from app.page.panels.head import add_head, set_up
from app.page.panels.keeper import BrowserStore, Hooks
from app.page.panels.looking import Looking
from app.page.panels.presenter import ENLARGED, Presenter
from app.page.panels.texts import add_about
from app.page.sharing import Sharing, link, parts
from app.page.stage.camera import FlatCamera
from app.page.stage.mark import Mark
from app.page.stage.probe import Probe
from app.page.stage.worst import WorstRegions
from app.page.summary import Pace, compared, summary
from app.page.visit.pinned import PinnedRun
from app.page.visit.recent import Recent
from app.page.visit.session import FIRST_SCENE, PageLinks, Session
from app.page.visit.trace import Trace
from app.problems.stage import Stage
from app.problems.views import VIEWS
from app.scale import LEAST_TOP, ColourScale
from app.state import StateError
from app.state import read as read_state
from app.words import QUANTITIES, differing
from solvers.engine.frames import FrameArrays
from solvers.engine.messages import FrameReport
from solvers.scene.scene import Scene

ROOMY, LEAST_TEXT = 470, 0.58  # pixels for a length of one on the stage below which its text shrinks, and how far
REFRESH_SECONDS = 0.2  # for numbers, plots and notices; the stage follows every frame
UNTOUCHED = 20 * 60.0  # seconds after which a run rests that nobody asks anything of; a presented one goes on
RESTING = 12  # times a refresh's work, for each stage that moves, until the next: frames come first


class Page:
    """Private to one client. Frames draw on the engine's reader thread, the rest on a thread of its own. The browser
    calls it by its ``token`` (``attendance.js``)."""

    def __init__(self, client: viser.ClientHandle, pool: PageLinks, classroom: Classroom):
        self.client, self._ready, self._links, self._classroom = client, False, pool, classroom
        self.token = secrets.token_urlsafe(12)
        self._closed, self._drawing, self._refreshing = threading.Event(), threading.Lock(), threading.Lock()
        self._keeping = threading.Lock()
        self._stands = threading.Event()  # the frame that has come is the last for now
        self._recent = Recent()
        self._trace = Trace(self._recent)
        self._seen: tuple[FrameReport, FrameArrays, View] | None = None  # what is drawn
        self._shown: tuple[str, str | None, bool] | None = None  # quantity, estimator, and whether it is compared
        self._scale = ColourScale()
        set_up(client.gui)
        add_head(client.gui)
        client.gui.add_html(f"<i class='lab-visitor' data-visitor='{self.token}'></i>")
        self._keeper = BrowserStore(client.gui)
        self._presenter = Presenter(client.gui)
        self._notice, self._says, self._pace = client.gui.add_html(""), client.gui.add_html(""), Pace()
        client.scene.set_background_image(np.full((2, 2, 3), 255, np.uint8), format="png")
        self._colour_bar = ColourBar(client.scene, self._scale)
        self._stages = {problem: view.stage(client, self._scale) for problem, view in VIEWS.items()}
        self._show_stage(FIRST_SCENE.problem)
        self._camera = FlatCamera(client, RECTANGLE)
        self._probe = Probe(client, self._camera)
        self._mark = Mark(client, self._trace)
        self._worst = WorstRegions()
        self._measurements = Measurements(client)
        self._session = Session(pool, FIRST_SCENE, self._on_frame)
        self._slow = SlowMotion(client, self._session, self._redraw)
        self._own = OwnCode(client, self._session, self._redraw, self._slow.end)
        self._tabs(client)
        self._controls.begin()
        if classroom.lesson:
            self._player.open(classroom.lesson)
        self._keeper.listen(Hooks(self._follow_link, self._player.restore))
        self._ready = True
        self._redraw()
        threading.Thread(target=self._refresh_loop, name="page-refresh", daemon=True).start()

    def attend(self, watched: bool) -> None:
        """The browser shows the page, or no longer: then nothing is computed or sent for it."""
        self._session.attend(watched)

    def close(self) -> None:
        """The visitor has gone, or is to see something else: nothing is drawn or said any more."""
        self._closed.set()
        self._stands.set()
        for under_way in (self._drawing, self._refreshing):  # each comes to its end, whatever it does meanwhile
            with under_way:
                pass
        self._slow.close()
        self._own.close()
        self._player.close()
        self._session.close()
        self._cost.jobs.close()

    def _tabs(self, client: viser.ClientHandle) -> None:
        tabs = client.gui.add_tab_group()
        with tabs.add_tab("Explore", viser.Icon.ADJUSTMENTS_HORIZONTAL) as explore:
            looking = Looking(self._session, self._recent, self._trace, self._redraw)
            self._controls = Controls(client.gui, explore, self._session, self._scale, self._redraw, looking,
                                      self._slow)
            Sharing(client.gui, self._keeper, self._controls)
            self._own.build(client.gui)
        with tabs.add_tab("Lessons", viser.Icon.SCHOOL) as lessons:
            self._player = Player(client, lessons, self._classroom, self._controls.show, self._controls.offer,
                                  self._keep)
        with tabs.add_tab("Cost", viser.Icon.HOURGLASS):
            self._cost = CostTab(client, self._session, self._controls.load)
        with tabs.add_tab("About", viser.Icon.INFO_CIRCLE):
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

    def _follow_link(self, link: str) -> None:
        """Show what the address says; what it cannot mean is refused in words."""
        lesson, text = parts(link)
        if lesson:
            self._player.open(lesson)
        if not text:
            return
        try:
            self._controls.show(read_state(text))
        except StateError as error:
            self._session.refuse(f"The link cannot be followed: {error}")

    def _keep(self) -> None:
        """Have the browser keep what is seen: in its address, and the answers to a lesson."""
        with self._keeping:  # else a refresh could put what was before in the place of what is
            lesson = self._player.name
            self._keeper.keep(link(self._controls.state, lesson), lesson, self._player.answers)

    def _show_stage(self, problem: str | None) -> None:
        """Show one of them, or none."""
        self._colour_bar.root.visible = problem is not None
        for name, stage in self._stages.items():
            stage.root.visible = name == problem

    def _redraw(self) -> None:
        if not self._ready or self._closed.is_set():
            return
        with self._drawing:
            if own := self._own.shown:
                self._draw_own(*own)
                return
            if (last := self._recent.shown) is None:
                return
            (report, arrays), back = last, self._recent.back
            scene, controls, choice = report.scene, self._controls, self._controls.estimators
            view = look(report, arrays, controls.quantity, choice.drawn, choice.difference)
            if choice.difference and scene.has("truth") and scene.active_estimators \
                    and not (report.holds.differences or back):
                return  # the frame is one from before they were asked for; the next is on its way
            shown = controls.quantity, choice.drawn, choice.difference
            if changed := shown != self._shown:
                self._scale.forget()
                self._shown = shown
            pinned = self._session.pinned
            if pinned and pinned.scene.problem != scene.problem:
                pinned = None  # it goes with the next frame
            beside = pinned.view(controls.quantity, choice.drawn, choice.difference) if pinned else None
            if changed or not back:  # looking back keeps the colours, to compare frames by
                self._scale.follow(view.left.sizes, view.right.sizes, report.time / scene.period,
                                   (beside.left.sizes, beside.right.sizes) if beside else (None, None),
                                   0.0 if scene.swings else LEAST_TOP * scene.size_of(controls.quantity))
            stage = self._stages[scene.problem]
            second = stage.pair(pinned is not None)
            stage.domains, stage.plotted, stage.magnified = controls.domains, report.holds.plotted, controls.magnified
            with self.client.atomic():
                self._show_stage(None if self._slow.showing else scene.problem)
                stage.draw(scene, arrays, view.left.sizes, view.right.sizes, report.time,
                           self._session.speed * scene.period)
                stage.caption(view.left, view.right)
                stage.name(f"this run: {differing(scene, pinned.scene)}".removesuffix(": ") if pinned else "")
                if pinned and second:
                    self._draw_pinned(pinned, second, beside, scene)
                self._mark.look(stage, arrays)
                self._colour_bar.draw(view.measures, QUANTITIES[controls.quantity].unit)
                self.client.flush()  # else it waits a frame's time for more, and the next frame replaces this one
            self._camera.show(RECTANGLE if self._slow.showing else stage.rectangle)
            self._probe.look(stage, arrays, view.estimated, view.true, QUANTITIES[controls.quantity].unit)
            self._seen = report, arrays, view

    def _draw_own(self, run: OwnRun, k: int) -> None:
        """A frame of a visitor's own file; its colours are those of all its times."""
        quantity, stage = self._controls.quantity, self._stages[run.scene.problem]
        (report, arrays), unit = run.frame(k, quantity, self._own.playing), QUANTITIES[quantity].unit
        view = run.view(arrays, quantity, self._controls.estimators.difference)
        self._scale.forget()
        self._scale.follow(*run.largest(quantity), 0.0)
        self._shown = None
        stage.pair(False)
        stage.domains, stage.plotted, stage.magnified = False, quantity, self._controls.magnified
        with self.client.atomic():
            self._show_stage(run.scene.problem)
            stage.draw(run.scene, arrays, view.left.sizes, view.right.sizes, report.time, 1.0, foreign=True)
            stage.caption(view.left, view.right)
            stage.name("")
            self._mark.hide()
            self._colour_bar.draw(view.measures, unit)
            self.client.flush()
        self._camera.show(stage.rectangle)
        self._probe.look(stage, arrays, view.estimated, view.true, unit)
        self._seen = report, arrays, view

    def _draw_pinned(self, pinned: PinnedRun, stage: Stage, view: View | None, other: Scene) -> None:
        """A pinned run beside an ``other`` one, or before its first frame that there will be one."""
        scene, live = pinned.scene, self._stages[pinned.scene.problem]
        said = f"pinned: {differing(scene, other) or 'the same so far'}"
        if view is None or pinned.last is None:
            stage.name(f"{said}, being prepared")
            return
        report, arrays = pinned.last
        stage.domains, stage.plotted, stage.magnified = live.domains, report.holds.plotted, live.magnified
        stage.draw(scene, arrays, view.left.sizes, view.right.sizes, report.time, self._session.speed * scene.period)
        stage.caption(view.left, view.right)
        stage.name(said)

    def _refresh_loop(self) -> None:
        """Refresh now and then, and soon when the stage has come to a stand: what is said goes with what is seen."""
        rest = 0.0
        while not self._closed.wait(REFRESH_SECONDS):
            self._stands.wait(rest)
            self._stands.clear()
            begun = thread_time()
            try:
                with self._refreshing:
                    if self._session.watched and not self._closed.is_set():
                        self._refresh()
            except Exception:  # one bad refresh must not silence the page for the rest of the visit
                logging.getLogger(__name__).exception("the page could not be refreshed")
            rest = max(0.0, RESTING * self._links.playing * (thread_time() - begun) - REFRESH_SECONDS)

    def _refresh(self) -> None:
        own = self._own.shown
        if own:
            self._measurements.show_own(*own, self._controls.quantity, self._probe.text, self._presenter.on)
        else:
            if self._seen is not None:
                self._worst.look(*self._seen)
            self._measurements.refresh(self._session, self._controls, self._probe.text, self._worst, self._recent,
                                       self._trace.traced, self._presenter.on)
        if self._session.playing and not self._presenter.on and self._session.untouched > UNTOUCHED:
            self._session.rest()
        notice = self._own.notice() or (None if own else self._session.notice() or self._cost.notice())
        self._notice.content = "" if notice is None else (
            f"<div class='lab-notice lab-{notice.kind}' role='status'>"
            f"{escape(notice.sentence[:1].upper() + notice.sentence[1:])}</div>")
        self._camera.leave(0.0 if notice is None or notice.kind == "wait" else notice.height(self._camera.width))
        self._say()
        self._controls.refresh()
        self._keep()
        self._cost.refresh()
        self._camera.settle()
        largest = ENLARGED if self._presenter.on else 1.0
        enlarge(self.client.scene, max(LEAST_TEXT, min(largest, self._camera.scale / ROOMY)))

    def _say(self) -> None:
        """Say what is seen, now and then; that there is something to see lifts the page's ground (``ground.html``)."""
        controls, seen = self._controls, self._seen
        slow, pinned, history = self._slow.sentence, self._session.pinned, self._session.history
        if (own := self._own.shown) and seen is not None and seen[0].scene == own[0].scene:
            worst = WorstRegions()  # of this frame: at another time a file may have other particles
            worst.look(*seen)
            sentence = said_of_file(*own, seen[2], worst, controls.quantity)
            self._show_sentence(sentence, at_once=not self._own.playing)
            return
        if seen is None or not history.scene == seen[0].scene == self._worst.scene:
            return  # nothing is drawn yet, or another run has begun just now
        beside = compared(history.latest, pinned.history.latest, controls.quantity) if pinned else ""
        sentence = slow or summary(*seen, self._worst, history.series, controls.quantity,
                                   controls.estimators.drawn, self._recent.ago, beside)
        self._show_sentence(sentence, bool(slow))

    def _show_sentence(self, sentence: str, at_once: bool) -> None:
        if self._pace.lets(sentence, monotonic(), at_once):
            said = escape(sentence).replace("–", "–&NoBreak;")  # no line ends between "0.25–" and "0.30"
            self._says.content = f"<i class='lab-says' data-sentence=\"{said}\"></i>"
