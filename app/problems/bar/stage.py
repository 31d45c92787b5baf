"""The bar on the stage: two lanes of particles, the estimate above the truth, and the displacement below.

Both lanes and the colour bar use one scale. The stage is one bar long.
"""

from __future__ import annotations

import numpy as np
import viser

from app.colours import TRUTH
from app.drawing import (
    AWAY,
    CELL,
    DOT,
    FAINT,
    FLASH_SECONDS,
    flash_colours,
    in_plane,
    joined,
    label,
    lines,
    points,
    rgb,
    shades,
    write,
)
from app.page.view import Half
from app.scale import ColourScale
from solvers.bar import exact
from solvers.bar.scene import BarScene
from solvers.engine.frames import FrameArrays

ESTIMATE_LANE, TRUTH_LANE, LANE_HEIGHT = 0.815, 0.64, 0.095
CROSSINGS_AT = (ESTIMATE_LANE + TRUTH_LANE) / 2
CURVE_MIDDLE, CURVE_HEIGHT = 0.255, 0.23
LANE_POINTS = 4000  # points that a lane may be made of
SILENCE_WIDTH = 72  # characters in a line of the reason why a lane is empty


class BarStage:
    """Draws frames of the bar in one client's scene."""

    def __init__(self, client: viser.ClientHandle, scale: ColourScale):
        self._scale = scale
        self._drawn_scene: BarScene | None = None
        s = client.scene
        self.root = s.add_frame("/bar", show_axes=False)
        self._lanes = [points(s, f"/bar/{name}", 0.005, "square") for name in ("estimate", "truth")]
        self._cells = lines(s, "/bar/cells", CELL, 1.0)
        self._exact = lines(s, "/bar/exact", rgb(TRUTH), 3.0)
        self._dots = points(s, "/bar/particles", 0.006)
        self._flashes = points(s, "/bar/crossings", 0.015)
        self._labels(s)

    def draw(self, scene: BarScene, arrays: FrameArrays, estimated: np.ndarray | None,
             true: np.ndarray | None,
             t: float, speed: float) -> None:
        """Show a frame. ``estimated`` and ``true`` are sizes of errors (P,); t in s, ``speed`` in simulated s per s."""
        x = np.clip(np.nan_to_num(arrays.position[:, 0], nan=AWAY), -0.5, 1.5)
        self._draw_grid(scene)
        for lane, middle, sizes in zip(self._lanes, (ESTIMATE_LANE, TRUTH_LANE), (estimated, true), strict=True):
            lane.points = self._lane.points(x, middle)
            lane.colors = np.tile(shades(self._scale, sizes, len(x)), (self._lane.rows, 1))
        self._draw_displacement(scene, arrays, t)
        since = arrays.steps_since_crossing * scene.time_step / max(speed, 1e-9)
        shown = (arrays.steps_since_crossing >= 0) & (since < FLASH_SECONDS)
        self._flashes.points = in_plane(x, np.where(shown, CROSSINGS_AT, AWAY), 0.02)
        self._flashes.colors = flash_colours(since)

    def caption(self, estimate: Half, truth: Half) -> None:
        """Title the lanes, and say in an empty one why it is."""
        for half, title, silence in zip((estimate, truth), self._titles, self._silences, strict=True):
            write(title, half.title)
            write(silence, half.silence, SILENCE_WIDTH)

    def region(self, low: tuple[float, float], high: tuple[float, float], arrays: FrameArrays) -> np.ndarray:
        """Which particles (P,) lie in the rectangle from ``low`` to ``high`` of the stage; height does not count."""
        return (arrays.position[:, 0] >= low[0]) & (arrays.position[:, 0] <= high[0])

    def _draw_grid(self, scene: BarScene) -> None:
        if scene == self._drawn_scene:
            return
        self._drawn_scene = scene
        edges = np.arange(scene.cells + 1) * scene.spacing
        low, high = TRUTH_LANE - 0.7 * LANE_HEIGHT, ESTIMATE_LANE + 0.7 * LANE_HEIGHT
        self._cells.points = joined(in_plane(edges, np.array(low), -0.01), in_plane(edges, np.array(high), -0.01))
        self._lane = _Lane(scene.particles)
        for lane in self._lanes:
            lane.point_size = self._lane.size / 2
        self._exact.visible = scene.solution_known
        self._below.text = "displacement u: particles (dots) on the exact curve" if scene.solution_known \
            else "displacement u of the particles (no exact curve is known)"
        self._largest.text = f"+{scene.motion_amplitude:.3g} m"
        self._smallest.text = f"−{scene.motion_amplitude:.3g} m"

    def _draw_displacement(self, scene: BarScene, arrays: FrameArrays, t: float) -> None:
        X = np.linspace(0, 1, 121)
        scaled = CURVE_MIDDLE + CURVE_HEIGHT * exact.displacement(scene, X, t) / scene.motion_amplitude
        curve = in_plane(X, scaled)
        self._exact.points = joined(curve[:-1], curve[1:])
        share = np.clip(np.nan_to_num(arrays.displacement[:, 0] / scene.motion_amplitude, nan=AWAY), -1.1, 1.1)
        X_p = (np.arange(scene.particles) + 0.5) / scene.particles
        self._dots.points = in_plane(X_p, CURVE_MIDDLE + CURVE_HEIGHT * share, 0.01)
        self._dots.colors = np.full((scene.particles, 3), DOT, np.uint8)

    def _labels(self, s: viser.SceneApi) -> None:
        above = 0.5 * LANE_HEIGHT + 0.03
        self._titles = [label(s, "/bar/l1", " ", 0.0, ESTIMATE_LANE + above, "bottom-left"),
                        label(s, "/bar/l2", " ", 0.0, TRUTH_LANE - above, "top-left")]
        self._silences = [label(s, f"/bar/silence{lane}", " ", 0.5, lane, "center-center", 0.85)
                          for lane in (ESTIMATE_LANE, TRUTH_LANE)]
        label(s, "/bar/l3", "between the lanes: particles that cross a cell boundary", 1.0, TRUTH_LANE - above,
              "top-right", 0.85)
        reach = 1.1 * CURVE_HEIGHT
        lines(s, "/bar/axes", FAINT, 1.0).points = joined(
            in_plane(np.zeros(2), np.array([CURVE_MIDDLE, CURVE_MIDDLE - reach]), -0.01),
            in_plane(np.array([1.0, 0.0]), np.array([CURVE_MIDDLE, CURVE_MIDDLE + reach]), -0.01))
        top, bottom = CURVE_MIDDLE + CURVE_HEIGHT, CURVE_MIDDLE - CURVE_HEIGHT
        self._largest = label(s, "/bar/high", "", -0.01, top, "center-right", 0.85)
        self._smallest = label(s, "/bar/low", "", -0.01, bottom, "center-right", 0.85)
        label(s, "/bar/zero", "0", -0.01, CURVE_MIDDLE, "center-right", 0.85)
        self._below = label(s, "/bar/l4", "", 0.5, bottom - 0.035, "top-center")
        label(s, "/bar/l5", "X = 0", 0.0, bottom - 0.035, "top-center", 0.85)
        label(s, "/bar/l6", "1 m", 1.0, bottom - 0.035, "top-center", 0.85)


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
        return in_plane(np.tile(x, self.rows), np.repeat(heights, len(x)))
