"""The interface of a feature, a part of the page such as the budget or the lessons.

A new feature is a folder or file in ``app/page/features`` and one line in ``features/all_features.py``."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from app.frame.headline import HeadlineWithFacts
from app.page.page_context import PageContext
from app.page.readout_panel import ReadoutContent
from app.page.stage_source import StageSource, ViewChoice
from app.page.visit.recent_frames import Frame
from app.page.visit.status_message import Notice
from solvers.engine.engine_messages import FrameReport


@dataclass(frozen=True)
class VisiblePageState:
    """What a visitor sees at a refresh: the view options, the ``numbers`` beside the stage (None if unchanged), whether
    a lesson is open, and whether the run is on the stage without a lesson (``has_stage``)."""

    choice: ViewChoice
    numbers: ReadoutContent | None
    in_lesson: bool
    has_stage: bool


class Feature:
    """A part of one visitor's page, such as the lessons. The page calls these methods; by default they do nothing."""

    source: StageSource | None = None  # what it can put on the stage
    messages: Mapping[str, Callable[[Any], None]] = {}  # acts on messages of the browser, by key; they may be anything
    shortcuts: Mapping[str, Callable[[], None]] = {}  # acts on keys, by the names that ``js/keys.js`` sends

    def __init__(self, page: PageContext):
        """Builds the feature's widgets on a page."""

    @classmethod
    def build(cls, page: PageContext) -> "Feature | None":
        """Returns the feature for a page; None if that page does not have it."""
        return cls(page)

    def on_frame(self, report: FrameReport) -> None:
        """Handles a new frame of the visitor's run, on the thread that reads frames from the engine."""

    def refresh(self, view: VisiblePageState) -> None:
        """Updates the feature's widgets; called a few times a second while the browser shows the page."""

    def headline(self, frame: Frame | None) -> HeadlineWithFacts:
        """Returns a headline to show in place of the run's for the frame on view; an empty one leaves the run's."""
        return HeadlineWithFacts()

    def notice(self) -> Notice | None:
        """Returns a message for the visitor about the stage, shown if the session has none; None for no message."""
        return None

    def leave_stage(self) -> None:
        """Stops showing the feature's own contents on the stage, because the run returns to it."""

    def close(self) -> None:
        """Ends the feature's threads and processes, because the visitor leaves."""
