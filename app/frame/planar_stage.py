"""Stages of plane problems: a body on its cells, the particles' domains, and the error plot beside it."""

from abc import abstractmethod
from collections.abc import Iterator
from typing import Any, ClassVar, Literal, TypeVar

import numpy as np

from app.frame.error_plot import ErrorPlot, ErrorPlotDefinition, error_plot_labels
from app.frame.layout import ComparedRunSlot
from app.frame.planar_layout import AROUND, PlanarLayout, make_planar_layout, planar_labels
from app.frame.primitives import Dots, Label, Lines, Mark, in_plane, join_points
from app.frame.stage import Stage, StageLabels, WorstRegionMark
from app.language.translation import lazy
from solvers.engine.shared_frames import FrameArrays
from solvers.problems.planar.particle_layout import half_edges, particle_layout
from solvers.problems.planar.scene import PlanarScene

FARTHEST = 2.0  # metres from the middle, out of view: clip for particles of a broken run
MOST_DOMAINS = 5000  # particles with domains drawn: more would be a grey area
#: Shape of a particle, and its size over that at rest, so that the particles tile the body.
FILLED: dict[str, tuple[Literal["circle", "square"], float]] = {"polar": ("circle", 1.5), "cartesian": ("square", 1.06),
                                                                "box": ("square", 1.06)}
#: In pixels: width of the ring around a particle that crossed a cell boundary, length of a dash of the line between the
#: halves, and distance of the mark of a worst region from the region.
RING, DASH, AWAY = 1.75, 5.0, 5.0
BELOW = np.array([0, 0, 0.002], np.float32)
PlaneScene = TypeVar("PlaneScene", bound=PlanarScene)
Mirrors = tuple[tuple[int, int], ...]
QUARTERS: Mirrors = ((1, 1), (1, -1), (-1, 1), (-1, -1))  # the first two are the truth's half
WHOLE: Mirrors = ((1, 1),)


class PlanarStage(Stage[PlaneScene]):
    """Stage of a plane problem: the body with the estimate in its left half and the truth in its right one, and the
    plot of both errors beside it. A quarter is drawn with its mirror images."""

    PLOT: ClassVar[ErrorPlotDefinition]

    MIRRORS: ClassVar[Mirrors] = QUARTERS
    OUTLINED: ClassVar[Mirrors] = QUARTERS[::2]
    DOMAINS_HINT = lazy("outline the domain of each particle: a box for GIMP, a parallelogram for CPDI; up to 5,000 "
                        "particles")
    MOST_MARKED, HALVES = 24, lazy("Halves")

    @staticmethod
    @abstractmethod
    def max_radius(scene: Any) -> float:
        """Returns how far from the middle particles get, in m."""

    @staticmethod
    def half_edge_vectors(scene: Any, F: np.ndarray) -> np.ndarray:
        """Returns half edge vectors (P, 2, 2) in m, in rows, of all domains for deformation gradients F (P, 2, 2)."""
        return half_edges(scene, F, particle_layout(scene).edges)

    layout = staticmethod(make_planar_layout)

    @classmethod
    def labels(cls, words: StageLabels, places: PlanarLayout) -> Iterator[Label]:
        yield from planar_labels(words, places)
        yield from error_plot_labels(places.plot, places.stage_metrics, cls.PLOT, words.titles)

    def particles_in(self, low: tuple[float, float], high: tuple[float, float], arrays: FrameArrays) -> np.ndarray:
        """Returns which particles lie, or have a mirror image, in the rectangle with the lower left corner ``low`` and
        the upper right one ``high``, in stage coordinates: (P,) of bool."""
        images = self._mirror_images(arrays.position, self.MIRRORS).reshape(len(self.MIRRORS), -1, 3)[:, :, :2]
        return np.any(np.all((images >= low) & (images <= high), axis=2), axis=0)

    def drawn_particle_points(self, arrays: FrameArrays, particles: slice) -> np.ndarray:
        x = clip_to_view(arrays.position[particles])
        return np.concatenate([self._mirror_images(x, self.MIRRORS).reshape(len(self.MIRRORS), -1, 3),
                               self._plot.dot_positions(particles, len(x))[None]])

    def _static_marks(self, scene: PlaneScene, particles: int, at_rest: np.ndarray | None) -> Iterator[Mark]:
        reach, places, colours = self.max_radius(scene), self._layout, self._layout.stage_metrics.palette
        self._middle, self._per_metre = places.middle, places.radius / reach
        end = AROUND * reach
        start = self.cell_edge_position(scene)
        at = np.arange(np.ceil((-end - start) / scene.spacing), np.floor((end - start) / scene.spacing) + 1)
        at = at * scene.spacing + start
        upright = np.stack([np.repeat(at, 2), np.tile([-end, end], len(at))], axis=1)
        yield Lines("cells", self._segments(np.concatenate([upright, upright[:, ::-1]]), -0.02), colours.grid, 1.0)
        self._shape, size = self.particle_shape(scene)
        self._width = size * self._per_metre
        self._ink = np.array(colours.crossing, np.uint8)
        self._edges = None
        if at_rest is None:
            layout = particle_layout(scene)
            at_rest, self._edges = layout.position, layout.edges if scene.particles <= MOST_DOMAINS else None
        self._plotted_at = self.plot_axis_positions(scene, at_rest)

    @staticmethod
    def cell_edge_position(scene: Any) -> float:
        return 0.0 if scene.PLANES[0] else 0.5 * scene.spacing * (scene.cells % 2)

    @classmethod
    def particle_shape(cls, scene: Any) -> tuple[Literal["circle", "square"], float]:
        shape, size = FILLED[scene.layout]
        return shape, size * scene.spacing / scene.ppc * cls.max_stretch(scene)

    @staticmethod
    def max_stretch(scene: Any) -> float:
        """Returns about how many times as wide as at rest a particle's domain becomes."""
        return 1.0

    @abstractmethod
    def _wall_heights(self, x: np.ndarray) -> list[tuple[float, float]]:
        """Returns the parts, each from y to y in m, of the line x = 0 that are in the body of particles at x (P, 2)."""

    @abstractmethod
    def _region_outline(self, x: np.ndarray, region: np.ndarray) -> np.ndarray:
        """Returns segments (n, 2, 2), in m, that mark a region with particles at ``region`` (k, 2), of those of the
        whole body at x (P, 2), without covering it."""

    @abstractmethod
    def _worst_labels(self, sizes: str, x: np.ndarray) -> Iterator[Label]:
        """Yields the labels of the worst regions' errors with a text of their ``sizes``, "" for none, beside or within
        the body of particles at x (P, 2) in m."""

    def _make_plot(self, beside: "PlanarStage | None") -> ErrorPlot:
        return ErrorPlot(self.PLOT, self._scale)

    def _plot_marks(self, scene: PlaneScene, arrays: FrameArrays, sizes: tuple[np.ndarray | None, np.ndarray | None],
                    t: float, crossed: np.ndarray) -> Iterator[Mark]:
        return self._plot.draw(self._layout.plot, self._layout.stage_metrics, self.plotted, self._plotted_at, *sizes)

    def _moving_marks(self, scene: PlaneScene, arrays: FrameArrays, estimated: np.ndarray, true: np.ndarray, t: float,
                      crossed: np.ndarray) -> Iterator[Mark]:
        x = clip_to_view(arrays.position)
        yield from self._particle_marks(x, estimated, true)
        size = self._width + 2 * RING * self._layout.stage_metrics.pixel
        yield Dots("around", self._mirror_images(x[crossed], self.MIRRORS, 0.018) - BELOW, self._ink, size)
        yield from self._particle_marks(x[crossed], estimated[crossed], true[crossed], "crossed-", 0.018)
        yield self._particle_domain_outlines(scene, arrays, x)
        yield self._dividing_line(x)

    def _dividing_line(self, x: np.ndarray) -> Lines:
        """Returns the line between the halves, where it is in the body of particles at x (P, 2) in m: in dashes, dark
        and light by turns, so that it is seen on particles of any colour."""
        metrics, parts, colours = self._layout.stage_metrics, list[np.ndarray](), list[np.ndarray]()
        inks = np.array([metrics.palette.dot, metrics.palette.ground], np.uint8)
        for low, high in self._wall_heights(x):
            ends = np.linspace(low, high, 2 + int((high - low) * self._per_metre / (DASH * metrics.pixel)))
            heights = np.stack([ends[:-1], ends[1:]], axis=1)
            parts.append(np.stack([np.zeros_like(heights), heights], axis=2))
            colours.append(np.repeat(inks[np.arange(len(heights)) % 2, None], 2, axis=1))
        return Lines("planes", self._segments(np.concatenate(parts), 0.012), np.concatenate(colours), 1.5)

    def _worst_region_marks(self, worst: tuple[WorstRegionMark | None, WorstRegionMark | None],
                            arrays: FrameArrays) -> Iterator[Mark]:
        """Yields an outline of the worst region of each half, if any, and the sizes of their errors."""
        places, segments, sizes = self._layout, [np.empty((0, 2, 2))], list[str]()
        x = clip_to_view(arrays.position)
        for found, sign in zip(worst, (-1, 1), strict=True):
            if found is None or places.slot != ComparedRunSlot.ALONE:
                continue
            region = x[found.particles]
            if not len(region):
                continue
            half = np.array([sign, 1])
            if self.MIRRORS == WHOLE:  # turned by half a turn, unless it is in its own half
                half = np.ones(2) if sign * region[:, 0].mean() >= 0 else -np.ones(2)
            segments.append(half * self._region_outline(x, region))
            sizes.append(found.size)
        yield from self._worst_labels(" | ".join(dict.fromkeys(sizes)), x)
        yield Lines("worst", self._segments(np.concatenate(segments), 0.02), places.stage_metrics.palette.dot, 2.0)

    def _particle_marks(self, x: np.ndarray, estimated: np.ndarray, true: np.ndarray, name: str = "",
                        depth: float = 0.0) -> Iterator[Mark]:
        """Yields dots for the particles at x (P, 2) in m, in the colours (P, 3) of estimated and true errors."""
        if self.MIRRORS == WHOLE:
            colours = np.where(x[:, :1] < 0, estimated, true)
            yield Dots(f"{name}particles", self._mirror_images(x, self.MIRRORS, depth), colours, self._width,
                       self._shape)
            return
        for half, mirrors, shades in (("truth", self.MIRRORS[:2], true), ("estimate", self.MIRRORS[2:], estimated)):
            yield Dots(f"{name}{half}", self._mirror_images(x, mirrors, depth), np.tile(shades, (2, 1)), self._width,
                       self._shape)

    def _particle_domain_outlines(self, scene: PlaneScene, arrays: FrameArrays, x: np.ndarray) -> Lines:
        """Returns outlines of the domains of particles at ``x`` (P, 2) in m: boxes for GIMP, parallelograms for CPDI;
        no segments unless ``domains`` is set."""
        outlines = np.empty((0, 2, 3), np.float32)
        if self.domains and self._edges is not None and len(x) == len(self._edges):
            F = arrays.deformation_gradient.reshape(-1, 2, 2)
            first, second = np.moveaxis(half_edges(scene, F, self._edges), 1, 0)
            corners = [x - first - second, x + first - second, x + first + second, x - first + second]
            placed = [self._mirror_images(corner, self.OUTLINED, 0.01) for corner in corners]
            outlines = np.concatenate([join_points(placed[k - 1], placed[k]) for k in range(4)])
        return Lines("domains", outlines, self._layout.stage_metrics.palette.outline, 1.2)

    def _to_stage(self, x: np.ndarray, depth: float = 0.0) -> np.ndarray:
        """Returns points (n, 3) of the stage, at the z ``depth``, for positions (n, 2) in m from the middle."""
        return in_plane(self._middle[0] + self._per_metre * x[:, 0], self._middle[1] + self._per_metre * x[:, 1], depth)

    def _segments(self, ends: np.ndarray, depth: float) -> np.ndarray:
        """Returns segments (n, 2, 3) of the stage, at the z ``depth``, for ``ends`` (n, 2, 2) in m from the middle."""
        return self._to_stage(ends.reshape(-1, 2), depth).reshape(-1, 2, 3)

    def _mirror_images(self, x: np.ndarray, mirrors: Mirrors, depth: float = 0.0) -> np.ndarray:
        """Returns the mirror images, whose signs of x and y are ``mirrors``, of positions (n, 2) in m, as points of the
        stage (len(mirrors) n, 3), image by image. Written in place, as it runs with every frame."""
        out = np.empty((len(mirrors), len(x), 3), np.float32)
        out[:, :, 2] = depth
        for axis in range(2):
            from_middle = np.float32(self._per_metre) * x[:, axis]
            sides = {1: self._middle[axis] + from_middle, -1: self._middle[axis] - from_middle}
            for image, mirror in zip(out, mirrors, strict=True):
                image[:, axis] = sides[mirror[axis]]
        return out.reshape(-1, 3)


def clip_to_view(x: np.ndarray) -> np.ndarray:
    """Returns positions (n, 2) in m from the middle, with components clipped to ±2 m, out of view; NaN becomes 2 m."""
    return np.fmax(np.fmin(x, FARTHEST), -FARTHEST)
