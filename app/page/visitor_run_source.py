"""The visitor's run as a source of the stage: now or in the past, alone or beside a pinned run."""

import math
from collections.abc import Callable, Hashable
from time import monotonic

import numpy as np

from app.frame.colour_scale import LEAST_TOP
from app.frame.error_view_captions import NONE_CHOSEN, FrameErrorView, frame_error_view, why_no_index
from app.frame.headline import DURATION, HeadlineWithFacts, InstantErrors, lane_facts
from app.frame.primitives import SEPARATOR, Spans
from app.language.translation import lazy, tr
from app.names_and_units import difference_text, functions_name, main_settings_text
from app.page.headline_panel import awaited_headline, compare_errors, frame_headline
from app.page.panels.readout_tables import live_readout
from app.page.panels.time_axis import TimelineState
from app.page.readout_panel import ReadoutContent
from app.page.stage.worst_region import WorstRegions
from app.page.stage_source import RunTitle, StageContent, StageFrame, ViewChoice
from app.page.visit.landscapes import Landscapes
from app.page.visit.pinned_run import PinnedRun
from app.page.visit.recent_frames import Frame, RecentFrames
from app.page.visit.run_session import RunSession
from app.page.visit.status_message import Notice
from app.page.visit.traced_particle_series import ParticleTracer
from solvers.engine.engine_messages import FrameReport
from solvers.engine.shared_frames import FrameArrays
from solvers.scene.estimator_registry import COMPANION, ESTIMATORS
from solvers.solver.soundness import OK, UNSTABLE

READING_SECONDS = 0.5  # for which the words about a run that plays stay, and longer for each other run that plays:
CROWDED_SECONDS = 0.02  # new words cost as much as drawing two frames
MOST_DIFFERING = 40  # most characters of the difference to a pinned run
COMPARED = "compared"  # kind of the span in which the visitor chooses what to compare with
UNJUDGED = "unjudged"  # that of a span beside which an estimator is offered
COMPARE, NOTHING_TO_COMPARE, PINNED = lazy("Compare with"), lazy("nothing"), lazy("the pinned run")

class VisitorRunSource:
    """The stage's default source: the visitor's run; ``further`` returns a notice or None if the session has none."""

    is_on, needs_immediate_headline = True, False

    def __init__(self, session: RunSession, recent: RecentFrames, trace: ParticleTracer,
                 further: Callable[[], Notice | None], landscapes: Landscapes, seek: Callable[[float], None],
                 clock: Callable[[], float] = monotonic):
        self._session, self._recent, self._trace, self._further = session, recent, trace, further
        self._landscapes, self._worst, self._clock = landscapes, WorstRegions(), clock
        self.seek = seek
        self._told: Frame | None = None  # the frame that words are about, and until when they stay
        self._told_until = 0.0
        self._rates: dict[Hashable, float] = {}  # fastest so far, in particle-steps per s, by what is computed
        self._titled: tuple[Frame, Hashable, RunTitle] | None = None  # what the last title is about, and it

    def stage_content(self, choice: ViewChoice) -> StageContent | None:
        """Returns the frame on view, beside the pinned run if any; None before the first frame, and while a frame with
        the requested difference of estimate and truth is still to come."""
        if (last := self._recent.shown_frame) is None:
            return None
        (report, arrays), back = last, self._recent.back > 0
        scene, asked = report.scene, (choice.quantity, choice.estimator, choice.difference)
        if choice.difference and scene.has("truth") and scene.active_estimators \
                and not (report.holds.differences or back):
            return None
        told = self._told_frame(last)
        other = self._session.pinned
        if other and other.scene.problem != scene.problem:
            other = None  # removed with the next frame
        picture = self._frame_view(report, arrays, frame_error_view(report, arrays, *asked),
                                   self._own_title(told, choice, other is None))
        if not report.playing:  # words that change with each frame could not be read
            self._worst.find(report, arrays, picture.view, choice.quantity)
        beside: StageFrame | RunTitle | None = None  # a second run, or its title before its first frame
        if other:
            title, view = self._other_title(other, choice), other.view(*asked)
            beside = title if view is None or other.last is None else self._frame_view(*other.last, view, title)
        return StageContent(picture, (picture.view.left.sizes, picture.view.right.sizes), asked,
                            0.0 if scene.swings else LEAST_TOP * scene.size_of(choice.quantity), back,
                            beside, self._worst.annotations(scene))

    def numbers(self, choice: ViewChoice, picture: StageFrame | None, probed: str | None) -> ReadoutContent | None:
        """Returns the numbers of the frame on view and the series for plots; None before the run's first frame.
        ``picture`` is the frame drawn last, ``probed`` the text of errors in a dragged rectangle."""
        session, recent, quantity = self._session, self._recent, choice.quantity
        if picture is not None and not picture.foreign:
            self._worst.find(picture.report, picture.arrays, picture.view, quantity)
        history, pinned, traced, shown = session.history, session.pinned, self._trace.traced, recent.shown_frame
        if shown is None or shown[0].scene != history.scene or session.awaits_problem:
            return None
        report = self._told_frame(shown)[0]
        scene, valid = report.scene, report.valid_estimators
        text = live_readout(session, history, report, quantity, choice.estimator, probed, self._worst,
                            recent.periods_back)
        moves = session.playing and not session.is_over and not recent.back and report.status != UNSTABLE
        now = TimelineState(report.time, recent.span, moves, report.since,
                            report.status == UNSTABLE and (report.since or 0.0) >= report.time - scene.time_step)
        return ReadoutContent(text, history, scene.active_estimators, valid, choice.estimator, now,
                              why_no_index(scene, valid, quantity), pinned, traced, scene)

    def sentence(self, choice: ViewChoice, picture: StageFrame) -> HeadlineWithFacts:
        """Returns the headline of the frame drawn, with a comparison to a second run; empty for another run's frame.
        While the first frame of another problem is awaited it says so, and what is drawn is hidden (10-shell.css)."""
        if self._session.awaits_problem:
            return awaited_headline(self._session.scene)
        if picture.foreign or not self._session.scene == self._session.history.scene == picture.report.scene:
            return HeadlineWithFacts()  # another run has begun just now, or is being compiled
        report, arrays = self._told_frame((picture.report, picture.arrays))
        view, other = frame_error_view(report, arrays, choice.quantity, choice.estimator, False), ""
        if (run := self._session.pinned) and (theirs := run.view(choice.quantity, choice.estimator, False)):
            own, its = (InstantErrors.of_view(one).true / scene.size_of(choice.quantity)
                        for one, scene in ((view, report.scene), (theirs, run.scene)))
            other = compare_errors(own, its, self._other_in_words(run))
        return frame_headline(report, arrays, view, choice.quantity, choice.estimator, self._recent.periods_back, other,
                              self._error_left(report, choice.quantity, choice.estimator))

    def _error_left(self, report: FrameReport, quantity: str, estimator: str | None) -> float:
        """Returns the relative error of a quantity that is left at a frame's time when the estimate is subtracted; NaN
        if unknown, and for an estimator that corrects nothing. Of the companion's result no MPM would be left."""
        series = self._session.history.series
        missed = series.get(f"{estimator}/difference_{quantity}", ())
        if estimator not in report.valid_estimators or estimator == COMPANION or not ESTIMATORS[estimator].judges \
                or not len(missed):
            return math.nan
        at = np.searchsorted(series["time"], report.time + 0.5 * report.scene.time_step) - 1
        return float(missed[max(0, at)]) / report.scene.size_of(quantity)

    def notice(self) -> Notice | None:
        """Returns the session's message for the visitor, or else one of ``further``; None if there is none."""
        return self._session.notice() or self._further()

    def _told_frame(self, drawn: Frame) -> Frame:
        """Returns the frame that all words are about: the one ``drawn``, but for a run that plays one of the last half
        second or so, so that they can be read, and say the same."""
        told, now = self._told, self._clock()
        if told is None or not drawn[0].playing or drawn[0].scene != told[0].scene or drawn[0].time < told[0].time \
                or now > self._told_until:
            self._told = drawn
            self._told_until = now + READING_SECONDS + CROWDED_SECONDS * self._session.others_playing
        return self._told or drawn

    def _own_title(self, frame: Frame, choice: ViewChoice, alone: bool) -> RunTitle:
        """Returns the title of the visitor's run in a ``frame``; that of a run ``alone`` offers a comparison."""
        scene = frame[0].scene
        known = self._landscapes.rate if scene == self._session.scene else None
        if self._titled and frame is self._titled[0] and (choice, alone, known) == self._titled[1]:
            return self._titled[2]  # asked for with each frame drawn
        name = ("what", tr("This run:") + " "), ("", functions_name(scene.method)), \
            ("settings", main_settings_text(scene))
        view = frame_error_view(*frame, choice.quantity, choice.estimator, False)
        compared = (("", tr(COMPARE)), (COMPARED, tr(NOTHING_TO_COMPARE)))
        unjudged = (SEPARATOR, (UNJUDGED, tr(NONE_CHOSEN))) if choice.estimator is None else ()
        facts = *self._facts(frame[0], view, choice.quantity, choice.estimator, known), *unjudged
        title = name, facts, compared if alone else ()
        self._titled = frame, (choice, alone, known), title
        return title

    def _other_title(self, run: PinnedRun, choice: ViewChoice) -> RunTitle:
        """Returns the title of the second ``run``, in which the visitor chooses what to compare with."""
        told = tr("follows your sliders") if run.follows else \
            tr("stays: {run}", run=difference_text(run.scene, self._session.scene) or tr("the same so far"))
        named = functions_name(run.follows) if run.follows else tr(PINNED)
        facts: Spans = (("settings", tr("being prepared")),)
        if run.last and (view := run.view(choice.quantity, choice.estimator, False)):
            facts = self._facts(run.last[0], view, choice.quantity, run.estimator(choice.estimator))
            facts = tuple(("" if kind == DURATION else kind, text) for kind, text in facts)  # one leads to Cost
        return (("what", tr(COMPARE)), (COMPARED, named), ("settings", told)), facts, ()

    def _other_in_words(self, run: PinnedRun) -> str:
        """Returns what a second ``run`` is called in a sentence."""
        if run.follows:
            return tr("{functions} at the same settings", functions=functions_name(run.follows))
        said = difference_text(run.scene, self._session.scene)
        return tr("the pinned run, {run}", run=said) if 0 < len(said) <= MOST_DIFFERING else tr(PINNED)

    def _frame_view(self, report: FrameReport, arrays: FrameArrays, view: FrameErrorView,
                    title: RunTitle) -> StageFrame:
        return StageFrame(report, arrays, view, title)

    def _facts(self, report: FrameReport, view: FrameErrorView, quantity: str, estimator: str | None,
               known: float | None = None) -> Spans:
        """Returns the facts in the title of a run, from a frame's ``report`` and the ``view`` of its errors. The run's
        time is that of its particle-steps at the rate ``known`` from its landscapes, whose runs take many steps at
        once, or else at the fastest rate measured on the stage with its method, estimators and effects."""
        scene = report.scene
        computed = scene.problem, scene.method, scene.estimators, scene.effects, scene.remedies, report.arch
        measured = self._rates[computed] = max(self._rates.get(computed, 0.0), 1e6 * report.rate)
        rate = known or measured
        seconds = report.step * report.particles / rate if rate else 0.0
        return lane_facts(InstantErrors.of_view(view), scene.size_of(quantity), estimator, report.status != OK, seconds)
