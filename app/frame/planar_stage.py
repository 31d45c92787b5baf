"""Stages of plane problems: a body on its cells, the particles' domains, and the field plot beside it."""

from abc import abstractmethod
from collections.abc import Iterator
from typing import Any, ClassVar, Literal, TypeVar

import numpy as np

from app.frame.layout import EDGE, ComparedRunSlot
from app.frame.planar_layout import AROUND, make_planar_layout, planar_labels
from app.frame.primitives import Dots, Label, Lines, Mark, in_plane, join_points
from app.frame.stage import Stage, WorstRegionMark
from app.language.translation import lazy, tr
from solvers.engine.shared_frames import FrameArrays
from solvers.problems.planar.particle_layout import half_edges, particle_layout
from solvers.problems.planar.scene import PlanarScene

FARTHEST = 2.0  # metres from the middle, out of view: clip for particles of a broken run
MOST_DOMAINS = 5000  # particles with domains drawn: more would be a grey area
#: Shape of a particle, and its size over that at rest, so that the particles tile the body.
FILLED: dict[str, tuple[Literal["circle", "square"], float]] = {"polar": ("circle", 1.5), "cartesian": ("square", 1.06),
                                                                "box": ("square", 1.06)}
CROSSED, HALO = 5.5, 8.0  # diameters in pixels of a particle that crossed a cell boundary, and of its halo
BELOW = np.array([0, 0, 0.002], np.float32)
ROOMY = 130.0  # radius in pixels of a body from which these have full size
PlaneScene = TypeVar("PlaneScene", bound=PlanarScene)
Mirrors = tuple[tuple[int, int], ...]
QUARTERS: Mirrors = ((1, 1), (1, -1), (-1, 1), (-1, -1))  # the first two are the truth's half
WHOLE: Mirrors = ((1, 1),)


class PlanarStage(Stage[PlaneScene]):
    """Stage of a plane problem: the body with the estimate in its left half and the truth in its right one, and the
    field plot beside it. A quarter is drawn with its mirror images."""

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

    layout, labels = staticmethod(make_planar_layout), staticmethod(planar_labels)

    def particles_in(self, low: tuple[float, float], high: tuple[float, float], arrays: FrameArrays) -> np.ndarray:
        """Returns which particles lie, or have a mirror image, in the rectangle with the lower left corner ``low`` and
        the upper right one ``high``, in stage coordinates: (P,) of bool."""
        images = self._mirror_images(arrays.position, self.MIRRORS).reshape(len(self.MIRRORS), -1, 3)[:, :, :2]
        return np.any(np.all((images >= low) & (images <= high), axis=2), axis=0)

    def drawn_particle_points(self, arrays: FrameArrays, particles: slice) -> np.ndarray:
        x = clip_to_view(arrays.position[particles])
        return np.concatenate([self._mirror_images(x, self.MIRRORS).reshape(len(self.MIRRORS), -1, 3),
                               self._field.dot_positions(particles, len(x))[None]])

    def _static_marks(self, scene: PlaneScene, particles: int, at_rest: np.ndarray | None) -> Iterator[Mark]:
        reach, places, colours = self.max_radius(scene), self._layout, self._layout.stage_metrics.palette
        self._middle, self._per_metre = places.middle, places.radius / reach
        end = AROUND * reach
        start = self.cell_edge_position(scene)
        at = np.arange(np.ceil((-end - start) / scene.spacing), np.floor((end - start) / scene.spacing) + 1)
        at = at * scene.spacing + start
        upright = np.stack([np.repeat(at, 2), np.tile([-end, end], len(at))], axis=1)
        yield Lines("cells", self._to_stage(np.concatenate([upright, upright[:, ::-1]]), -0.02).reshape(-1, 2, 3),
                    colours.grid, 1.0)
        yield Lines("planes", self._to_stage(np.array([[0, -end], [0, end]]), 0.012)[None], colours.dot, 1.2)
        self._shape, size = self.particle_shape(scene)
        self._width = size * self._per_metre
        self._ink = [np.array(colour, np.uint8) for colour in (colours.ground, colours.crossing)]
        self._edges = None
        if at_rest is None:
            layout = particle_layout(scene)
            self._radii = np.linalg.norm(layout.position, axis=1)
            self._edges = layout.edges if scene.particles <= MOST_DOMAINS else None
        else:
            self._radii = np.linalg.norm(at_rest, axis=1)

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

    def _plot_axis_positions(self, arrays: FrameArrays) -> np.ndarray:
        return self._radii

    def _moving_marks(self, scene: PlaneScene, arrays: FrameArrays, estimated: np.ndarray, true: np.ndarray, t: float,
                      crossed: np.ndarray) -> Iterator[Mark]:
        x = clip_to_view(arrays.position)
        yield from self._particle_marks(x, estimated, true)
        marks = self._mirror_images(x[crossed], self.MIRRORS, 0.018)
        pixel = self._layout.stage_metrics.pixel
        pixel *= min(1.0, self._layout.radius / (ROOMY * pixel))
        yield Dots("around", marks - BELOW, self._ink[0], HALO * pixel)
        yield Dots("crossings", marks, self._ink[1], CROSSED * pixel)
        yield self._particle_domain_outlines(scene, arrays, x)

    def _worst_region_marks(self, worst: tuple[WorstRegionMark | None, WorstRegionMark | None],
                            arrays: FrameArrays) -> Iterator[Mark]:
        """Yields a line from the worst region of each half, if any, to a label beside the body."""
        places, segments = self._layout, [np.empty((0, 2, 3), np.float32)]
        metrics, (x, y) = places.stage_metrics, places.middle
        wanted = places.slot == ComparedRunSlot.ALONE and metrics.gutter > 0
        for found, name, sign in zip(worst, ("estimate", "truth"), (-1, 1), strict=True):
            text, edge = "", x + AROUND * places.radius + 4 * metrics.pixel if sign > 0 else -EDGE
            at = clip_to_view(arrays.position)[found.particles] if found and wanted else np.empty((0, 2))
            height = y
            if found and len(at):
                upright = (1, 1) if self.MIRRORS == WHOLE else (sign, 1)
                place = self._mirror_images(at.mean(axis=0, keepdims=True), (upright,), 0.02)
                height = float(np.clip(place[0, 1], y + 3.2 * metrics.line_height, places.end - metrics.line_height))
                bend = in_plane(np.array([edge - (8 * metrics.pixel if sign > 0 else 0), edge]), height, 0.02)
                corners = np.concatenate([place, bend])
                segments.append(join_points(corners[:-1], corners[1:]))
                text = tr("worst: {size}", size=found.size)
            yield Label(f"{name}-worst", text, edge + 3 * sign * metrics.pixel, height,
                        "center-left" if sign > 0 else "center-right", "note", bold=True)
        yield Lines("worst", np.concatenate(segments), metrics.palette.dot, 1.5)

    def _particle_marks(self, x: np.ndarray, estimated: np.ndarray, true: np.ndarray) -> Iterator[Mark]:
        """Yields dots for the particles at x (P, 2) in m, in the colours (P, 3) of estimated and true errors."""
        if self.MIRRORS == WHOLE:
            colours = np.where(x[:, :1] < 0, estimated, true)
            yield Dots("particles", self._mirror_images(x, self.MIRRORS), colours, self._width, self._shape)
            return
        for half, mirrors, shades in (("truth", self.MIRRORS[:2], true), ("estimate", self.MIRRORS[2:], estimated)):
            yield Dots(half, self._mirror_images(x, mirrors), np.tile(shades, (2, 1)), self._width, self._shape)

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
