"""The page of one visitor: forwards frames, refreshes numbers and texts, and closes; its features do the rest."""

import secrets
import threading
from time import monotonic, thread_time

import viser

from app.access.rate_limited_log import log_failure
from app.classroom.class_context import LecturerContext, LessonContext
from app.frame.headline import HeadlineWithFacts
from app.language.translation import current_language, with_language
from app.page.feature import Feature, VisiblePageState
from app.page.features import all_features
from app.page.features.opening_tour import OPENING, QUARTER
from app.page.features.sharing import BrowserAddress, linked_state
from app.page.page_context import PageContext
from app.page.panels.about_tab import add_about
from app.page.panels.browser_store_and_window import follow_keys, parse_message
from app.page.panels.page_header import ProblemButtons, set_up_theme
from app.page.visit.engine_links import PageEngineLinks
from app.viewer.browser_connection import stalled_seconds
from app.viewer.viser_patches import set_callback_language
from solvers.engine.engine_messages import FrameReport

REFRESH_SECONDS = 0.2  # for numbers, plots and notices; the stage follows every frame
LEAST_SECONDS = 0.05  # between two refreshes, of which the second shows what has come of a run at rest
UNTOUCHED = 20 * 60.0  # idle seconds after which a run pauses, unless it is presented
PATIENCE = 2.0  # seconds of send delay after which nothing more is computed for a browser
RESTING = 18  # pause until the next refresh, in times its work per running stage: frames come first


class Page:
    """Page of one browser (``client``), which requests name by the page's random ``token``; ``first`` is the message
    that came with the request for it. Frames are drawn on the thread that reads them from the engine; numbers and texts
    follow a few times a second."""

    def __init__(self, client: viser.ClientHandle, links: PageEngineLinks, classroom: LessonContext,
                 lecturer: LecturerContext | None = None, first: str = ""):
        self.client, self._links, self._features = client, links, tuple[Feature, ...]()
        self.token, self.language = secrets.token_urlsafe(12), current_language()
        self._closed, self._refreshing = threading.Event(), threading.Lock()
        self._wake, self._at_once = threading.Event(), False  # whether a run at rest has news, and whether a new frame
        said = parse_message(first)
        opening = linked_state(said.get("link")) or OPENING
        set_callback_language(client)
        set_up_theme(client.gui)
        client.gui.add_html(f"<i class='lab-visitor' data-visitor='{self.token}'></i>")
        self._context = context = PageContext(
            client, links, classroom, lecturer, opening, self._on_frame, self._wake.set,
            lambda: next(filter(None, (feature.notice() for feature in self._features)), None))
        self._link = BrowserAddress(context)
        context.store_state, context.show_run_on_stage = self._link.keep, self._show_run_on_stage
        built = tuple(filter(None, (feature.build(context) for feature in all_features.FEATURES)))
        context.stage.build(context.store)
        controls = context.controls
        controls.set_initial_state(opening)
        if opening is OPENING:
            context.session.reset(QUARTER)
        with context.tabs["explore"] as explore:
            controls.build(explore)
        with context.tabs["about"]:
            add_about(client.gui)
        controls.enable_problem_choice()
        if classroom.lesson and context.lesson:
            context.lesson.open(classroom.lesson)
        keys = context.shortcuts
        for part in built:
            context.store.heard |= part.messages
            keys |= part.shortcuts
        follow_keys(context.store, keys)
        self._problems = ProblemButtons(client.gui, context.store, self._choose_problem)
        self._link.listen(said)
        self._features = built  # from now on they follow frames
        context.stage.begin(lambda: controls.choice, (*filter(None, (part.source for part in built)), context.run))
        threading.Thread(target=with_language(self._refresh_loop), name="page-refresh", daemon=True).start()

    def set_watched(self, watched: bool) -> None:
        """Computes and sends frames only while the browser shows the page (``watched``)."""
        self._context.set_frame_conditions(watched=watched)

    def stop_output(self) -> None:
        """Ends all drawing and messages to the browser; returns when a refresh in progress is complete."""
        self._closed.set()
        self._wake.set()
        self._context.stage.stop()
        with self._refreshing:  # it comes to its end
            pass

    def close(self) -> None:
        """Closes the features and the visitor's session, when the visitor leaves or gets another page."""
        self.stop_output()
        for feature in self._features:
            feature.close()
        self._context.close()

    def _show_run_on_stage(self) -> None:
        for feature in self._features:
            feature.leave_stage()

    def _choose_problem(self, problem: str) -> None:
        if self._context.body:
            self._context.body.leave()
        self._context.controls.choose_problem(problem)

    def _on_frame(self, report: FrameReport) -> None:
        if not report.playing:  # it is the last for now
            self._at_once = True
            self._wake.set()
        for feature in self._features:
            feature.on_frame(report)

    def _refresh_loop(self) -> None:
        """Refreshes numbers and texts periodically, and at once for a run at rest, until the page is closed. Of new
        points of a landscape only the strips follow at once."""
        due = last = 0.0
        while not self._closed.is_set():
            has_news = self._wake.wait(REFRESH_SECONDS)
            self._closed.wait(max(0.0, last + LEAST_SECONDS - monotonic()))
            self._context.set_frame_conditions(keeps_up=stalled_seconds(self.client) < PATIENCE)
            self._wake.clear()
            whole, self._at_once = self._at_once or monotonic() > due, False
            if not (whole or has_news):
                continue
            last, begun = monotonic(), thread_time()
            try:
                with self._refreshing:
                    if self._context.session.watched and not self._closed.is_set():
                        if whole:
                            self._refresh()
                        else:
                            self._context.controls.strips.refresh()
            except Exception as error:  # one bad refresh must not silence the page for the rest of the visit
                log_failure("the page could not be refreshed", error)
            if whole:
                rest = RESTING * self._links.playing * (thread_time() - begun)
                due = last + max(rest, REFRESH_SECONDS - LEAST_SECONDS)

    def _refresh(self) -> None:
        context, controls = self._context, self._context.controls
        choice, in_lesson, on_stage = controls.choice, bool(context.lesson_name), context.stage.source is context.run
        if numbers := context.stage.read_numbers(choice):
            controls.estimator_cards.fill_cards(numbers.readout.cards_json)
        headline = next(filter(None, (feature.headline(context.recent.shown_frame) for feature in self._features)),
                        HeadlineWithFacts()) if on_stage or context.is_touring() else HeadlineWithFacts()
        if context.store.has_answered:  # else it may ask for something else than what is there at first
            context.stage.refresh(choice, numbers, in_lesson, headline)
        view = VisiblePageState(choice, numbers, in_lesson, on_stage and not in_lesson)
        for feature in self._features:
            feature.refresh(view)
        context.refresh_and_pause_when_idle(UNTOUCHED)
        has_body = context.body is not None and context.body.is_on
        self._problems.show(context.session.scene, bool(controls.problem.visible), has_body)
        self._link.keep()
