"""The pinned run: a second run beside the visitor's, for comparison, which stays as it is or follows its scene."""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace

from app.frame.error_view_captions import FrameErrorView, frame_error_view
from app.language.translation import tr, translate_message
from app.page.visit.history import NormHistory
from solvers.engine.engine_messages import FrameReport, Pace
from solvers.engine.engine_pool import SessionLink, SessionListener
from solvers.engine.shared_frames import FrameArrays, FrameOptions
from solvers.scene.scene import Scene
from solvers.scene.validation import SceneError
from solvers.solver.soundness import UNSTABLE


class PinnedRun:
    """A run beside the visitor's, for comparison: its scene, history, and ``last`` frame, None before the first. One
    that ``follows`` has the visitor's scene with this method (its key) instead; another (None) stays."""

    def __init__(self, open_link: Callable[[SessionListener], SessionLink], scene: Scene, on_frame: Callable[[], None],
                 follows: str | None = None):
        self.scene, self._on_frame, self.follows = scene, on_frame, follows
        self.history = NormHistory(scene, scene.particles)
        self.last: tuple[FrameReport, FrameArrays] | None = None
        self._error: str | None = None
        self._link = open_link(self)

    def follow(self, scene: Scene) -> None:
        """Takes over the visitor's new ``scene`` if the run follows it; the next request asks for it. Keeps its own if
        its method does not allow the new one."""
        if self.follows:
            with suppress(SceneError):
                self.scene = replace(scene, method=self.follows)

    def set_pace(self, pace: Pace, frame: FrameOptions) -> None:
        """Requests the session's pace and frame contents, without restarts of its own and step breakdowns."""
        self._error = None
        self._link.ask(self.scene, replace(pace, restarts=0), replace(frame, broken_down=None))

    def close(self) -> None:
        self._link.close()

    def estimator(self, drawn: str | None) -> str | None:
        """Returns the estimator ``drawn`` on the stage if the pinned run has it, or its first; None if it has none."""
        return drawn if drawn in self.scene.estimators else self.scene.first_estimator

    def view(self, quantity: str, drawn: str | None, difference: bool) -> FrameErrorView | None:
        """Returns the errors to draw of the last frame: of a quantity ("x"), by :meth:`estimator` of ``drawn``, with
        ``difference`` that from the truth; None before the first frame."""
        if self.last is None:
            return None
        report, arrays = self.last
        estimator = self.estimator(drawn)
        return frame_error_view(report, arrays, quantity, estimator, difference and estimator in arrays.difference)

    def stop_reason(self) -> str | None:
        """Returns in few words why the run has stopped; None while it goes on."""
        if self._error:
            return translate_message(self._error)
        report = self.last[0] if self.last else None
        if report is None or report.status != UNSTABLE:
            return None
        return tr("went unstable and has stopped at {periods:.2f} periods", periods=report.time / self.scene.period)

    def on_frame(self, report: FrameReport, arrays: FrameArrays) -> None:
        """Stores a frame and its samples; called on the engine's reader thread, as the three methods below."""
        if report.fresh:
            self.history = NormHistory(report.scene, report.particles)
        self.history.add(report.rows)
        self.last = report, arrays
        self._on_frame()

    def on_compiling(self, number: int) -> None:
        """Does nothing: the run is drawn as soon as it is compiled."""

    def on_error(self, sentence: str) -> None:
        self._error = sentence

    def on_engine_lost(self) -> None:
        """Does nothing: the link to the engine reconnects by itself."""
