"""The visitor's run as a source of the stage: now or in the past, alone or beside a pinned run."""

from collections.abc import Callable

from app.frame.colour_scale import LEAST_TOP
from app.frame.error_view_captions import FrameErrorView, frame_error_view, why_no_index
from app.frame.headline import HeadlineWithFacts
from app.language.translation import tr
from app.names_and_units import difference_text
from app.page.headline_panel import compare_with_pinned, frame_headline
from app.page.panels.error_timeline import TimelineState
from app.page.panels.readout_tables import live_readout
from app.page.readout_panel import ReadoutContent
from app.page.stage.worst_region import WorstRegions
from app.page.stage_source import StageContent, StageFrame, ViewChoice
from app.page.visit.recent_frames import RecentFrames
from app.page.visit.run_session import RunSession
from app.page.visit.status_message import Notice
from app.page.visit.traced_particle_series import ParticleTracer
from solvers.engine.engine_messages import FrameReport
from solvers.engine.shared_frames import FrameArrays
from solvers.solver.soundness import UNSTABLE


class VisitorRunSource:
    """The stage's default source: the visitor's run; ``further`` returns a notice or None if the session has none."""

    is_on, needs_immediate_headline = True, False

    def __init__(self, session: RunSession, recent: RecentFrames, trace: ParticleTracer,
                 further: Callable[[], Notice | None]):
        self._session, self._recent, self._trace, self._further = session, recent, trace, further
        self._worst = WorstRegions()

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
        pinned = self._session.pinned
        if pinned and pinned.scene.problem != scene.problem:
            pinned = None  # removed with the next frame
        said = difference_text(scene, pinned.scene) if pinned else ""
        name = tr("this run: {run}", run=said) if said else tr("this run") if pinned else ""
        picture = self._frame_view(report, arrays, frame_error_view(report, arrays, *asked), name)
        if not report.playing:  # words that change with each frame could not be read
            self._worst.find(report, arrays, picture.view, choice.quantity)
        beside: StageFrame | str | None = None  # a pinned run, or its name before its first frame
        if pinned:
            run, view = difference_text(pinned.scene, scene) or tr("the same so far"), pinned.view(*asked)
            beside = tr("pinned: {run}, being prepared", run=run) if view is None or pinned.last is None else \
                self._frame_view(*pinned.last, view, tr("pinned: {run}", run=run))
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
        if shown is None or shown[0].scene != history.scene:
            return None
        report = shown[0]
        scene, valid = report.scene, report.valid_estimators
        text = live_readout(session, history, report, quantity, choice.estimator, probed, self._worst,
                            recent.periods_back)
        moves = session.playing and not session.is_over and not recent.back and report.status != UNSTABLE
        now = TimelineState(report.time, recent.span, moves, report.since,
                            report.status == UNSTABLE and (report.since or 0.0) >= report.time - scene.time_step)
        return ReadoutContent(text, history, scene.active_estimators, valid, choice.estimator, now,
                              why_no_index(scene, valid, quantity), pinned, traced, scene)

    def sentence(self, choice: ViewChoice, picture: StageFrame) -> HeadlineWithFacts:
        """Returns the headline of the frame drawn, with a comparison to a pinned run; empty for another run's frame."""
        history, pinned, report = self._session.history, self._session.pinned, picture.report
        if picture.foreign or not self._session.scene == history.scene == report.scene == self._worst.scene:
            return HeadlineWithFacts()  # another run has begun just now, or is being compiled
        beside = "" if pinned is None else compare_with_pinned(history.series, pinned.history.series, choice.quantity,
                                                               (report.scene, pinned.scene))
        return frame_headline(report, picture.arrays, picture.view, self._worst, history.series, choice.quantity,
                              choice.estimator, self._recent.periods_back, beside, picture.speed)

    def notice(self) -> Notice | None:
        """Returns the session's message for the visitor, or else one of ``further``; None if there is none."""
        return self._session.notice() or self._further()

    def _frame_view(self, report: FrameReport, arrays: FrameArrays, view: FrameErrorView, name: str) -> StageFrame:
        return StageFrame(report, arrays, view, self._session.speed * report.scene.period, name)
