"""What the stages of all problems share: two halves, estimate and truth, each with a title or why it is empty."""

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from enum import Enum
from typing import Any, ClassVar, Generic, TypeVar

import numpy as np

from app.frame.captions import marks_note
from app.frame.field import FieldPlot, PinnedField, PlotPlace
from app.frame.marks import FLASH_SECONDS, RECTANGLE, Label, Mark, Sheet
from app.frame.scale import ColourScale
from app.frame.view import Half
from app.words import brief
from solvers.engine.frames import FrameArrays
from solvers.scene.scene import Scene

AnyScene = TypeVar("AnyScene", bound=Scene)
Rectangle = tuple[float, float, float, float]  # x0, x1, y0, y1
TOUCH = 0.03  # of the stage, within which a click means a particle: as much as a finger needs


class Seat(Enum):
    """Where a run is drawn: alone, or as the first or second of two."""

    ALONE, FIRST, SECOND = range(3)


@dataclass(frozen=True)
class Words:
    """What is said on a stage: titles and silences of the estimate and the truth, which run it is where there are two,
    a note on how large things are, and what the marks at crossings mean."""

    titles: tuple[str, str] = ("", "")
    silences: tuple[str, str] = ("", "")
    run: str = ""
    note: str = ""
    crossings: str = ""


class Stage(ABC, Generic[AnyScene]):
    """Makes marks of a problem's frames and shows them on a sheet; both halves and the colour bar use one scale.

    ``domains`` says whether the particles' domains are outlined, on a stage that can; ``plotted`` is the quantity whose
    field the frames hold, if any, and ``magnified`` how many times its deviation from the exact one is drawn. A pinned
    run has a stage of its own, ``beside`` the first, which lends it its field plot.
    """

    RECTANGLE: ClassVar[Rectangle] = RECTANGLE  # of all that is drawn
    PAIR_RECTANGLE: ClassVar[Rectangle]  # with a pinned run beside it
    PLOT: ClassVar[PlotPlace]  # of the field
    PLOT_DOT: ClassVar[float]  # size of a particle in it
    PAIR_PLOT: ClassVar[float]  # how much higher the plot is with a pinned run
    MOST_MARKED: ClassVar[int]  # particles whose crossings are marked
    MARK_SECONDS: ClassVar[float] = FLASH_SECONDS  # on the screen that a crossing is marked
    LINES: ClassVar[int] = 0  # of material, drawn as the exact solution has them
    MARKED: ClassVar[str]  # what is said of the marks
    ANCHORS: ClassVar[Mapping[str, tuple[float, float]]]  # what is where on the stage, of a run alone
    MIRRORS: ClassVar[tuple[tuple[int, int], ...]] = ()  # signs of x and y in each image of a body in the plane
    OUTLINED: ClassVar[tuple[tuple[int, int], ...]] = ()  # images whose domains are drawn
    DOMAINS_HINT: ClassVar[str] = ""  # what it is to outline domains, on a stage that can

    def __init__(self, sheet: Sheet, scale: ColourScale, beside: "Stage | None" = None):
        self.sheet, self._scale, self.domains = sheet, scale, False
        self.plotted: str | None = None
        self.magnified = 1
        self._drawn_scene: AnyScene | None = None
        self._foreign = self._paired = False
        self._seat = Seat.SECOND if beside else Seat.ALONE
        self._second: Stage[AnyScene] | None = None
        self._words, self._said = Words(), (Words(), Seat.ALONE)
        self._plot: FieldPlot = beside._plot if beside else FieldPlot(self.PLOT, self.PLOT_DOT)
        self._field: FieldPlot | PinnedField = self._plot.lent if beside else self._plot

    def pair(self, wanted: bool) -> "Stage | None":
        """Make room for a pinned run, or take it back; returns the stage of that run where it is wanted."""
        if wanted != self._paired:
            self._paired, self._seat = wanted, Seat.FIRST if wanted else Seat.ALONE
            self._drawn_scene = None
            self._second = self._second or type(self)(self.sheet.child("pinned"), self._scale, self)
            self._second._paired = self._second.sheet.visible = wanted
            self._plot.raised = self.PAIR_PLOT * wanted
            self._second.sheet.show(self._plot.lent.forget())
        return self._second if wanted else None

    @property
    def rectangle(self) -> Rectangle:
        """Of all that is drawn now."""
        return self.PAIR_RECTANGLE if self._paired else self.RECTANGLE

    def name(self, text: str) -> None:
        """Say which run this is, where there are two."""
        self._say(run=text)

    def caption(self, estimate: Half, truth: Half) -> None:
        """Title the halves, and say in an empty one why it is."""
        self._say(titles=(estimate.title, truth.title),
                  silences=tuple(brief(half.silence) if self._paired else half.silence for half in (estimate, truth)))

    def draw(self, scene: AnyScene, arrays: FrameArrays, estimated: np.ndarray | None, true: np.ndarray | None,
             t: float, speed: float, foreign: bool = False) -> None:
        """Show a frame.

        Parameters
        ----------
        scene, arrays
            What runs, and its particles.
        estimated, true : (P,) array or None
            Sizes of both errors, in one unit.
        t : float, s
        speed : float, simulated s per s
        foreign
            Whether particles began anywhere and may be others at any time.
        """
        if scene != self._drawn_scene or foreign or self._foreign:
            self._drawn_scene, self._foreign = scene, foreign
            at_rest = arrays.position - arrays.displacement if foreign else None
            self.sheet.show(*self._still(scene, len(arrays.position), at_rest))
            self._mark(len(arrays.position))
            self._say(note=self.note(scene))
        self.sheet.show(*self._moving(scene, arrays, estimated, true, t, speed))

    def _mark(self, particles: int) -> None:
        """Choose the particles whose crossings are marked, and say so: with marks of more, nothing else is seen."""
        every = one_in(particles, self.MOST_MARKED)
        self._marked = np.arange(particles) % every == 0
        self._say(crossings=marks_note(self.MARKED, every))

    def _say(self, **changes: Any) -> None:
        """Show the words that are others now, or elsewhere."""
        if any(getattr(self._words, name) != value for name, value in changes.items()):
            self._words = replace(self._words, **changes)
        if (now := (self._words, self._seat)) != self._said:
            self._said = now
            self.sheet.show(*self.labels(*now))

    @staticmethod
    @abstractmethod
    def labels(words: Words, seat: Seat) -> Iterator[Label]:
        """All that is written on the stage but for the scale's and the plot's numbers."""

    @staticmethod
    def outermost(scene: AnyScene) -> float | None:
        """How far from the middle a particle should come, in metres; of a problem in one dimension None."""
        return None

    @staticmethod
    def note(scene: AnyScene) -> str:
        """How large things are, and what else the stage alone does not say."""
        return ""

    @staticmethod
    def first_line(scene: AnyScene) -> float:
        """Where a line between cells is, in metres from the middle."""
        return 0.0

    @staticmethod
    def exact_lines(scene: AnyScene, t: float, count: int) -> np.ndarray:
        """The first ``count`` of the ``LINES`` of material that are drawn as the exact solution has them: points
        (count, n, 2) in metres at the time t in s. Each is the one before, turned by a part of a full turn."""
        return np.empty((0, 0, 2))

    @abstractmethod
    def region(self, low: tuple[float, float], high: tuple[float, float], arrays: FrameArrays) -> np.ndarray:
        """Which particles (P,) lie in the rectangle from ``low`` to ``high`` of the stage."""

    def nearest(self, point: tuple[float, float], arrays: FrameArrays) -> int | None:
        """The number of the particle drawn nearest to a point of the stage; None in an empty place."""
        apart = np.linalg.norm(self.images(arrays, slice(None))[:, :, :2] - point, axis=2)
        image, particle = np.unravel_index(np.argmin(np.nan_to_num(apart, nan=np.inf)), apart.shape)
        return int(particle) if apart[image, particle] < TOUCH else None

    @abstractmethod
    def images(self, arrays: FrameArrays, particles: slice) -> np.ndarray:
        """Everywhere that n particles are drawn: points of the stage (images, n, 3)."""

    @abstractmethod
    def _still(self, scene: AnyScene, particles: int, at_rest: np.ndarray | None) -> Iterator[Mark]:
        """What stays while a scene runs. Particles of a foreign one were ``at_rest`` (P, D)."""

    @abstractmethod
    def _moving(self, scene: AnyScene, arrays: FrameArrays, estimated: np.ndarray | None, true: np.ndarray | None,
                t: float, speed: float) -> Iterator[Mark]:
        """What moves."""


def one_in(particles: int, most: int) -> int:
    """Of how many particles one is marked where it crosses, so that at most ``most`` of all can be: marks of more would
    bury what they lie on."""
    return -(-particles // most)
