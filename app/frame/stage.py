"""Stages of all problems: two halves, estimate and truth, each with a title or the reason why it is empty."""

from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Generic, Literal, TypeVar

import numpy as np

from app.frame.captions import ALIKE, ALIKE_LOST, StageHalf, crossing_marks_legend
from app.frame.colour_scale import ColourScale
from app.frame.field_plot import FieldPlot, FieldPlotDefinition
from app.frame.layout import Rectangle, RunSlot
from app.frame.primitives import Label, Mark, StageMetrics, Surface, error_colours
from app.frame.recent_crossings import crossing_ages, is_recent_crossing
from app.language.translation import lazy, tr
from app.words import short_reason
from solvers.engine.shared_frames import FrameArrays
from solvers.scene.scene import Scene

AnyScene = TypeVar("AnyScene", bound=Scene)
TOUCH = 0.03  # distance on the stage within which a click selects a particle: wide enough for a finger
Names = tuple[str, str]  # of the estimate and of the truth


@dataclass(frozen=True)
class StageLabels:
    """Labels on a stage: titles, sources and reasons of both halves, run, scale note, crossings, equal halves."""

    titles: Names = ("", "")
    by: Names = ("", "")
    silences: Names = ("", "")
    run: str = ""
    note: str = ""
    crossings: str = ""
    alike: str = ""


@dataclass(frozen=True, eq=False)
class WorstRegionMark:
    """Region with the largest error: its particles (P,), and the error's size as text."""

    particles: np.ndarray
    size: str


@dataclass(frozen=True, eq=False)
class Annotations:
    """Notes in a picture: the worst regions of estimate and truth, and whether the run is lost or well estimated."""

    worst: tuple[WorstRegionMark | None, WorstRegionMark | None] = (None, None)
    lost: bool = False
    right: bool = False


NOTHING = Annotations()


class Stage(ABC, Generic[AnyScene]):
    """Draws the marks of a problem's frames on a surface; both halves and the colour bar use one scale.

    ``domains`` sets whether the particles' domains are outlined, if supported; ``plotted`` is the quantity whose field
    the frames contain, if any, and ``magnified`` the factor of its deviation from the exact one. A pinned run has a
    stage of its own, ``beside`` the first; their field plots share an axis."""

    HIGH: ClassVar[tuple[float, float]] = (0.3, 0.9)  # least and greatest height of the stage
    PLOT: ClassVar[FieldPlotDefinition]  # settings of the field plot
    MOST_MARKED: ClassVar[int]  # particles whose crossings are marked
    LINES: ClassVar[int] = 0  # material lines drawn by the exact solution
    MARKED: ClassVar[str] = lazy("crosses an edge")  # legend of the marks
    HALVES: ClassVar[str]  # name of the parts for estimate and truth
    MIRRORS: ClassVar[tuple[tuple[int, int], ...]] = ()  # signs of x and y in each image of a body in the plane
    OUTLINED: ClassVar[tuple[tuple[int, int], ...]] = ()  # images whose domains are drawn
    DOMAINS_HINT: ClassVar[str] = ""  # tooltip for outlining domains, if supported

    def __init__(self, sheet: Surface, scale: ColourScale, beside: "Stage | None" = None):
        self.sheet, self._scale, self.domains = sheet, scale, False
        self.plotted: str | None = None
        self.magnified = 1
        self._drawn_scene: AnyScene | None = None
        self._foreign = False
        self._seat = RunSlot.SECOND if beside else RunSlot.ALONE
        self._second: Stage[AnyScene] | None = None
        self._labels, self._shown = StageLabels(), (StageLabels(), None)
        self._captioned: tuple | None = None  # arguments of the present captions
        self._remarks: Annotations | None = None
        self._field: FieldPlot = FieldPlot(self.PLOT, beside._field if beside else None)
        self._lay_out()

    def _lay_out(self) -> None:
        """Computes the layout for the present bounds."""
        self._stage_metrics = self.sheet.stage_metrics
        room = self._stage_metrics.rounded()
        low, high = self.HIGH
        self._layout = self.layout(replace(room, high=min(max(room.high, low), high)), self._seat)
        self._drawn_scene, self._remarks = None, None

    def pinned_run_stage(self, wanted: bool) -> "Stage | None":
        """Makes space for a pinned run, or takes it back; returns the stage of that run if ``wanted``."""
        if wanted != (self._seat == RunSlot.FIRST):
            self._seat = RunSlot.FIRST if wanted else RunSlot.ALONE
            self._lay_out()
            self._second = self._second or type(self)(self.sheet.add_child("pinned"), self._scale, self)
            self._second.sheet.visible = wanted
        return self._second if wanted else None

    @property
    def rectangle(self) -> Rectangle:
        """The rectangle of everything drawn, without names in the gutter."""
        room = self.sheet.stage_metrics
        if room is not self._stage_metrics and room != self._stage_metrics:
            self._lay_out()
        return self._layout.rectangle

    @property
    def shared_axis_changed(self) -> bool:
        """Whether it must be redrawn, because the run beside it has changed their common axis."""
        return self._field.shared_axis_changed

    def show_run_name(self, text: str) -> None:
        """Shows the run's name, if there are two."""
        self._update_labels(run=text)

    def show_captions(self, estimate: StageHalf, truth: StageHalf) -> None:
        """Shows the titles of the halves, and the reason in an empty one."""
        said = self._seat, estimate.title, estimate.by, estimate.silence, truth.title, truth.by, truth.silence
        if said == self._captioned:
            return
        self._captioned, alone = said, self._seat == RunSlot.ALONE
        self._update_labels(
            titles=(estimate.title, truth.title),
            by=(estimate.by, truth.by),
            silences=tuple(half.silence if alone else short_reason(half.silence) for half in (estimate, truth)),
        )

    def annotate(self, remarks: Annotations, arrays: FrameArrays) -> None:
        """Shows annotations in the frame; unchanged ones stay."""
        if remarks is self._remarks:
            return
        self._remarks = remarks
        both = not any(self._labels.silences)
        told = ALIKE if not remarks.lost else ALIKE_LOST if remarks.right else ""
        self._update_labels(alike=tr(told).format(tr(self.HALVES)) if both and told else "")
        self.sheet.show_marks(*self._worst_region_marks(remarks.worst, arrays))

    def draw(self, scene: AnyScene, arrays: FrameArrays, estimated: np.ndarray | None, true: np.ndarray | None,
             t: float, speed: float, foreign: bool = False) -> None:
        """Draws a frame at t in s with sizes (P,) of errors or None, in one unit, and ``speed`` in simulated s/s."""
        room = self.sheet.stage_metrics
        if room is not self._stage_metrics and room != self._stage_metrics:
            self._lay_out()
        if scene != self._drawn_scene or foreign or self._foreign:
            self._drawn_scene, self._foreign = scene, foreign
            at_rest = arrays.position - arrays.displacement if foreign else None
            self.sheet.show_marks(*self._static_marks(scene, len(arrays.position), at_rest))
            self._select_marked_particles(len(arrays.position))
            self._update_labels(note=self.scale_note(scene))
        unknown, count = self._layout.stage_metrics.palette.unknown, len(arrays.position)
        since = arrays.steps_since_crossing
        with np.errstate(all="ignore"):  # a run gone bad holds anything
            halves = [error_colours(self._scale, sizes, count, unknown) for sizes in (estimated, true)]
            crossed = is_recent_crossing(since, scene, speed) & self._marked
            marks = [*self._moving_marks(scene, arrays, halves[0], halves[1], t, crossed,
                                         crossing_ages(since[crossed], scene, speed))]
            if self.plotted:
                at, shown = self._plot_axis_positions(arrays), halves[1] if true is not None else halves[0]
                marks += self._field.draw(self._layout, scene, self.plotted, self.magnified, at, arrays.plotted, t,
                                          crossed, shown)
            self.sheet.show_marks(*marks)

    def _select_marked_particles(self, particles: int) -> None:
        """Selects the particles whose crossings are marked, few enough not to hide the rest, and shows the legend."""
        every = marking_stride(particles, self.MOST_MARKED)
        self._marked = np.arange(particles) % every == 0
        self._update_labels(crossings=crossing_marks_legend(self.MARKED, every))

    def _update_labels(self, **changes: Any) -> None:
        """Updates labels whose text or position has changed."""
        if any(getattr(self._labels, name) != value for name, value in changes.items()):
            self._labels = replace(self._labels, **changes)
        if (now := (self._labels, self._layout)) != self._shown:
            self._shown = now
            self.sheet.show_marks(*self.labels(*now))

    @staticmethod
    @abstractmethod
    def layout(room: StageMetrics, seat: RunSlot) -> Any:
        """Returns the layout (:class:`~app.frame.layout.StageLayout` or a subclass) in settled bounds."""

    @staticmethod
    @abstractmethod
    def labels(words: StageLabels, places: Any) -> Iterator[Label]:
        """Yields all labels except the scale's and the plot's numbers, and remarks."""

    @staticmethod
    def max_radius(scene: AnyScene) -> float | None:
        """Returns how far from the middle particles get, in m; None in one dimension."""
        return None

    @staticmethod
    def scale_note(scene: AnyScene) -> str:
        """Returns a note on the scale of the drawing and whatever else the stage does not show."""
        return ""

    @classmethod
    def particle_shape(cls, scene: AnyScene) -> tuple[Literal["circle", "square"], float] | None:
        """Returns a particle's shape in a plane body and its size in m, so that particles tile the body."""
        return None

    @staticmethod
    def cell_edge_position(scene: AnyScene) -> float:
        """Returns the position of a line between cells, in m from the middle."""
        return 0.0

    @staticmethod
    def exact_material_lines(scene: AnyScene, t: float, count: int) -> np.ndarray:
        """Returns the first ``count`` material ``LINES`` of the exact solution, (count, n, 2) in m, at t in s."""
        return np.empty((0, 0, 2))

    @abstractmethod
    def particles_in(self, low: tuple[float, float], high: tuple[float, float], arrays: FrameArrays) -> np.ndarray:
        """Returns which particles (P,) lie in the rectangle from ``low`` to ``high`` of the stage."""

    def nearest_particle(self, point: tuple[float, float], arrays: FrameArrays) -> int | None:
        """Returns the index of the particle drawn nearest to a point of the stage; None if none is near."""
        apart = np.linalg.norm(self.drawn_particle_points(arrays, slice(None))[:, :, :2] - point, axis=2)
        image, particle = np.unravel_index(np.argmin(np.nan_to_num(apart, nan=np.inf)), apart.shape)
        return int(particle) if apart[image, particle] < TOUCH else None

    @abstractmethod
    def drawn_particle_points(self, arrays: FrameArrays, particles: slice) -> np.ndarray:
        """Returns all points of the stage where n particles are drawn, (images, n, 3)."""

    @abstractmethod
    def _static_marks(self, scene: AnyScene, particles: int, at_rest: np.ndarray | None) -> Iterator[Mark]:
        """Yields marks that stay while a scene runs. Particles of a foreign one began ``at_rest`` (P, D)."""

    @abstractmethod
    def _moving_marks(self, scene: AnyScene, arrays: FrameArrays, estimated: np.ndarray, true: np.ndarray, t: float,
                      crossed: np.ndarray, age: np.ndarray) -> Iterator[Mark]:
        """Yields marks that move, with colours (P, 3) of both errors, crossed particles (P,) and their ages (n,)."""

    @abstractmethod
    def _plot_axis_positions(self, arrays: FrameArrays) -> np.ndarray:
        """Returns the particles' positions (P,) along the axis of the field plot, in m."""

    @abstractmethod
    def _worst_region_marks(self, worst: tuple[WorstRegionMark | None, WorstRegionMark | None],
                            arrays: FrameArrays) -> Iterator[Mark]:
        """Yields marks at the worst regions of estimate and truth, always the same number of marks."""


def marking_stride(particles: int, most: int) -> int:
    """Returns n such that marking every n-th particle marks at most ``most``."""
    return -(-particles // most)
