"""The opening tour in four steps with the runs' own numbers, and the pause at its end."""

import math
from collections.abc import Callable
from time import monotonic
from typing import Any

import numpy as np
import viser

from app import shareable_state
from app.frame.headline import HeadlineWithFacts
from app.language.translation import tr, trn
from app.names_and_units import METHODS, per_cent, with_unit
from app.page.feature import Feature, VisiblePageState
from app.page.page_context import PageContext
from app.page.visit.pinned_run import PinnedRun
from app.page.visit.recent_frames import Frame
from app.page.visit.run_session import RunSession
from solvers.engine.engine_messages import FrameReport
from solvers.engine.shared_frames import FrameArrays
from solvers.solver import samples

HALF_WAY = 0.125  # periods at the end of the first step
BEAT = 10.0  # seconds of each of the last two steps
LAST = 4
SIGMA = samples.QUANTITIES.index("sigma")
WIDE = 1.0 + 1e-6  # cells from a particle that has crossed within which errors are attributed to it

#: First state without a link: hat functions beside B-splines, slowly, for the quarter of a
#: period in which the first particles change their cell and the stress is wrong there; then it stops. At larger
#: amplitudes, where all cross repeatedly, those that crossed err no more than the others.
OPENING = shareable_state.parse_state(
    "bar;method=mpm;amplitude=0.0034;periods=0.25;estimators=recovered,companion;error-of=sigma;speed=0.0125;stops;"
    "pinned;method=bspline;amplitude=0.0034;periods=0.25;estimators=recovered,companion")


class OpeningTour(Feature):
    """One visitor's tour of the page: ``show_opening`` puts its first state on the stage, ``restore_speed`` ends its
    slow playback; ``story.js`` starts it. ``clock`` returns seconds."""

    def __init__(self, gui: viser.GuiApi, session: RunSession, show_opening: Callable[[], None],
                 restore_speed: Callable[[], None], clock: Callable[[], float] = monotonic):
        self._session, self._clock, self._mark = session, clock, gui.add_html("")
        self._show_opening, self._restore_speed = show_opening, restore_speed
        self.messages = {"story": self.on_message}
        self._opened, self._restarts = True, 0  # whether the opening is on the stage before its end; number of restarts
        self.beat = 0  # 1 to LAST during the tour
        self._since = 0.0

    @classmethod
    def build(cls, page: PageContext) -> "OpeningTour":
        def show_opening() -> None:  # without slow rebuilding of widgets if nothing has changed
            if page.controls.state == OPENING and page.session.playing and not page.session.refused:
                page.session.reset()
            else:
                page.controls.show(OPENING)

        tour = cls(page.gui, page.session, show_opening, page.controls.reset_speed)
        page.is_touring = lambda: tour.beat > 0
        with page.tabs["about"]:
            page.gui.add_html("<i class='lab-replay'></i>")
            hint = tr("the introduction to this page, in four steps")
            replay = page.gui.add_button(tr("Replay the introduction"), hint=hint)
        replay.on_click(lambda _: tour.on_message("play"))
        return tour

    def on_message(self, message: Any) -> None:
        """Starts the tour at the browser's message "play", ends it at "skip"; ignores others."""
        if message == "play":
            self._show_opening()
            self._opened, self.beat = True, 1
        elif message == "skip" and self.beat:
            self._end()

    def refresh(self, view: VisiblePageState) -> None:
        """Goes on to the tour's next step when it is time; ends the tour if anything else takes the stage."""
        session, report = self._session, self._session.report
        restarts = session.playback_request_key[1]
        if (session.scene, session.pinned_scene) != (OPENING.scene, OPENING.pinned) or not view.has_stage:
            if self._opened and restarts == self._restarts:  # changed, not replaced
                session.continue_past_end()
            self._opened = False
            self._end()
        if report is None or report.scene != OPENING.scene:
            return
        self._restarts, periods = restarts, report.time / report.scene.period
        # A pinned run that is compiled late restarts both; they would stay at t = 0 if the first were paused.
        if self._opened and session.is_over and ((other := session.pinned) is None or other.stop_reason() or (
                other.last is not None and other.last[0].step >= other.scene.steps)):
            self._opened = False
            session.continue_past_end()
            self._restore_speed()
        if self.beat == 1 and periods >= HALF_WAY:
            self._go(2)
        elif (self.beat == 2 and not self._opened) or (self.beat == 3 and self._clock() > self._since + BEAT):
            self._go(self.beat + 1)
        elif self.beat == LAST and self._clock() > self._since + BEAT:
            self._end()
        self._show()

    def headline(self, frame: Frame | None) -> HeadlineWithFacts:
        """Returns the headline of the tour's present step for a ``frame`` of the run; an empty one outside it."""
        if not self.beat or frame is None or frame[0].scene != OPENING.scene:
            return HeadlineWithFacts()
        headline, facts, places = _beat_headline(self.beat, *frame, self._session.pinned)
        said = HeadlineWithFacts.from_template(headline, *facts, **places)
        return HeadlineWithFacts(said.headline, said.facts, ("beat", self.beat))

    def _go(self, beat: int) -> None:
        self.beat, self._since = beat, self._clock()

    def _end(self) -> None:
        if self.beat:
            self.beat = 0
            if self._opened:  # the rest of the quarter at once
                self._restore_speed()
        self._show()

    def _show(self) -> None:
        self._mark.content = f"<i class='lab-story' data-beat='{self.beat}'></i>"


def _beat_headline(beat: int, report: FrameReport, arrays: FrameArrays, pinned: PinnedRun | None,
                   ) -> tuple[str, list[str], dict[str, str]]:
    """Returns the headline template of the tour's step ``beat`` (1 to 4), facts, and the template's values."""
    scene, size = report.scene, report.scene.size_of("sigma")
    error = arrays.error[:, SIGMA].astype(float)
    wrong, crossed = math.sqrt(np.mean(error**2)) / size, arrays.steps_since_crossing >= 0
    if beat == 1:
        return (tr("The blue line is the exact stress at every point of this bar."),
                [tr("The bar swings by {amplitude}. The dots are computed: will they stay on the line?",
                    amplitude=with_unit(scene.amplitude, "m"))], {})
    if beat == 2 and not crossed.any():
        return (tr("{by}, the oldest method: does the stress stay on the line?"),
                [tr("No particle has changed its cell yet. Watch for the magenta dots.")],
                {"by": str(METHODS[scene.method])})
    if beat == 2:
        # The share of the squared error within a cell's width of particles that have changed their cell.
        count = int(crossed.sum())
        x, square = arrays.position[:, 0].astype(float), arrays.error[:, SIGMA].astype(float) ** 2
        near = np.abs(x[:, None] - x[arrays.steps_since_crossing >= 0]).min(axis=1) <= WIDE * OPENING.scene.spacing
        told = trn("{count} particle has changed its cell: {share} of the squared error lies within a cell's width.",
                   "{count} particles have changed their cell: {share} of the squared error lies within a cell's "
                   "width.", count, share=per_cent(float(square[near].sum() / square.sum()))) if square.sum() else \
            trn("{count} particle has changed its cell: all of the squared error lies within a cell's width.",
                "{count} particles have changed their cell: all of the squared error lies within a cell's width.",
                count)
        return (tr("The stress is {wrong} {off}: it leaves the line where a particle changes its cell."),
                [told], {"wrong": per_cent(wrong), "off": tr("wrong")})
    if beat == 3:
        estimate = arrays.estimate.get("recovered", np.full_like(arrays.error, np.nan))[:, SIGMA].astype(float)
        index = math.sqrt(np.mean(estimate**2)) / (wrong * size) if wrong else math.nan
        return (tr("{by} without the exact solution finds {wrong} of that error."),
                [tr("The estimator recovered smooths the particles' motion. Upper lane: its estimate; lower lane: the "
                    "true error.")], {"by": tr("An estimator"), "wrong": per_cent(index)})
    if pinned is None or pinned.last is None:
        return tr("The same bar with B-splines is being prepared."), [], {}
    other = pinned.last[1]
    its = math.sqrt(np.mean(other.error[:, SIGMA].astype(float)**2)) / size
    same = int((other.steps_since_crossing >= 0).sum())
    places = {"by": tr("B-splines"), "wrong": per_cent(its), "off": tr("wrong")}
    headline = trn("{by}: {wrong} {off}, though a particle has, too.",
                   "{by}: {wrong} {off}, though {count} particles have changed their cell there, too.", same,
                   **{name: f"{{{name}}}" for name in places})
    return headline, [tr("At what price? Ask one of the questions that come now, or open Cost.")], places
