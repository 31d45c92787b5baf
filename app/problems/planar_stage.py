"""What the stages of plane problems share: a body on its cells, its domains, and the field plot below."""

from abc import abstractmethod
from typing import ClassVar

import numpy as np
import viser

from app import drawing
from app.problems.stage import AnyScene, Stage
from app.scale import ColourScale
from solvers.engine.frames import FrameArrays
from solvers.problems.planar.layout import Layout, half_edges

MIDDLE = (0.5, 0.44)
RADIUS = 0.44  # of the outermost the body should come, on the stage
FARTHEST = 2.0  # metres from the middle, out of view: where particles of a run gone bad are drawn at most
PAIR_MIDDLES, SMALLER = ((0.185, 0.52), (0.765, 0.52)), 0.58  # of two bodies, each so much smaller than one alone
RAISED = 0.24  # is the field plot below two bodies
LOW = -0.41  # the lowest of what is drawn
MOST_DOMAINS = 5000  # particles whose domains are drawn: more would be a grey mass
Mirrors = tuple[tuple[int, int], ...]


class PlanarStage(Stage[AnyScene]):
    """Draws frames of a plane problem in one client's scene. Of a body with symmetry planes its mirror images too:
    ``MIRRORS`` are the signs of x and y in them."""

    MIRRORS: ClassVar[Mirrors] = ((1, 1),)
    OUTLINED: ClassVar[Mirrors] = ((1, 1),)  # images whose domains are drawn
    SILENCE_WIDTH, NAME_WIDTH = 22, 40  # it stands in the hole of a ring
    RECTANGLE = (*drawing.RECTANGLE[:2], LOW, drawing.RECTANGLE[3])
    PAIR_RECTANGLE = (*drawing.RECTANGLE[:2], LOW + RAISED, drawing.RECTANGLE[3])
    PLOT_DOT = 0.005
    MARK_SECONDS = 0.04  # less than elsewhere: there are many at once
    MOST_MARKED, MARKED = 320, "magenta: crossing a cell boundary"

    def __init__(self, client: viser.ClientHandle, scale: ColourScale, beside: Stage | None = None):
        super().__init__(client, scale, beside)
        s, at = client.scene, self.at
        self._cells = drawing.lines(s, f"{at}/cells", (225, 229, 234), 1.0)
        self._planes = drawing.lines(s, f"{at}/planes", drawing.CELL, 1.5)
        self._outlines = drawing.lines(s, f"{at}/domains", (120, 125, 132), 0.8)
        self._flashes = drawing.points(s, f"{at}/crossings", 0.01)
        self._flashes.colors = np.array(drawing.FLASH, np.uint8)  # of all: one each would cost a fifth of the bytes
        self._titles = [drawing.label(s, f"{at}/l1", " ", 0.0, 0.0, "top-left"),
                        drawing.label(s, f"{at}/l2", " ", 0.0, 0.0, "top-right")]
        self._silences = [drawing.label(s, f"{at}/silence1", " ", 0.0, 0.0, "center-right", 0.85),
                          drawing.label(s, f"{at}/silence2", " ", 0.0, 0.0, "center-left", 0.85)]
        self._size_note = drawing.label(s, f"{at}/l3", "", 0.0, 0.0, "bottom-left", 0.85)
        self._name = drawing.label(s, f"{at}/name", " ", 0.0, 0.0, "bottom-center")
        if not beside:
            self._flash_note = drawing.label(s, f"{at}/l4", " ", 0.0, 0.0, "bottom-right", 0.85)
        self._arrange()

    def region(self, low: tuple[float, float], high: tuple[float, float], arrays: FrameArrays) -> np.ndarray:
        """Which particles (P,) lie, or have a mirror image, in the rectangle from ``low`` to ``high`` of the stage."""
        inside = np.zeros(len(arrays.position), bool)
        for m in self.MIRRORS:
            place = self._place(arrays.position * m)[:, :2]
            inside |= ((place >= low) & (place <= high)).all(axis=1)
        return inside

    def images(self, arrays: FrameArrays, particles: slice) -> np.ndarray:
        x = in_view(arrays.position[particles])
        return np.concatenate([self._images(x, self.MIRRORS).reshape(len(self.MIRRORS), -1, 3),
                               self._plot.places(particles, len(x))[None]])

    def _draw_frame(self, scene: AnyScene, arrays: FrameArrays, estimated: np.ndarray | None,
                    true: np.ndarray | None, t: float, speed: float) -> None:
        x = in_view(arrays.position)
        self._draw_halves(x, estimated, true)
        steps = arrays.steps_since_crossing
        just_crossed = (steps >= 0) & (steps < self.MARK_SECONDS * speed / scene.time_step) & self._marked
        drawing.put_few(self._flashes, self._images(x[just_crossed], self.MIRRORS, 0.02))
        self._draw_domains(scene, arrays, x)
        if self.plotted:
            self._field.draw(scene, self.plotted, self.magnified, self._radii, arrays.plotted, t, just_crossed)

    @abstractmethod
    def _draw_halves(self, x: np.ndarray, estimated: np.ndarray | None, true: np.ndarray | None) -> None:
        """Draw the particles at ``x`` (P, 2) in metres, with the sizes of the two errors as colours."""

    @abstractmethod
    def _layout(self, scene: AnyScene) -> Layout:
        """Where the scene's particles begin."""

    @abstractmethod
    def _reach(self, scene: AnyScene) -> float:
        """How far from the middle a particle should come, in metres."""

    def _place(self, x: np.ndarray, depth: float = 0.0) -> np.ndarray:
        """Positions in metres (n, 2) as points of the stage (n, 3)."""
        return drawing.in_plane(self._middle[0] + self._per_metre * x[:, 0],
                                self._middle[1] + self._per_metre * x[:, 1], depth)

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

    def _arrange(self) -> None:
        self._middle, self._size = (PAIR_MIDDLES[bool(self._beside)], SMALLER) if self._paired else (MIDDLE, 1.0)
        high, side = 0.515, 0.47 if self._paired else 0.5  # of the titles: the body, at its largest, stays below
        for label, x, y in ((self._titles[0], -side, high), (self._titles[1], side, high), (self._name, 0.0, 0.55),
                            (self._size_note, -0.5, -0.5)):
            self._put(label, self._size * x, self._size * y)
        for label, x in zip(self._silences, (-0.015, 0.015), strict=True):
            self._put(label, x, 0.0)
        if not self._beside:
            self._put(self._flash_note, 0.5, -0.5 + 0.15 * self._paired)
            self._plot.root.position = (0.0, RAISED * self._paired, 0.0)

    def _put(self, label: viser.LabelHandle, x: float, y: float) -> None:
        """Move a label to a place counted from the body's middle."""
        label.position = (self._middle[0] + x, self._middle[1] + y, 0.0)

    def _draw_grid(self, scene: AnyScene, at_rest: np.ndarray | None = None) -> None:
        reach = self._reach(scene)
        self._per_metre = self._size * RADIUS / reach
        end = 1.05 * reach
        start = self.first_line(scene)
        at = np.arange(np.ceil((-end - start) / scene.spacing), np.floor((end - start) / scene.spacing) + 1)
        at = at * scene.spacing + start
        upright = np.stack([np.repeat(at, 2), np.tile([-end, end], len(at))], axis=1)
        self._cells.points = self._place(np.concatenate([upright, upright[:, ::-1]]), -0.02).reshape(-1, 2, 3)
        axes = np.array([[-end, 0], [end, 0], [0, -end], [0, end]])
        self._planes.points = self._place(axes, -0.01).reshape(2, 2, 3)
        self._size_dots(scene.spacing / scene.ppc * self._per_metre)
        if at_rest is None:
            layout = self._layout(scene)
            self._radii = layout.radii[layout.radius]
            self._edges = layout.edges if scene.particles <= MOST_DOMAINS else None
        else:
            self._radii, self._edges = np.linalg.norm(at_rest, axis=1), None
        self._mark(len(self._radii))
        self._size_note.text = self.note(scene)

    def _size_dots(self, width: float) -> None:
        """Make the dots fit particles that are ``width`` apart on the stage."""
        self._flashes.point_size = max(0.22 * width, 0.0025)

    def _draw_domains(self, scene: AnyScene, arrays: FrameArrays, x: np.ndarray) -> None:
        """Outline what each particle stands for: a box for GIMP, a parallelogram for CPDI."""
        if not self.domains or self._edges is None or len(x) != len(self._edges):
            self._outlines.visible = False
            return
        self._outlines.visible = True
        F = arrays.deformation_gradient.reshape(-1, 2, 2)
        first, second = np.moveaxis(half_edges(scene, F, self._edges), 1, 0)
        corners = [x - first - second, x + first - second, x + first + second, x - first + second]
        placed = [self._images(corner, self.OUTLINED, 0.01) for corner in corners]
        drawing.put(self._outlines, np.concatenate([drawing.joined(placed[k - 1], placed[k]) for k in range(4)]))


def in_view(x: np.ndarray) -> np.ndarray:
    """Positions (n, 2) in metres; what is not a number becomes FARTHEST."""
    return np.fmax(np.fmin(x, FARTHEST), -FARTHEST)
