"""The opening tour: in 22 s from a bar in pieces to two runs of it, in four steps with the runs' own numbers."""

import math
import threading
from collections.abc import Callable
from dataclasses import replace
from time import monotonic, thread_time
from typing import Any

import numpy as np

from app.access.rate_limited_log import log_failure
from app.frame.headline import HeadlineWithFacts
from app.language.translation import tr, with_language
from app.names_and_units import per_cent
from app.page.feature import Feature, VisiblePageState
from app.page.page_context import PageContext
from app.page.playback_controls import SLOW
from app.page.stage_source import StageContent, ViewChoice
from app.page.visit.recent_frames import Frame
from app.page.visit.status_message import Notice
from app.page.visitor_run_source import VisitorRunSource
from app.problems.bar.field_over_stage import FieldOverStage
from app.problems.bar.stretching_bar import StretchingBar
from app.shareable_state import State
from solvers.problems.bar.scene import BarScene
from solvers.solver import samples

#: Seconds of each step: the bar in pieces, slow motion of hat functions, their errors, B-splines beside them.
SECONDS = {1: 5.5, 2: 6.5, 3: 5.0, 4: 5.0}
LAST = 4
#: In periods: where slow motion begins, shortly before the first particle changes its cell, and where it stops: at a
#: quarter, where hat functions are most wrong. At larger amplitudes all particles cross repeatedly, and those that
#: crossed err no more than the others.
BEFORE_CROSSING, QUARTER = 0.172, 0.25
STILL = 0.5  # seconds after its start at which the bar in pieces is stretched most
TICK, SHARE = 0.04, 8  # seconds between two pictures; in times what drawing one takes, if that is longer
SIGMA = samples.QUANTITIES.index("sigma")

BAR = BarScene(method="mpm", amplitude=0.0034, periods=QUARTER, estimators=("recovered",))
BESIDE = replace(BAR, method="bspline")
#: The state of a page without a link, from a quarter of the period on: hat functions beside B-splines.
OPENING = State(BAR, "sigma", speed=SLOW, compared=BESIDE.method)


class OpeningTour(Feature):
    """One visitor's tour of the page: ``beat`` is its step, 1 to 4, and 0 outside it. ``story.js`` starts it, lets it
    wait for a button at each step if its visitor wants no motion, and ends it. ``clock`` returns seconds."""

    def __init__(self, page: PageContext, clock: Callable[[], float] = monotonic):
        self._page, self._session, self._clock = page, page.session, clock
        self._mark = page.gui.add_html("")
        self.messages = {"story": self.on_message}
        self.source = OpeningSource(self, page.run)
        self.beat, self._since, self._waits, self._restarts = 0, 0.0, False, 0
        self._moves_since = 0.0  # of the bar in pieces
        self._turn, self._over = threading.RLock(), threading.Event()
        self._bar = StretchingBar(page.canvas.add_surface("/opening-bar"), BAR)
        self._field = FieldOverStage(page.canvas.add_surface("/opening-field"))

    @classmethod
    def build(cls, page: PageContext) -> "OpeningTour":
        tour = cls(page)
        page.is_touring = lambda: tour.beat > 0
        with page.tabs["about"]:
            page.gui.add_html("<i class='lab-replay'></i>")
            hint = tr("the introduction to this page, in four steps")
            replay = page.gui.add_button(tr("Replay the introduction"), hint=hint)
        replay.on_click(lambda _: tour.on_message("play"))
        return tour

    def on_message(self, message: Any) -> None:
        """Starts the tour at the browser's message "play", or at "stills" with steps that wait for "next"; "skip" ends
        it. Ignores others."""
        with self._turn:
            if message in ("play", "stills"):
                self._begin(waits=message == "stills")
            elif message == "next" and self.beat and self._waits:
                self._go_on()
            elif message == "skip" and self.beat:
                self._land()

    def refresh(self, view: VisiblePageState) -> None:
        """Goes on to the tour's next step when it is time; ends the tour if anything else takes the stage."""
        session = self._session
        with self._turn:
            if not self.beat:
                return
            if view.in_lesson or session.playback_request_key[1] != self._restarts:  # replaced by something else
                self._end()
            elif session.scene != BAR or session.pinned is None or session.pinned.scene != BESIDE:
                self._end()  # a control was moved
                session.play(True)
            elif not self._waits and self._clock() > self._since + SECONDS[self.beat] and self._is_ready:
                self._go_on()
            elif self.beat == 2 and session.playing and self._periods >= QUARTER:
                self._restart(QUARTER, playing=False)

    def headline(self, frame: Frame | None) -> HeadlineWithFacts:
        """Returns the headline of the tour's present step for a ``frame`` of the run; an empty one outside it."""
        beside = self._session.pinned.last if self._session.pinned else None
        said = _beat_headline(self.beat, frame, beside) if self.beat else HeadlineWithFacts()
        return replace(said, moment=("beat", self.beat))

    def close(self) -> None:
        """Ends the drawing thread when the visitor leaves."""
        self._over.set()

    @property
    def _is_ready(self) -> bool:
        """Whether the runs have the frames that the next step shows."""
        report, pinned = self._session.report, self._session.pinned
        return report is not None and report.scene == BAR and \
            (self.beat != LAST - 1 or (pinned is not None and pinned.last is not None))

    @property
    def _periods(self) -> float:
        report = self._session.report
        return report.time / report.scene.period if report else 0.0

    def _begin(self, waits: bool) -> None:
        shown, drawing, now = self._page.controls.state, self.beat in (1, 2), self._clock()
        if (shown.scene, shown.compared, shown.speed) != (BAR, OPENING.compared, SLOW) or self._session.refused:
            self._page.controls.show(OPENING)  # rebuilds widgets, which is slow
        if self.beat != 1:  # the browser asks again once it shows the first picture, which goes on
            self._moves_since = now
        self._waits, self.beat, self._since = waits, 1, now
        self._restart(QUARTER if waits else BEFORE_CROSSING, playing=False)
        self._show()
        if not drawing:
            threading.Thread(target=with_language(self._draw_loop), name="opening-tour", daemon=True).start()

    def _go_on(self) -> None:
        if self.beat == LAST:
            return self._land()
        self.beat, self._since = self.beat + 1, self._clock()
        if self.beat == 2 and not self._waits:
            self._session.play(True)
        elif self.beat == 3 and self._session.playing:  # slower than was asked for
            self._restart(QUARTER, playing=False)
        self._show()

    def _land(self) -> None:
        """Ends the tour with both runs on the stage, at a quarter of the period, from which they go on unless motion is
        unwanted."""
        self._end()
        self._restart(QUARTER, playing=not self._waits)

    def _restart(self, periods: float, playing: bool) -> None:
        self._session.reset(periods, playing=playing)
        self._restarts = self._session.playback_request_key[1]

    def _end(self) -> None:
        self.beat = 0
        self._show()

    def _show(self) -> None:
        """Tells the browser the step, and uncovers the stage from the third on."""
        seconds = 0 if self._waits else SECONDS.get(self.beat, 0)
        self._mark.content = f"<i class='lab-story' data-beat='{self.beat}' data-seconds='{seconds}'></i>"
        if self.beat not in (1, 2):
            self._bar.sheet.visible = self._field.sheet.visible = False
            self._page.stage.draw()

    def _draw_loop(self) -> None:
        """Draws what covers the stage in the first two steps."""
        rest = 0.0
        while not self._over.wait(rest) and self.beat in (1, 2):
            begun = thread_time()
            try:
                with self._turn:
                    self._draw_cover()
            except Exception as error:  # one bad picture must not end the tour
                log_failure("the opening could not be drawn", error)
            rest = max(TICK, SHARE * (thread_time() - begun))

    def _draw_cover(self) -> None:
        """Draws the bar in pieces in the first step, and in the second the field of the run's frame."""
        frame, page = self._page.recent.shown_frame, self._page
        if not self._session.watched:
            return
        with page.client.atomic():
            if self.beat == 1:
                rectangle = self._bar.draw(STILL if self._waits else self._clock() - self._moves_since)
            elif self.beat == 2 and frame is not None and frame[0].scene == BAR:
                rectangle = self._field.draw(BAR, *frame)
            else:
                return
            self._bar.sheet.visible, self._field.sheet.visible = self.beat == 1, self.beat == 2
            page.canvas.cover(rectangle)
            page.client.flush()


class OpeningSource:
    """Source for the stage in the tour's first three steps: nothing while a picture of the ``tour`` covers it, then the
    visitor's run alone, whose source is ``run``."""

    needs_immediate_headline = False

    def __init__(self, tour: OpeningTour, run: VisitorRunSource):
        self._tour, self._run = tour, run
        self.numbers, self.sentence, self.seek = run.numbers, run.sentence, run.seek

    @property
    def is_on(self) -> bool:
        return self._tour.beat in (1, 2, 3)

    def stage_content(self, choice: ViewChoice) -> StageContent | None:
        if self._tour.beat != 3 or (sight := self._run.stage_content(choice)) is None:
            return None
        title = *sight.picture.title[:2], ()  # without what it is compared with
        return replace(sight, picture=replace(sight.picture, title=title), beside=None)

    def notice(self) -> Notice | None:
        """Returns None: what the runs wait for is not to be seen yet."""
        return None


def _beat_headline(beat: int, frame: Frame | None, beside: Frame | None) -> HeadlineWithFacts:
    """Returns the headline and fact of the tour's step ``beat``, with numbers of the run's ``frame`` and of that of the
    run ``beside`` it; an empty one without the frames that it needs."""
    if beat == 1:
        return HeadlineWithFacts.from_template(tr("A bar, cut into particles."), tr(
            "A computer moves them through a fixed grid, step by step: the Material Point Method, MPM."))
    if beat == 2:
        return HeadlineWithFacts.from_template(tr("Watch particles change cell. The stress jumps off the line."), tr(
            "Slow motion. Blue is the exact stress, black is what MPM (with hat functions) computes for it."))
    if frame is None or frame[0].scene != BAR:
        return HeadlineWithFacts()
    if beat == 3:
        arrays = frame[1]
        share = _rms(arrays.estimate["recovered"]) / _rms(arrays.error)
        return HeadlineWithFacts.from_template(
            tr("{wrong} wrong, and the simulation can tell you itself."), tr(
                "An estimator that never saw the blue line finds {share} of the error, in the right places.",
                share=per_cent(share)), wrong=_wrong(frame))
    if beside is None:
        return HeadlineWithFacts.from_template(tr("The same bar with B-splines is being prepared."))
    return HeadlineWithFacts.from_template(tr("B-splines cross without a jump: {wrong} wrong."), tr(
        "Same grid, same particles, nearly the same time. Your turn: drag Amplitude A."), wrong=_wrong(beside))


def _wrong(frame: Frame) -> str:
    """Returns the RMS error of the stress in a frame, over the largest stress, as text."""
    report, arrays = frame
    return per_cent(_rms(arrays.error) / report.scene.size_of("sigma"))


def _rms(errors: np.ndarray) -> float:
    """Returns the root mean square of the stress, in Pa, among the particles' errors (P, 4) of all quantities."""
    return math.sqrt(np.mean(errors[:, SIGMA].astype(float) ** 2))
