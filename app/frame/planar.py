"""What the stages of plane problems share: a body on its cells, its domains, and the field plot below."""

from abc import abstractmethod
from collections.abc import Iterator
from typing import Any, ClassVar, TypeVar

import numpy as np

from app.frame.marks import CELL, FLASH, RECTANGLE, Dots, Label, Lines, Mark, in_plane, joined
from app.frame.stage import Seat, Stage, Words
from solvers.engine.frames import FrameArrays
from solvers.problems.planar.layout import half_edges, particle_layout
from solvers.problems.planar.scene import PlanarScene

RADIUS = 0.44  # of the outermost the body should come, on the stage
FARTHEST = 2.0  # metres from the middle, out of view: where particles of a run gone bad are drawn at most
#: Middles of the body, and how much smaller it is than one alone.
PLACES = {Seat.ALONE: ((0.5, 0.44), 1.0), Seat.FIRST: ((0.185, 0.52), 0.58), Seat.SECOND: ((0.765, 0.52), 0.58)}
RAISED = 0.24  # is the field plot below two bodies
LOW = -0.41  # the lowest of what is drawn
MOST_DOMAINS = 5000  # particles whose domains are drawn: more would be a grey mass
GRID, OUTLINE, CROSSING = (225, 229, 234), (120, 125, 132), np.array(FLASH, np.uint8)
PlaneScene = TypeVar("PlaneScene", bound=PlanarScene)
Mirrors = tuple[tuple[int, int], ...]


class PlanarStage(Stage[PlaneScene]):
    """Makes marks of frames of a plane problem. Of a body with symmetry planes its mirror images are drawn too."""

    MIRRORS: ClassVar[Mirrors] = ((1, 1),)
    OUTLINED: ClassVar[Mirrors] = ((1, 1),)
    DOMAINS_HINT = "outline what each particle stands for: a box for GIMP, a parallelogram for CPDI; up to " \
                   f"{MOST_DOMAINS:,} particles"
    RECTANGLE = (*RECTANGLE[:2], LOW, RECTANGLE[3])
    PAIR_RECTANGLE = (*RECTANGLE[:2], LOW + RAISED, RECTANGLE[3])
    PLOT_DOT, PAIR_PLOT = 0.005, RAISED
    MARK_SECONDS = 0.04  # less than elsewhere: there are many at once
    ANCHORS: ClassVar = {"middle": PLACES[Seat.ALONE][0], "outermost": (0.5 + RADIUS, 0.44)}
    MOST_MARKED, MARKED = 320, "magenta: crossing a cell boundary"

    @staticmethod
    @abstractmethod
    def outermost(scene: Any) -> float:
        """How far from the middle a particle should come, in metres."""

    @staticmethod
    def domain_edges(scene: Any, F: np.ndarray) -> np.ndarray:
        """Half the edge vectors (P, 2, 2) in metres of the particles' domains for deformation gradients F (P, 2, 2)."""
        return half_edges(scene, F, particle_layout(scene).edges)

    @staticmethod
    def labels(words: Words, seat: Seat) -> Iterator[Label]:
        (x, y), size = PLACES[seat]
        side, high = 0.5 if seat == Seat.ALONE else 0.47, 0.515  # the body, at its largest, stays below
        yield Label("estimate-title", words.titles[0], x - size * side, y + size * high, "top-left", "title")
        yield Label("truth-title", words.titles[1], x + size * side, y + size * high, "top-right", "title")
        # These stand in the hole of a ring.
        yield Label("estimate-silence", words.silences[0], x - 0.015, y, "center-right", "silence", 0.85, 22)
        yield Label("truth-silence", words.silences[1], x + 0.015, y, "center-left", "silence", 0.85, 22)
        yield Label("run", words.run, x, y + size * 0.55, "bottom-center", "name", width=40)
        yield Label("size-note", words.note, x - 0.5 * size, y - 0.5 * size, "bottom-left", "note", 0.85)
        if seat != Seat.SECOND:
            low = y - 0.5 + 0.15 * (seat == Seat.FIRST)
            yield Label("crossings-note", words.crossings, x + 0.5, low, "bottom-right", "note", 0.85)

    def region(self, low: tuple[float, float], high: tuple[float, float], arrays: FrameArrays) -> np.ndarray:
        """Which particles (P,) lie, or have a mirror image, in the rectangle from ``low`` to ``high`` of the stage."""
        images = self._images(arrays.position, self.MIRRORS).reshape(len(self.MIRRORS), -1, 3)[:, :, :2]
        return np.any(np.all((images >= low) & (images <= high), axis=2), axis=0)

    def images(self, arrays: FrameArrays, particles: slice) -> np.ndarray:
        x = in_view(arrays.position[particles])
        return np.concatenate([self._images(x, self.MIRRORS).reshape(len(self.MIRRORS), -1, 3),
                               self._plot.places(particles, len(x))[None]])

    def _still(self, scene: PlaneScene, particles: int, at_rest: np.ndarray | None) -> Iterator[Mark]:
        reach, (self._middle, size) = self.outermost(scene), PLACES[self._seat]
        self._per_metre = size * RADIUS / reach
        end = 1.05 * reach
        start = self.first_line(scene)
        at = np.arange(np.ceil((-end - start) / scene.spacing), np.floor((end - start) / scene.spacing) + 1)
        at = at * scene.spacing + start
        upright = np.stack([np.repeat(at, 2), np.tile([-end, end], len(at))], axis=1)
        yield Lines("cells", self._place(np.concatenate([upright, upright[:, ::-1]]), -0.02).reshape(-1, 2, 3), GRID,
                    1.0)
        axes = np.array([[-end, 0], [end, 0], [0, -end], [0, end]])
        yield Lines("planes", self._place(axes, -0.01).reshape(2, 2, 3), CELL, 1.5)
        self._width = scene.spacing / scene.ppc * self._per_metre  # of a particle at rest, on the stage
        self._edges = None
        if at_rest is None:
            layout = particle_layout(scene)
            self._radii = layout.radii[layout.radius]
            self._edges = layout.edges if scene.particles <= MOST_DOMAINS else None
        else:
            self._radii = np.linalg.norm(at_rest, axis=1)

    def _moving(self, scene: PlaneScene, arrays: FrameArrays, estimated: np.ndarray | None, true: np.ndarray | None,
                t: float, speed: float) -> Iterator[Mark]:
        x = in_view(arrays.position)
        yield from self._halves(x, estimated, true)
        steps = arrays.steps_since_crossing
        just_crossed = (steps >= 0) & (steps < self.MARK_SECONDS * speed / scene.time_step) & self._marked
        yield Dots("crossings", self._images(x[just_crossed], self.MIRRORS, 0.02), CROSSING,
                   max(0.44 * self._width, 0.005))
        yield self._domains(scene, arrays, x)
        if self.plotted:
            yield from self._field.draw(scene, self.plotted, self.magnified, self._radii, arrays.plotted, t,
                                        just_crossed)

    @abstractmethod
    def _halves(self, x: np.ndarray, estimated: np.ndarray | None, true: np.ndarray | None) -> Iterator[Mark]:
        """The particles at ``x`` (P, 2) in metres, with the sizes of the two errors as colours."""

    def _domains(self, scene: PlaneScene, arrays: FrameArrays, x: np.ndarray) -> Lines:
        """Outlines of what each particle stands for: a box for GIMP, a parallelogram for CPDI."""
        outlines = np.empty((0, 2, 3), np.float32)
        if self.domains and self._edges is not None and len(x) == len(self._edges):
            F = arrays.deformation_gradient.reshape(-1, 2, 2)
            first, second = np.moveaxis(half_edges(scene, F, self._edges), 1, 0)
            corners = [x - first - second, x + first - second, x + first + second, x - first + second]
            placed = [self._images(corner, self.OUTLINED, 0.01) for corner in corners]
            outlines = np.concatenate([joined(placed[k - 1], placed[k]) for k in range(4)])
        return Lines("domains", outlines, OUTLINE, 0.8)

    def _place(self, x: np.ndarray, depth: float = 0.0) -> np.ndarray:
        """Positions in metres (n, 2) as points of the stage (n, 3)."""
        return in_plane(self._middle[0] + self._per_metre * x[:, 0], self._middle[1] + self._per_metre * x[:, 1], depth)

    def _images(self, x: np.ndarray, mirrors: Mirrors, depth: float = 0.0) -> np.ndarray:
        """The mirror images of positions (n, 2) one after the other, as points of the stage (len(mirrors) n, 3).

        Made with every frame, so written in place: a coordinate is placed once for each side, not for each image.
        """
        out = np.empty((len(mirrors), len(x), 3), np.float32)
        out[:, :, 2] = depth
        for axis in range(2):
            from_middle = np.float32(self._per_metre) * x[:, axis]
            sides = {1: self._middle[axis] + from_middle, -1: self._middle[axis] - from_middle}
            for image, mirror in zip(out, mirrors, strict=True):
                image[:, axis] = sides[mirror[axis]]
        return out.reshape(-1, 3)


def in_view(x: np.ndarray) -> np.ndarray:
    """Positions (n, 2) in metres; what is not a number becomes FARTHEST."""
    return np.fmax(np.fmin(x, FARTHEST), -FARTHEST)
