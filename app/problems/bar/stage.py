"""The bar, as long as the stage: two lanes of particles, the estimate above the truth, and the displacement below."""

import numpy as np
import viser

from app import drawing
from app.colours import TRUTH
from app.problems.stage import Stage
from app.scale import ColourScale
from solvers.bar import exact
from solvers.bar.scene import BarScene
from solvers.engine.frames import FrameArrays

ESTIMATE_LANE, TRUTH_LANE, LANE_HEIGHT = 0.815, 0.64, 0.095
CROSSINGS_AT = (ESTIMATE_LANE + TRUTH_LANE) / 2
CURVE_MIDDLE, CURVE_HEIGHT = 0.255, 0.23
LANE_POINTS = 4000  # points that a lane may be made of


class BarStage(Stage[BarScene]):
    """Draws frames of the bar in one client's scene."""

    SILENCE_WIDTH = 72

    def __init__(self, client: viser.ClientHandle, scale: ColourScale):
        super().__init__(client, scale, "bar")
        s = client.scene
        self._lanes = [drawing.points(s, f"/bar/{name}", 0.005, "square") for name in ("estimate", "truth")]
        self._cells = drawing.lines(s, "/bar/cells", drawing.CELL, 1.0)
        self._exact = drawing.lines(s, "/bar/exact", drawing.rgb(TRUTH), 3.0)
        self._dots = drawing.points(s, "/bar/particles", 0.006)
        self._flashes = drawing.points(s, "/bar/crossings", 0.015)
        above = 0.5 * LANE_HEIGHT + 0.03
        self._titles = [drawing.label(s, "/bar/l1", " ", 0.0, ESTIMATE_LANE + above, "bottom-left"),
                        drawing.label(s, "/bar/l2", " ", 0.0, TRUTH_LANE - above, "top-left")]
        self._silences = [drawing.label(s, f"/bar/silence{lane}", " ", 0.5, lane, "center-center", 0.85)
                          for lane in (ESTIMATE_LANE, TRUTH_LANE)]
        drawing.label(s, "/bar/l3", "between the lanes: particles that cross a cell boundary", 1.0, TRUTH_LANE - above,
                      "top-right", 0.85)
        heights = CURVE_MIDDLE + 1.1 * CURVE_HEIGHT * np.array([0, 0, -1, 1])
        drawing.lines(s, "/bar/axes", drawing.FAINT, 1.0).points = drawing.in_plane(
            np.array([0.0, 1.0, 0.0, 0.0]), heights, -0.01).reshape(2, 2, 3)
        top, bottom = CURVE_MIDDLE + CURVE_HEIGHT, CURVE_MIDDLE - CURVE_HEIGHT
        self._largest = drawing.label(s, "/bar/high", "", -0.01, top, "center-right", 0.85)
        self._smallest = drawing.label(s, "/bar/low", "", -0.01, bottom, "center-right", 0.85)
        drawing.label(s, "/bar/zero", "0", -0.01, CURVE_MIDDLE, "center-right", 0.85)
        self._below = drawing.label(s, "/bar/l4", "", 0.5, bottom - 0.035, "top-center")
        drawing.label(s, "/bar/l5", "X = 0", 0.0, bottom - 0.035, "top-center", 0.85)
        drawing.label(s, "/bar/l6", "1 m", 1.0, bottom - 0.035, "top-center", 0.85)

    def region(self, low: tuple[float, float], high: tuple[float, float], arrays: FrameArrays) -> np.ndarray:
        """Which particles (P,) lie in the rectangle from ``low`` to ``high`` of the stage; height does not count."""
        return (arrays.position[:, 0] >= low[0]) & (arrays.position[:, 0] <= high[0])

    def _draw_frame(self, scene: BarScene, arrays: FrameArrays, estimated: np.ndarray | None,
                    true: np.ndarray | None, t: float, speed: float) -> None:
        x = np.clip(np.nan_to_num(arrays.position[:, 0], nan=drawing.AWAY), -0.5, 1.5)
        for lane, middle, sizes in zip(self._lanes, (ESTIMATE_LANE, TRUTH_LANE), (estimated, true), strict=True):
            lane.points = self._lane.points(x, middle)
            lane.colors = np.tile(drawing.shades(self._scale, sizes, len(x)), (self._lane.rows, 1))
        X = np.linspace(0, 1, 121)
        scaled = CURVE_MIDDLE + CURVE_HEIGHT * exact.displacement(scene, X, t) / scene.motion_amplitude
        curve = drawing.in_plane(X, scaled)
        self._exact.points = drawing.joined(curve[:-1], curve[1:])
        share = np.clip(np.nan_to_num(arrays.displacement[:, 0] / scene.motion_amplitude, nan=drawing.AWAY), -1.1, 1.1)
        X_p = (np.arange(scene.particles) + 0.5) / scene.particles
        self._dots.points = drawing.in_plane(X_p, CURVE_MIDDLE + CURVE_HEIGHT * share, 0.01)
        self._dots.colors = np.full((scene.particles, 3), drawing.DOT, np.uint8)
        since = arrays.steps_since_crossing * scene.time_step / max(speed, 1e-9)
        shown = (arrays.steps_since_crossing >= 0) & (since < drawing.FLASH_SECONDS)
        self._flashes.points = drawing.in_plane(x, np.where(shown, CROSSINGS_AT, drawing.AWAY), 0.02)
        self._flashes.colors = drawing.flash_colours(since)

    def _draw_grid(self, scene: BarScene) -> None:
        edges = np.arange(scene.cells + 1) * scene.spacing
        self._cells.points = drawing.joined(drawing.in_plane(edges, TRUTH_LANE - 0.7 * LANE_HEIGHT, -0.01),
                                            drawing.in_plane(edges, ESTIMATE_LANE + 0.7 * LANE_HEIGHT, -0.01))
        self._lane = _Lane(scene.particles)
        for lane in self._lanes:
            lane.point_size = self._lane.size / 2
        self._exact.visible = scene.solution_known
        self._below.text = "displacement u: particles (dots) on the exact curve" if scene.solution_known \
            else "displacement u of the particles (no exact curve is known)"
        self._largest.text = f"+{scene.motion_amplitude:.3g} m"
        self._smallest.text = f"−{scene.motion_amplitude:.3g} m"


class _Lane:
    """How a lane of particles is tiled with square points: ``rows`` of ``size``, one column a particle.

    Columns are wider than a particle at rest, so that a gap shows only where the bar is stretched a lot. Neighbours
    overlap, the one to the right on top; moving all by ``shift`` puts what remains visible in its place.
    """

    def __init__(self, particles: int):
        column = 1 / particles
        self.rows = max(6, min(int(LANE_HEIGHT / (1.3 * column)), LANE_POINTS // particles))
        self.size = LANE_HEIGHT / self.rows
        self.shift = (self.size - column) / 2

    def points(self, x: np.ndarray, middle: float) -> np.ndarray:
        """(rows * P, 3) points of particles at x in the lane around y = middle."""
        heights = middle + (np.arange(self.rows) - (self.rows - 1) / 2) * self.size
        x = np.clip(x + self.shift, self.size / 2, 1 - self.size / 2)
        return drawing.in_plane(np.tile(x, self.rows), np.repeat(heights, len(x)))


STAGE = BarStage
