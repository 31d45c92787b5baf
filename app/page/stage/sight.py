"""What is to be seen on the stage, as data, and what a visitor has chosen of it."""

from collections.abc import Hashable
from dataclasses import dataclass

import numpy as np

from app.frame.view import View
from solvers.engine.frames import FrameArrays
from solvers.engine.messages import FrameReport

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
class Picture:
    """A frame of a run as it is drawn: with the ``view`` of its errors, the simulated seconds that go by in one of the
    visitor's, and a ``name`` where there are two runs. Particles of a ``foreign`` run began anywhere and may be others
    at any time."""

    report: FrameReport
    arrays: FrameArrays
    view: View
    speed: float
    name: str = ""
    foreign: bool = False


@dataclass(frozen=True)
class Sight:
    """All that is to be seen: a picture, and a run ``beside`` it, of which there may be no more than a name yet.

    The colours follow the ``sizes`` of errors at a time in ``periods``, and reach ``least`` at least; they begin anew
    where they are ``of`` something else than before, and stay as they are for a frame that is looked ``back`` on. The
    stage is ``hidden`` where something else is drawn in its place.
    """

    picture: Picture
    sizes: Sizes
    periods: float
    of: Hashable
    least: float = 0.0
    back: bool = False
    beside: Picture | str | None = None
    hidden: bool = False
