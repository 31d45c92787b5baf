"""Stages of all problems: two halves, estimate and truth, each with a title or the reason why it is empty."""

from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Generic, Literal, TypeVar

import numpy as np

from app.frame.colour_scale import ColourScale
from app.frame.error_view_captions import ALIKE, ALIKE_LOST, StageHalfErrors, crossing_marks_legend
from app.frame.layout import ComparedRunSlot, Rectangle
from app.frame.primitives import SEPARATOR, Label, Mark, Spans, StageMetrics, Surface, error_colours
from app.language.translation import lazy, tr
from app.names_and_units import short_reason
from solvers.engine.shared_frames import FrameArrays
from solvers.scene.scene import Scene

AnyScene = TypeVar("AnyScene", bound=Scene)
TOUCH = 0.03  # distance on the stage within which a click selects a particle: wide enough for a finger
MOST_CHANGED = 0.4  # share of the particles: rings around more that have changed their cell would hide the rest
TITLE_SIZE = 1.08  # of the letters of a title
WIDEST_TITLE = 0.86  # width of the words of a title, as a share of the stage's, from which some are left out:
LEFT_OUT = ("settings", "duration", "what", "who")  # kinds of spans, the first ones first
Names = tuple[str, str]  # of the estimate and of the truth


@dataclass(frozen=True)
class StageLabels:
    """Texts of the labels on a stage: of the estimate's and the truth's half, the ``titles``, the sources ``by`` which
    the errors are known and the reasons why they are empty (``silences``); besides, the run's ``name``, the ``facts``
    at the other end of that line, and what the run could be ``compared`` with if it is alone; the note on the scale of
    the drawing, the legends of marks at crossings and of the curve ``before`` a change, and the hint about two halves
    that look alike."""

    titles: Names = ("", "")
    by: Names = ("", "")
    silences: Names = ("", "")
    name: Spans = ()
    facts: Spans = ()
    compared: Spans = ()
    note: str = ""
    crossings: str = ""
    before: str = ""
    alike: str = ""


@dataclass(frozen=True, eq=False)
class WorstRegionMark:
    """Region of the body with the largest error: its ``particles`` (P,) of bool, and the error's ``size`` as text."""

    particles: np.ndarray
    size: str


@dataclass(frozen=True, eq=False)
class WorstRegionAnnotations:
    """Notes in a picture: the ``worst`` regions of estimate and truth, None if there is none or it is not wanted,
    whether the run is ``lost``, and whether the estimate is ``right`` nevertheless."""

    worst: tuple[WorstRegionMark | None, WorstRegionMark | None] = (None, None)
    lost: bool = False
    right: bool = False


NOTHING = WorstRegionAnnotations()


class Stage(ABC, Generic[AnyScene]):
    """Stage that draws frames of a problem's runs on the surface ``sheet``; halves and colour bar share a ``scale``.

    The attribute ``domains`` sets whether the particles' domains are outlined, if supported; ``plotted`` is the key of
    the quantity that is plotted, None for no plot, and ``magnified`` the factor of its drawn deviation from the
    exact one. A pinned run has a stage of its own, ``beside`` the first; their field plots share a value axis."""

    HIGH: ClassVar[tuple[float, float]] = (0.3, 0.9)  # least and greatest height of the stage
    PLOT: ClassVar[Any]  # settings of the plot: a FieldPlotDefinition or an ErrorPlotDefinition
    MOST_MARKED: ClassVar[int]  # particles whose crossings are marked
    LINES: ClassVar[int] = 0  # material lines drawn by the exact solution
    MARKED: ClassVar[str] = lazy("has changed its cell")  # legend of the marks
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
        self._slot = ComparedRunSlot.SECOND if beside else ComparedRunSlot.ALONE
        self._second: Stage[AnyScene] | None = None
        self._labels, self._shown = StageLabels(), (StageLabels(), None)
        self._captioned: tuple | None = None  # arguments of the present captions
        self._remarks: WorstRegionAnnotations | None = None
        self._plot = self._make_plot(beside)
        self._lay_out()

    @abstractmethod
    def _make_plot(self, beside: Any) -> Any:
        """Returns the plot of the run, which shares its value axis with that of the stage ``beside``, if any."""

    def _lay_out(self) -> None:
        """Computes the layout for the surface's present metrics; all is drawn anew."""
        self._stage_metrics = self.sheet.stage_metrics
        metrics = self._stage_metrics.rounded()
        low, high = self.HIGH
        self._layout = self._layout_for(replace(metrics, high=min(max(metrics.high, low), high)))
        self._drawn_scene, self._remarks = None, None

    def _layout_for(self, metrics: StageMetrics) -> Any:
        """Returns the layout of the run in its present slot; ``metrics`` are rounded."""
        return self.layout(metrics, self._slot)

    def pinned_run_stage(self, wanted: bool) -> "Stage | None":
        """Makes space for a pinned run beside this one and returns that run's stage if ``wanted``; otherwise takes the
        space back, hides that stage and returns None."""
        if wanted != (self._slot == ComparedRunSlot.FIRST):
            self._slot = ComparedRunSlot.FIRST if wanted else ComparedRunSlot.ALONE
            self._lay_out()
            self._second = self._second or type(self)(self.sheet.add_child("pinned"), self._scale, self)
            self._second.sheet.visible = wanted
        return self._second if wanted else None

    @property
    def rectangle(self) -> Rectangle:
        """Rectangle of everything drawn, without names in the gutter: x0, x1, y0, y1 in stage coordinates."""
        self._fit_surface()
        return self._layout.rectangle

    def _fit_surface(self) -> None:
        """Computes the layout anew if the surface's metrics have changed."""
        metrics = self.sheet.stage_metrics
        if metrics is not self._stage_metrics and metrics != self._stage_metrics:
            self._lay_out()

    @property
    def shared_axis_changed(self) -> bool:
        """Whether the stage must be redrawn because the run beside it has changed the value axis of their plots."""
        return self._plot.shared_axis_changed

    @property
    def is_outdated(self) -> bool:
        """Whether the stage has to be drawn again, although no frame has come."""
        return self._plot.is_outdated

    def show_title(self, name: Spans, facts: Spans, compared: Spans) -> None:
        """Shows the run's title: its name, facts about it, and what it could be compared with if it is alone."""
        self._fit_surface()
        self._update_labels(name=name, facts=facts, compared=compared)

    def show_captions(self, estimate: StageHalfErrors, truth: StageHalfErrors) -> None:
        """Shows titles and sources of both halves, and the reason in an empty one, shortened beside another run."""
        captions = self._slot, estimate.title, estimate.by, estimate.silence, truth.title, truth.by, truth.silence
        if captions == self._captioned:
            return
        self._captioned, alone = captions, self._slot == ComparedRunSlot.ALONE
        silences = tuple(half.silence if alone else short_reason(half.silence) for half in (estimate, truth))
        self._update_labels(titles=(estimate.title, truth.title), by=(estimate.by, truth.by), silences=silences)

    def annotate(self, remarks: WorstRegionAnnotations, arrays: FrameArrays) -> None:
        """Shows annotations at the particles of a frame's ``arrays``; the same object a second time changes nothing."""
        if remarks is self._remarks:
            return
        self._remarks = remarks
        both = not any(self._labels.silences)
        told = ALIKE if not remarks.lost else ALIKE_LOST if remarks.right else ""
        self._update_labels(alike=tr(told).format(tr(self.HALVES)) if both and told else "")
        self.sheet.show_marks(*self._worst_region_marks(remarks.worst, arrays))

    def draw(self, scene: AnyScene, arrays: FrameArrays, estimated: np.ndarray | None, true: np.ndarray | None,
             t: float, foreign: bool = False) -> None:
        """Draws the frame of a scene at the time t in s.

        ``estimated`` and ``true`` are the sizes (P,) of both errors in one unit, or None; ``foreign`` is whether the
        particles are not the scene's own but come from a file of another code."""
        self._fit_surface()
        if scene != self._drawn_scene or foreign or self._foreign:
            self._drawn_scene, self._foreign = scene, foreign
            at_rest = arrays.position - arrays.displacement if foreign else None
            self.sheet.show_marks(*self._static_marks(scene, len(arrays.position), at_rest))
            self._update_labels(note=self.scale_note(scene))
        unknown, count = self._layout.stage_metrics.palette.unknown, len(arrays.position)
        with np.errstate(all="ignore"):  # a run gone bad holds anything
            halves = [error_colours(self._scale, sizes, count, unknown) for sizes in (estimated, true)]
            crossed = self._particles_to_mark(arrays.steps_since_crossing)
            marks = [*self._moving_marks(scene, arrays, halves[0], halves[1], t, crossed)]
            if self.plotted:
                marks += self._plot_marks(scene, arrays, (estimated, true), t, crossed)
            self.sheet.show_marks(*marks)

    def _particles_to_mark(self, since: np.ndarray) -> np.ndarray:
        """Returns which particles are marked as having changed their cell since the start, (P,) of bool, from the steps
        ``since`` the last time, (P,), -1 for never; none if these are too many to see."""
        changed, stride = since >= 0, marking_stride(len(since), self.MOST_MARKED)
        many = np.count_nonzero(changed) > MOST_CHANGED * len(changed)
        self._update_labels(crossings=tr("nearly all changed cell") if many else
                            crossing_marks_legend(self.MARKED, stride))
        return np.zeros(len(changed), bool) if many else changed & (np.arange(len(since)) % stride == 0)

    def _update_labels(self, **changes: Any) -> None:
        """Changes fields of :class:`StageLabels`; draws the labels if a text or the layout has changed."""
        if any(getattr(self._labels, name) != value for name, value in changes.items()):
            self._labels = replace(self._labels, **changes)
        if self._shown[0] is not self._labels or self._shown[1] is not self._layout:  # both are replaced by changes
            self._shown = self._labels, self._layout
            self.sheet.show_marks(*self.labels(*self._shown))

    @staticmethod
    @abstractmethod
    def layout(metrics: StageMetrics, slot: ComparedRunSlot) -> Any:
        """Returns the :class:`~app.frame.layout.StageLayout` of a run in a slot of a stage; ``metrics`` are rounded."""

    @classmethod
    @abstractmethod
    def labels(cls, words: StageLabels, places: Any) -> Iterator[Label]:
        """Yields the labels of halves, run and marks, with texts from ``words``, at their places in a layout."""

    @staticmethod
    def max_radius(scene: AnyScene) -> float | None:
        """Returns the largest distance of particles from the middle during a run, in m; None in one dimension."""
        return None

    @staticmethod
    def scale_note(scene: AnyScene) -> str:
        """Returns a note, in the visitor's language, on the scale of the drawing: sizes in m of body and cells."""
        return ""

    @classmethod
    def particle_shape(cls, scene: AnyScene) -> tuple[Literal["circle", "square"], float] | None:
        """Returns shape and size in m of a plane body's particles, so that they tile the body; None for the bar."""
        return None

    @staticmethod
    def cell_edge_position(scene: AnyScene) -> float:
        """Returns the position, in m from the middle and along either axis, of one of the lines between cells."""
        return 0.0

    @staticmethod
    def exact_material_lines(scene: AnyScene, t: float, count: int) -> np.ndarray:
        """Returns points (count, n, 2) in m of the first ``count`` exact material ``LINES`` at the time t in s."""
        return np.empty((0, 0, 2))

    @abstractmethod
    def particles_in(self, low: tuple[float, float], high: tuple[float, float], arrays: FrameArrays) -> np.ndarray:
        """Returns which particles lie in the stage's rectangle from ``low``, lower left, to ``high``: (P,) of bool."""

    def nearest_particle(self, point: tuple[float, float], arrays: FrameArrays) -> int | None:
        """Returns the index of the particle drawn nearest to a point in stage coordinates; None if none is near."""
        apart = np.linalg.norm(self.drawn_particle_points(arrays, slice(None))[:, :, :2] - point, axis=2)
        image, particle = np.unravel_index(np.argmin(np.nan_to_num(apart, nan=np.inf)), apart.shape)
        return int(particle) if apart[image, particle] < TOUCH else None

    @abstractmethod
    def drawn_particle_points(self, arrays: FrameArrays, particles: slice) -> np.ndarray:
        """Returns stage points (images, n, 3) of n particles (a slice), in halves or images, and in the field plot."""

    @abstractmethod
    def _static_marks(self, scene: AnyScene, particles: int, at_rest: np.ndarray | None) -> Iterator[Mark]:
        """Yields marks that stay while a scene runs. ``at_rest`` (P, D) are the positions in m at rest of particles
        from a file of another code, None for the scene's own."""

    @abstractmethod
    def _moving_marks(self, scene: AnyScene, arrays: FrameArrays, estimated: np.ndarray, true: np.ndarray, t: float,
                      crossed: np.ndarray) -> Iterator[Mark]:
        """Yields marks that move, at the time t in s, with the colours (P, 3) of the ``estimated`` and ``true`` errors;
        ``crossed`` (P,) of bool are particles to be marked, which crossed a cell boundary."""

    @staticmethod
    @abstractmethod
    def plot_axis_positions(scene: AnyScene, X: np.ndarray) -> np.ndarray:
        """Returns the positions (P,) along the axis of the plot, in m at rest, of particles at X (P,) or (P, 2) in m at
        rest; NaN for those not plotted."""

    @abstractmethod
    def _plot_marks(self, scene: AnyScene, arrays: FrameArrays, sizes: tuple[np.ndarray | None, np.ndarray | None],
                    t: float, crossed: np.ndarray) -> Iterator[Mark]:
        """Yields the marks of the plot at the time t in s, with the ``sizes`` (P,) of the estimated and the true errors
        in their unit, None if unknown; ``crossed`` as in :meth:`_moving_marks`."""

    @abstractmethod
    def _worst_region_marks(self, worst: tuple[WorstRegionMark | None, WorstRegionMark | None],
                            arrays: FrameArrays) -> Iterator[Mark]:
        """Yields marks at the ``worst`` regions of estimate and truth in a frame, always the same number of marks."""


def title_labels(words: StageLabels, metrics: StageMetrics, y: float) -> Iterator[Label]:
    """Yields the labels of a run's title in a line at the height y: its name at the left, facts at the right. What does
    not fit is left out, by kinds of spans."""
    name, facts = fit_spans((words.name, words.facts), metrics, WIDEST_TITLE)
    yield Label.of_spans("name", name, 0.0, y, "center-left", "name", size=TITLE_SIZE)
    yield Label.of_spans("facts", facts, 1.0, y, "center-right", "note", size=TITLE_SIZE)


def fit_spans(parts: tuple[Spans, ...], metrics: StageMetrics, width: float) -> tuple[Spans, ...]:
    """Returns parts of a line with as many kinds of their spans left out as they need to fit into a stage width."""
    for kind in LEFT_OUT:
        if metrics.text_width("".join(text for spans in parts for _, text in spans)) <= width:
            break
        parts = tuple(_without_kind(spans, kind) for spans in parts)
    return parts


def _without_kind(spans: Spans, kind: str) -> Spans:
    """Returns spans without those of a kind; a separator before a last one goes with it."""
    kept: list[tuple[str, str]] = []
    for k, (own, text) in enumerate(spans):
        if own != kind:
            kept.append((own, text.lstrip() if k and spans[k - 1][0] == kind else text))
    return tuple(kept[:-1] if kept and kept[-1] == SEPARATOR else kept)


def marking_stride(particles: int, most: int) -> int:
    """Returns the least n such that every n-th of so many particles is at most ``most`` particles."""
    return -(-particles // most)
