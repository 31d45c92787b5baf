"""The bar, as long as the stage: two lanes of particles, the estimate above the truth, and the field plot below."""

import math
from collections.abc import Sequence

import numpy as np
import viser

from app import drawing
from app.problems.field import Place
from app.problems.stage import TOUCH, Stage
from app.scale import ColourScale
from solvers.engine.frames import FrameArrays
from solvers.problems.bar import exact
from solvers.problems.bar.scene import BarScene

ESTIMATE_LANE, TRUTH_LANE, LANE_HEIGHT = 0.815, 0.64, 0.095
CROSSINGS_AT = (ESTIMATE_LANE + TRUTH_LANE) / 2
LANES_MIDDLE = (0.5, CROSSINGS_AT, 0.0)
FIELD = Place(0.255, 0.23, 0.0, 1.0, ("X = 0", "1 m"), exact.field)
NAME_LINE, LOWER = 0.05, 0.49  # what a line of words takes; by how much a pinned run's lanes are below the others
LANE_POINTS = 2000  # points that a lane may be made of
TIGHT = 1.02  # times as large they are as they would have to be: in half precision rows may be a hair apart


class BarStage(Stage[BarScene]):
    """Draws frames of the bar in one client's scene."""

    PROBLEM = "bar"
    PAIR_RECTANGLE = (*drawing.RECTANGLE[:2], drawing.RECTANGLE[2] - NAME_LINE - LOWER, 1.14)
    SILENCE_WIDTH, NAME_WIDTH = 72, 90
    PLOT, PLOT_DOT = FIELD, 0.006
    MOST_MARKED, MARKED = 200, "magenta: particles that cross a cell boundary"

    def __init__(self, client: viser.ClientHandle, scale: ColourScale, beside: Stage | None = None):
        super().__init__(client, scale, beside)
        s, at = client.scene, self.at
        self._cloud = drawing.points(s, f"{at}/lanes", 0.005, "square", "float16")
        self._cloud.position = LANES_MIDDLE
        self._cells = drawing.lines(s, f"{at}/cells", drawing.CELL, 1.0)
        self._flashes = drawing.points(s, f"{at}/crossings", 0.015)
        above = 0.5 * LANE_HEIGHT + 0.03
        self._titles = [drawing.label(s, f"{at}/l1", " ", 0.0, ESTIMATE_LANE + above, "bottom-left"),
                        drawing.label(s, f"{at}/l2", " ", 0.0, TRUTH_LANE - above, "top-left")]
        self._silences = [drawing.label(s, f"{at}/silence{lane}", " ", 0.5, lane, "center-center", 0.85)
                          for lane in (ESTIMATE_LANE, TRUTH_LANE)]
        self._name = drawing.label(s, f"{at}/name", " ", 0.0, ESTIMATE_LANE + above + NAME_LINE, "bottom-left")
        if not beside:
            self._flash_note = drawing.label(s, f"{at}/l3", " ", 1.0, TRUTH_LANE - above, "top-right", 0.85)

    def region(self, low: tuple[float, float], high: tuple[float, float], arrays: FrameArrays) -> np.ndarray:
        """Which particles (P,) lie in the rectangle from ``low`` to ``high`` of the stage; height does not count."""
        x = self._across(arrays)
        return (x >= low[0]) & (x <= high[0])

    def nearest(self, point: tuple[float, float], arrays: FrameArrays) -> int | None:
        """In the lanes the particle nearest in x, however high the click; below, a dot of the field plot."""
        x, y = point
        if TRUTH_LANE - LANE_HEIGHT < y < ESTIMATE_LANE + LANE_HEIGHT:
            return int(np.argmin(np.abs(self._across(arrays) - x))) if -TOUCH < x < 1 + TOUCH else None
        return super().nearest(point, arrays)

    def images(self, arrays: FrameArrays, particles: slice) -> np.ndarray:
        x = self._across(arrays)[particles]
        lanes = [drawing.in_plane(x, lane) for lane in (ESTIMATE_LANE, TRUTH_LANE)]
        return np.stack([*lanes, self._plot.places(particles, len(x))])

    def _across(self, arrays: FrameArrays) -> np.ndarray:
        """Where the particles (P,) stand along the stage; of a run gone bad, off the stage."""
        x = arrays.position[:, 0] if self._drawn_scene is None else self._drawn_scene.within(arrays.position[:, 0])
        return np.fmin(np.fmax(x, -0.5), 1.5)  # fmax takes the number where one is none

    def _draw_frame(self, scene: BarScene, arrays: FrameArrays, estimated: np.ndarray | None,
                    true: np.ndarray | None, t: float, speed: float) -> None:
        x = self._across(arrays)
        shades = [drawing.shades(self._scale, sizes, len(x)) for sizes in (estimated, true)]
        drawing.put(self._cloud, self._lanes.points(x), self._lanes.colours(shades))
        since = arrays.steps_since_crossing * scene.time_step / max(speed, 1e-9)
        shown = (arrays.steps_since_crossing >= 0) & (since < self.MARK_SECONDS) & self._marked
        drawing.put_few(self._flashes, drawing.in_plane(x[shown], CROSSINGS_AT, 0.02),
                        drawing.flash_colours(since[shown]))
        if self.plotted:
            self._field.draw(scene, self.plotted, self.magnified, self._at_rest, arrays.plotted, t, shown)

    def _arrange(self) -> None:
        if self._beside:
            self.root.position = (0.0, -LOWER, 0.0)
        else:
            self.root.position = (0.0, -NAME_LINE * self._paired, 0.0)
            self._plot.root.position = (0.0, -LOWER * self._paired, 0.0)

    def _draw_grid(self, scene: BarScene, at_rest: np.ndarray | None = None) -> None:
        edges = np.arange(scene.cells + 1) * scene.spacing
        self._cells.points = drawing.joined(drawing.in_plane(edges, TRUTH_LANE - 0.7 * LANE_HEIGHT, -0.01),
                                            drawing.in_plane(edges, ESTIMATE_LANE + 0.7 * LANE_HEIGHT, -0.01))
        self._at_rest = (np.arange(scene.particles) + 0.5) / scene.particles if at_rest is None else at_rest[:, 0]
        self._lanes = _Lanes(len(self._at_rest))
        self._mark(len(self._at_rest))
        self._cloud.point_size = TIGHT * self._lanes.size / 2


class _Lanes:
    """How the lanes of P particles are tiled with square points: ``rows`` of ``size`` each, one column a particle.

    Columns are wider than a particle at rest, so that a gap shows only where the bar is stretched a lot. Neighbours
    overlap, the one to the right on top; moving all by ``shift`` puts what remains visible in its place. Points are
    counted from ``LANES_MIDDLE``: then half precision, with half the bytes, is a tenth of a pixel.
    """

    def __init__(self, particles: int):
        column = 1 / particles
        self.rows = max(6, min(math.ceil(LANE_HEIGHT / (2 * column)), LANE_POINTS // particles))
        self.size = LANE_HEIGHT / self.rows
        self.shift = (self.size - column) / 2
        self._points = np.zeros((2, self.rows, particles, 3), np.float16)  # without their x
        up = (np.arange(self.rows) - (self.rows - 1) / 2) * self.size
        for lane, middle in zip(self._points, (ESTIMATE_LANE, TRUTH_LANE), strict=True):
            lane[..., 1] = (middle - CROSSINGS_AT + up)[:, None]

    def points(self, x: np.ndarray) -> np.ndarray:
        """(2 * rows * P, 3) points of particles at x (P,): the estimate's lane, then the truth's."""
        out = self._points.copy()
        inside = np.minimum(np.maximum(x + self.shift, self.size / 2), 1 - self.size / 2)
        out[..., 0] = (inside - LANES_MIDDLE[0]).astype(np.float16)
        return out.reshape(-1, 3)

    def colours(self, shades: Sequence[np.ndarray]) -> np.ndarray:
        """(2 * rows * P, 3) colours of those points, from one for each particle (P, 3) in each lane."""
        out = np.empty(self._points.shape, np.uint8)
        for lane, colours in zip(out, shades, strict=True):
            lane[...] = colours
        return out.reshape(-1, 3)


STAGE = BarStage
