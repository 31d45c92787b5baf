"""What the stages of all problems share: two halves, estimate and truth, each with a title or why it is empty."""

from abc import ABC, abstractmethod
from typing import ClassVar, Generic, TypeVar

import numpy as np
import viser

from app import drawing
from app.frame.captions import marks_note
from app.frame.view import Half
from app.problems.field import Dots, FieldPlot, Place
from app.scale import ColourScale
from app.words import brief
from solvers.engine.frames import FrameArrays
from solvers.scene.scene import Scene

AnyScene = TypeVar("AnyScene", bound=Scene)
TOUCH = 0.03  # of the stage, within which a click means a particle: as much as a finger needs


class Stage(ABC, Generic[AnyScene]):
    """Draws frames of a problem in one client's scene; both halves and the colour bar use one scale.

    ``domains`` says whether the particles' domains are outlined, on a stage that can; ``plotted`` is the quantity whose
    field the frames hold, if any, and ``magnified`` how many times its deviation from the exact one is drawn.
    ``_titles`` and ``_silences`` hold two labels each, the estimate's and the truth's; ``_name`` says which run it is
    when there are two. A pinned run has a stage of its own, ``beside`` the first, which lends it its field plot; what
    is drawn of a stage goes under its name ``at``.
    """

    PROBLEM: ClassVar[str]
    RECTANGLE: ClassVar[tuple[float, float, float, float]] = drawing.RECTANGLE  # x0, x1, y0, y1 of all that is drawn
    PAIR_RECTANGLE: ClassVar[tuple[float, float, float, float]] = drawing.RECTANGLE  # with a pinned run beside it

    SILENCE_WIDTH: ClassVar[int]  # characters in a line of the reason why a half is empty
    NAME_WIDTH: ClassVar[int]  # and of what a run is called beside another one
    PLOT: ClassVar[Place]  # of the field
    PLOT_DOT: ClassVar[float]  # size of a particle in it
    MOST_MARKED: ClassVar[int]  # particles whose crossings are marked
    MARK_SECONDS: ClassVar[float] = drawing.FLASH_SECONDS  # on the screen that a crossing is marked
    LINES: ClassVar[int] = 0  # of material, drawn as the exact solution has them
    MARKED: ClassVar[str]  # what is said of the marks

    _titles: list[viser.LabelHandle]
    _silences: list[viser.LabelHandle]
    _name: viser.LabelHandle
    _flash_note: viser.LabelHandle  # of the first stage only

    def __init__(self, client: viser.ClientHandle, scale: ColourScale, beside: "Stage | None" = None):
        self._client, self._scale, self.domains, self._paired = client, scale, False, False
        self.plotted: str | None = None
        self.magnified = 1
        self._drawn_scene: AnyScene | None = None
        self._foreign = False
        self._beside = beside
        self._second: Stage[AnyScene] | None = None
        self.at = f"/{self.PROBLEM}" + "/pinned" * bool(beside)
        self.root = client.scene.add_frame(self.at, show_axes=False)
        self._plot: FieldPlot = beside._plot if beside \
            else FieldPlot(client.scene, self.PROBLEM, self.PLOT, self.PLOT_DOT)
        self._field: FieldPlot | Dots = self._plot.lent if beside else self._plot

    def pair(self, wanted: bool) -> "Stage | None":
        """Make room for a pinned run, or take it back; returns the stage of that run where it is wanted."""
        if wanted != self._paired:
            self._paired, self._drawn_scene = wanted, None
            self._second = self._second or type(self)(self._client, self._scale, self)
            self._second.root.visible = wanted
            self._second._paired = wanted
            self._arrange()
            self._second._arrange()
            self._plot.lent.forget()
        return self._second if wanted else None

    @property
    def rectangle(self) -> tuple[float, float, float, float]:
        """x0, x1, y0, y1 of all that is drawn now."""
        return self.PAIR_RECTANGLE if self._paired else self.RECTANGLE

    def name(self, text: str) -> None:
        """Say which run this is, where there are two."""
        drawing.write(self._name, text, self.NAME_WIDTH)

    def draw(self, scene: AnyScene, arrays: FrameArrays, estimated: np.ndarray | None, true: np.ndarray | None,
             t: float, speed: float, foreign: bool = False) -> None:
        """Show a frame. ``estimated`` and ``true`` are sizes of errors (P,); t in s, ``speed`` in simulated s per s.
        Particles of a ``foreign`` run began anywhere and may be others at any time."""
        if scene != self._drawn_scene or foreign or self._foreign:
            self._drawn_scene, self._foreign = scene, foreign
            self._draw_grid(scene, arrays.position - arrays.displacement if foreign else None)
        self._draw_frame(scene, arrays, estimated, true, t, speed)

    def _mark(self, particles: int) -> None:
        """Choose the particles whose crossings are marked, and say so: with marks of more, nothing else is seen."""
        every = drawing.one_in(particles, self.MOST_MARKED)
        self._marked = np.arange(particles) % every == 0
        if not self._beside:
            drawing.write(self._flash_note, marks_note(self.MARKED, every))

    def caption(self, estimate: Half, truth: Half) -> None:
        """Title the halves, and say in an empty one why it is."""
        for half, title, silence in zip((estimate, truth), self._titles, self._silences, strict=True):
            drawing.write(title, half.title)
            drawing.write(silence, brief(half.silence) if self._paired else half.silence, self.SILENCE_WIDTH)

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
        """The particle drawn nearest to a point of the stage; None in an empty place."""
        apart = np.linalg.norm(self.images(arrays, slice(None))[:, :, :2] - point, axis=2)
        image, particle = np.unravel_index(np.argmin(np.nan_to_num(apart, nan=np.inf)), apart.shape)
        return int(particle) if apart[image, particle] < TOUCH else None

    @abstractmethod
    def images(self, arrays: FrameArrays, particles: slice) -> np.ndarray:
        """Everywhere that n particles are drawn: points of the stage (images, n, 3)."""

    @abstractmethod
    def _arrange(self) -> None:
        """Take the place that is this run's, alone or as one of two (``_paired``, ``_beside``)."""

    @abstractmethod
    def _draw_grid(self, scene: AnyScene, at_rest: np.ndarray | None = None) -> None:
        """Draw what stays while a scene runs. Particles of a foreign one were ``at_rest`` (P, D)."""

    @abstractmethod
    def _draw_frame(self, scene: AnyScene, arrays: FrameArrays, estimated: np.ndarray | None,
                    true: np.ndarray | None, t: float, speed: float) -> None:
        """Draw what moves."""
