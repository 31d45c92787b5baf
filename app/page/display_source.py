"""What may be on a visitor's stage, and gives what is drawn, read and said: one interface for all of it."""

from collections.abc import Hashable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from app.frame.captions import View
from app.frame.headline import Headline
from app.frame.layout import Rectangle
from app.frame.stage import NOTHING, Annotations
from app.page.readout_panel import Numbers
from app.page.visit.status_message import Notice
from solvers.engine.engine_messages import FrameReport
from solvers.engine.shared_frames import FrameArrays

Sizes = tuple[np.ndarray | None, np.ndarray | None]  # of errors (P,), of what the left and the right half show


@dataclass(frozen=True)
class Choice:
    """What a visitor has chosen to see: the key of a quantity, the estimator that is drawn, if any, and whether its
    ``difference`` from the truth is; the particles' ``domains``; how many times the deviation in the plot of the field
    is ``magnified``; and whether plots over time show the ``latest`` periods only."""

    quantity: str
    estimator: str | None
    difference: bool
    domains: bool
    magnified: int
    latest: bool


@dataclass(frozen=True)
class FrameView:
    """A frame as it is drawn: the ``view`` of its errors, simulated seconds per second, ``name`` beside another run,
    and whether its particles are ``foreign``: began anywhere and may be others at any time."""

    report: FrameReport
    arrays: FrameArrays
    view: View
    speed: float
    name: str = ""
    foreign: bool = False


@dataclass(frozen=True)
class Display:
    """All that is to be seen: a picture, and a run ``beside`` it, of which there may be no more than a name yet.

    The colours follow the ``sizes`` of errors, and reach ``least`` at least; they begin anew where they are ``of``
    something else than before, and stay as they are for a frame that is looked ``back`` on. The ``remarks`` are written
    into the picture. The stage is ``hidden`` where something else is drawn in its place, in a rectangle.
    """

    picture: FrameView
    sizes: Sizes
    of: Hashable
    least: float = 0.0
    back: bool = False
    beside: FrameView | str | None = None
    remarks: Annotations = NOTHING
    hidden: Rectangle | None = None


class Source(Protocol):
    """Something that may be on the stage: the visitor's run, a step in slow motion, or a file."""

    @property
    def on(self) -> bool:
        """Whether it is what is to be seen."""

    @property
    def at_once(self) -> bool:
        """Whether its sentence is the answer to a click."""

    def sight(self, choice: Choice) -> Display | None:
        """What to draw now; None as long as there is nothing."""

    def numbers(self, choice: Choice, picture: FrameView | None, probed: str | None) -> Numbers | None:
        """What to read beside the ``picture`` that is drawn, and what was ``probed`` in it; None for no change."""

    def sentence(self, choice: Choice, picture: FrameView) -> Headline:
        """What is seen in the picture; nothing where that is of something else, and soon replaced."""

    def notice(self) -> Notice | None:
        """What is to be read now of it, if anything."""
