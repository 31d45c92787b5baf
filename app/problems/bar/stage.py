"""The bar, as long as the stage: two lanes of particles, the estimate above the truth, and the field plot below."""

import math
from collections.abc import Iterator, Sequence
from typing import ClassVar

import numpy as np

from app.frame.field import PlotPlace
from app.frame.marks import CELL, RECTANGLE, Dots, Label, Lines, Mark, flash_colours, in_plane, joined, shades
from app.frame.stage import TOUCH, Seat, Stage, Words
from solvers.engine.frames import FrameArrays
from solvers.problems.bar import exact
from solvers.problems.bar.scene import BarScene

ESTIMATE_LANE, TRUTH_LANE, LANE_HEIGHT = 0.815, 0.64, 0.095
CROSSINGS_AT = (ESTIMATE_LANE + TRUTH_LANE) / 2
NAME_LINE, LOWER = 0.05, 0.49  # what a line of words takes; by how much a pinned run's lanes are below the others
#: By how much lanes are higher than those of a run alone.
RAISED = {Seat.ALONE: 0.0, Seat.FIRST: -NAME_LINE, Seat.SECOND: -NAME_LINE - LOWER}
LANE_POINTS = 2000  # points that a lane may be made of
TIGHT = 1.02  # times as large they are as they would have to be: in half precision rows may be a hair apart


class BarStage(Stage[BarScene]):
    """Makes marks of frames of the bar."""

    PAIR_RECTANGLE = (*RECTANGLE[:2], RECTANGLE[2] - NAME_LINE - LOWER, 1.14)
    PLOT, PLOT_DOT = PlotPlace(0.255, 0.23, 0.0, 1.0, ("X = 0", "1 m"), exact.field), 0.006
    PAIR_PLOT = -NAME_LINE - LOWER
    ANCHORS: ClassVar = {"estimate": (0.0, ESTIMATE_LANE), "truth": (0.0, TRUTH_LANE),
                         "lane": (0.0, ESTIMATE_LANE + LANE_HEIGHT / 2)}
    MOST_MARKED, MARKED = 200, "magenta: particles that cross a cell boundary"

    @staticmethod
    def labels(words: Words, seat: Seat) -> Iterator[Label]:
        beyond = 0.5 * LANE_HEIGHT + 0.03
        above, below = ESTIMATE_LANE + RAISED[seat] + beyond, TRUTH_LANE + RAISED[seat] - beyond
        yield Label("estimate-title", words.titles[0], 0.0, above, "bottom-left", "title")
        yield Label("truth-title", words.titles[1], 0.0, below, "top-left", "title")
        for name, text, lane in zip(("estimate", "truth"), words.silences, (ESTIMATE_LANE, TRUTH_LANE), strict=True):
            yield Label(f"{name}-silence", text, 0.5, lane + RAISED[seat], "center-center", "silence", 0.85, 72)
        yield Label("run", words.run, 0.0, above + NAME_LINE, "bottom-left", "name", width=90)
        if seat != Seat.SECOND:
            yield Label("crossings-note", words.crossings, 1.0, below, "top-right", "note", 0.85)

    def region(self, low: tuple[float, float], high: tuple[float, float], arrays: FrameArrays) -> np.ndarray:
        """Which particles (P,) lie in the rectangle from ``low`` to ``high`` of the stage; height does not count."""
        x = self._across(arrays)
        return (x >= low[0]) & (x <= high[0])

    def nearest(self, point: tuple[float, float], arrays: FrameArrays) -> int | None:
        """In the lanes the particle nearest in x, however high the click; below, a dot of the field plot."""
        x, y = point
        if TRUTH_LANE - LANE_HEIGHT < y - RAISED[self._seat] < ESTIMATE_LANE + LANE_HEIGHT:
            return int(np.argmin(np.abs(self._across(arrays) - x))) if -TOUCH < x < 1 + TOUCH else None
        return super().nearest(point, arrays)

    def images(self, arrays: FrameArrays, particles: slice) -> np.ndarray:
        x = self._across(arrays)[particles]
        lanes = [in_plane(x, lane + RAISED[self._seat]) for lane in (ESTIMATE_LANE, TRUTH_LANE)]
        return np.stack([*lanes, self._plot.places(particles, len(x))])

    def _across(self, arrays: FrameArrays) -> np.ndarray:
        """Where the particles (P,) stand along the stage; of a run gone bad, off the stage."""
        x = arrays.position[:, 0] if self._drawn_scene is None else self._drawn_scene.within(arrays.position[:, 0])
        return np.fmin(np.fmax(x, -0.5), 1.5)  # fmax takes the number where one is none

    def _still(self, scene: BarScene, particles: int, at_rest: np.ndarray | None) -> Iterator[Mark]:
        edges = np.arange(scene.cells + 1) * scene.spacing
        low, high = TRUTH_LANE - 0.7 * LANE_HEIGHT, ESTIMATE_LANE + 0.7 * LANE_HEIGHT
        yield Lines("cells", joined(*(in_plane(edges, y + RAISED[self._seat], -0.01) for y in (low, high))), CELL, 1.0)
        self._at_rest = (np.arange(scene.particles) + 0.5) / scene.particles if at_rest is None else at_rest[:, 0]
        self._lanes = _Lanes(particles, CROSSINGS_AT + RAISED[self._seat])

    def _moving(self, scene: BarScene, arrays: FrameArrays, estimated: np.ndarray | None, true: np.ndarray | None,
                t: float, speed: float) -> Iterator[Mark]:
        x = self._across(arrays)
        yield self._lanes.dots(x, [shades(self._scale, sizes, len(x)) for sizes in (estimated, true)])
        since = arrays.steps_since_crossing * scene.time_step / max(speed, 1e-9)
        shown = (arrays.steps_since_crossing >= 0) & (since < self.MARK_SECONDS) & self._marked
        yield Dots("crossings", in_plane(x[shown], CROSSINGS_AT + RAISED[self._seat], 0.02),
                   flash_colours(since[shown]), 0.015)
        if self.plotted:
            yield from self._field.draw(scene, self.plotted, self.magnified, self._at_rest, arrays.plotted, t, shown)


class _Lanes:
    """How two lanes of P particles, alike above and below a ``middle``, are tiled with square points: ``rows`` of
    ``size`` each, one column a particle.

    Columns are wider than a particle at rest, so that a gap shows only where the bar is stretched a lot. Neighbours
    overlap, the one to the right on top; moving all by ``shift`` puts what remains visible in its place. Points are
    counted from between the lanes: then half precision, with half the bytes, is a tenth of a pixel.
    """

    def __init__(self, particles: int, middle: float):
        column = 1 / particles
        self.origin = 0.5, middle
        self.rows = max(6, min(math.ceil(LANE_HEIGHT / (2 * column)), LANE_POINTS // particles))
        self.size = LANE_HEIGHT / self.rows
        self.shift = (self.size - column) / 2
        self._points = np.zeros((2, self.rows, particles, 3), np.float16)  # without their x
        up = (np.arange(self.rows) - (self.rows - 1) / 2) * self.size
        for lane, at in zip(self._points, (ESTIMATE_LANE, TRUTH_LANE), strict=True):
            lane[..., 1] = (at - CROSSINGS_AT + up)[:, None]

    def dots(self, x: np.ndarray, shades: Sequence[np.ndarray]) -> Dots:
        """Particles at x (P,) in the colours (P, 3) of each lane: the estimate's, then the truth's."""
        points, colours = self._points.copy(), np.empty(self._points.shape, np.uint8)
        inside = np.minimum(np.maximum(x + self.shift, self.size / 2), 1 - self.size / 2)
        points[..., 0] = (inside - self.origin[0]).astype(np.float16)
        for lane, of_particles in zip(colours, shades, strict=True):
            lane[...] = of_particles
        return Dots("lanes", points.reshape(-1, 3), colours.reshape(-1, 3), TIGHT * self.size, "square", self.origin)
