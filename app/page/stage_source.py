"""The interface of everything that can be on a visitor's stage: its picture, numbers, headline and notice."""

from collections.abc import Hashable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from app.frame.error_view_captions import FrameErrorView
from app.frame.headline import HeadlineWithFacts
from app.frame.layout import Rectangle
from app.frame.primitives import Spans
from app.frame.stage import NOTHING, WorstRegionAnnotations
from app.page.readout_panel import ReadoutContent
from app.page.visit.status_message import Notice
from solvers.engine.engine_messages import FrameReport
from solvers.engine.shared_frames import FrameArrays

RunTitle = tuple[Spans, Spans, Spans]  # its name, facts, and what it could be compared with
NO_TITLE: RunTitle = (), (), ()
Sizes = tuple[np.ndarray | None, np.ndarray | None]  # of errors (P,), of what the left and the right half show


@dataclass(frozen=True)
class ViewChoice:
    """View options of a visitor: key of the quantity (x, v, sigma, a), the estimator on the stage or None, whether its
    ``difference`` from the truth and the particles' ``domains`` are drawn, the factor by which the deviation is
    ``magnified`` in the field plot, and whether plots over time show the ``latest`` periods only."""

    quantity: str
    estimator: str | None
    difference: bool
    domains: bool
    magnified: int
    latest: bool


@dataclass(frozen=True)
class StageFrame:
    """A frame to draw: the ``view`` of its errors, the run's ``title`` (:meth:`~app.frame.stage.Stage.show_title`), and
    whether its particles are ``foreign``: of a file, without a fixed order or initial positions."""

    report: FrameReport
    arrays: FrameArrays
    view: FrameErrorView
    title: RunTitle = NO_TITLE
    foreign: bool = False


@dataclass(frozen=True)
class StageContent:
    """Everything to draw: a picture, and ``beside`` it a second run, or that run's title before its first frame. The
    colour scale follows the ``sizes`` of errors and reaches at least ``least`` (in their unit); it is reset when
    ``scale_key`` changes and kept for an earlier frame (``is_past``). ``annotations`` are notes in the picture. If
    something else is drawn in a rectangle ``hidden``, the stage itself is hidden."""

    picture: StageFrame
    sizes: Sizes
    scale_key: Hashable
    least: float = 0.0
    is_past: bool = False
    beside: StageFrame | RunTitle | None = None
    annotations: WorstRegionAnnotations = NOTHING
    hidden: Rectangle | None = None


class OwnPicture(Protocol):
    """Picture of something without a scene, in place of the stage of a problem."""

    def draw(self) -> Rectangle:
        """Draws the picture on surfaces of its own, and returns the rectangle that it fills."""


class StageSource(Protocol):
    """Something that can be on the stage: the visitor's run, a step in slow motion, a body, or an uploaded file."""

    @property
    def is_on(self) -> bool:
        """Whether this source is on the stage now."""

    @property
    def needs_immediate_headline(self) -> bool:
        """Whether the source's headline answers a click and must appear without delay."""

    def seek(self, time: float) -> None:
        """Shows the frame nearest to a time in s, paused, if there is one."""

    def stage_content(self, choice: ViewChoice) -> StageContent | OwnPicture | None:
        """Returns what to draw now with these view options; None before there is anything to draw."""

    def numbers(self, choice: ViewChoice, picture: StageFrame | None, probed: str | None) -> ReadoutContent | None:
        """Returns the numbers for the ``picture`` drawn and for ``probed``, the text of errors in a dragged rectangle;
        None if nothing has changed."""

    def sentence(self, choice: ViewChoice, picture: StageFrame) -> HeadlineWithFacts:
        """Returns the headline of the picture drawn; an empty one if the picture is about to be replaced."""

    def notice(self) -> Notice | None:
        """Returns the source's message for the visitor; None if there is none."""
