"""The interface of a feature, a part of the page such as the budget or the lessons.

A new feature is a folder or file in ``app/page/features`` and one line in ``features/all_features.py``."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from app.frame.headline import Headline
from app.page.display_source import Choice, Source
from app.page.page_context import PageContext
from app.page.readout_panel import Numbers
from app.page.visit.frame_buffer import Frame
from app.page.visit.status_message import Notice
from solvers.engine.engine_messages import FrameReport


@dataclass(frozen=True)
class PageView:
    """What a visitor sees at a refresh: the ``choice`` of view, the ``numbers`` beside the stage if they have changed,
    whether a lesson is open, and whether the run has the stage and the visitor's attention for itself (``alone``)."""

    choice: Choice
    numbers: Numbers | None
    in_lesson: bool
    alone: bool


class Feature:
    """A part of one visitor's page. The page calls these methods; each does nothing unless a feature has its own."""

    source: Source | None = None  # that it can put on the stage

    @classmethod
    def build(cls, page: PageContext) -> "Feature | None":
        """Makes the feature with its widgets for a page; None where that page has none of it."""
        raise NotImplementedError(f"{cls.__name__} is no feature: it has no build(page)")

    @property
    def messages(self) -> Mapping[str, Callable[[Any], None]]:
        """What is done with messages of the browser, by their key; their values may be anything."""
        return {}

    @property
    def shortcuts(self) -> Mapping[str, Callable[[], None]]:
        """What keys of the keyboard do, by the names that ``js/keys.js`` sends."""
        return {}

    def follow(self, report: FrameReport) -> None:
        """Takes a new frame of the run, on the thread that reads frames."""

    def refresh(self, view: PageView) -> None:
        """Shows what has changed; called a few times a second while the browser shows the page."""

    def headline(self, frame: Frame | None) -> Headline:
        """Sentence about the frame that replaces that of the run; an empty one replaces nothing."""
        return Headline()

    def notice(self) -> Notice | None:
        """Message about the stage for when the session has none."""
        return None

    def leave_stage(self) -> None:
        """Something else takes the stage."""

    def close(self) -> None:
        """The visitor has gone: threads and processes end."""
