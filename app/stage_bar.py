"""The bar on the stage: two lanes of particles, the estimate above the truth, and the displacement below.

Both lanes and the colour bar use one scale. Everything is drawn in the plane z = 0 in units of the bar's length.
"""

from __future__ import annotations

import numpy as np
import viser

from app.colours import TRUTH
from app.scale import ColourScale, power_text
from solvers.bar import exact
from solvers.engine.memory import FrameArrays
from solvers.scene import Scene

RECTANGLE = (-0.105, 1.055, -0.08, 1.1)
ESTIMATE_LANE, TRUTH_LANE, LANE_HEIGHT = 0.815, 0.64, 0.095
CROSSINGS_AT = (ESTIMATE_LANE + TRUTH_LANE) / 2
COLOUR_BAR, COLOUR_BAR_HEIGHT = 1.015, 0.024
CURVE_MIDDLE, CURVE_HEIGHT = 0.255, 0.23
LANE_POINTS = 4000  # points that a lane may be made of
TICK_GAP = 0.024  # labels have a white ground, which must stay clear of the colours
FLASH_SECONDS = 0.25  # how long a crossing stays marked on the screen

DOT, FAINT, CELL = (24, 28, 34), (190, 197, 206), (168, 176, 187)
FLASH = np.array((204, 0, 120))
AWAY = -50.0  # where points that are not shown wait, far outside the view


class BarStage:
    """Draws frames of the bar in one client's scene."""

    def __init__(self, client: viser.ClientHandle, scale: ColourScale):
        self._client, self._scale = client, scale
        self._drawn_scene: Scene | None = None
        self._drawn_ticks: list[tuple[float, str]] = []
        s = client.scene
        s.set_background_image(np.full((2, 2, 3), 255, np.uint8), format="png")
        none = np.zeros((1, 2, 3), np.float32)
        # Points, because they alone show a colour exactly as it is given; lines and meshes are toned and lit.
        self._lanes = [_points(s, f"/bar/{name}", 0.005, "square") for name in ("estimate", "truth")]
        self._cells = s.add_line_segments("/bar/cells", none, CELL, thickness=1.0, thickness_units="screen")
        self._exact = s.add_line_segments("/bar/exact", none, _rgb(TRUTH), thickness=3.0,
                                          thickness_units="screen")
        self._dots = _points(s, "/bar/particles", 0.006)
        self._flashes = _points(s, "/bar/crossings", 0.015)
        colour_bar = _points(s, "/bar/colours", COLOUR_BAR_HEIGHT, "square")
        ends = COLOUR_BAR_HEIGHT / 2
        colour_bar.points = _in_plane(np.linspace(ends, 1 - ends, 256), np.array(COLOUR_BAR))
        colour_bar.colors = scale.gradient(256)
        self._ticks = [_label(s, f"/bar/tick{k}", "", 0.0, COLOUR_BAR - TICK_GAP, "top-center", 0.85)
                       for k in range(5)]
        self._title = _label(s, "/bar/title", "", 0.0, COLOUR_BAR + TICK_GAP, "bottom-left", 1.0)
        self._labels(s)

    def draw(self, scene: Scene, arrays: FrameArrays, estimator: str | None, quantity: int, name: str,
             unit: str, t: float, speed: float) -> None:
        """Show a frame. ``quantity`` is the column of the errors, ``name`` and ``unit`` what it is.

        ``t`` is in s, ``speed`` in simulated seconds a second.
        """
        x = np.clip(np.nan_to_num(arrays.position, nan=AWAY), -0.5, 1.5)
        true = np.abs(arrays.error[:, quantity])
        estimated = np.abs(arrays.estimate[estimator][:, quantity]) if estimator else None
        self._scale.follow(estimated, true)
        with self._client.atomic():
            self._draw_grid(scene)
            for lane, middle, sizes in zip(self._lanes, (ESTIMATE_LANE, TRUTH_LANE), (estimated, true),
                                           strict=True):
                lane.points = self._lane.points(x, middle)
                lane.colors = np.tile(self._shades(sizes, len(x)), (self._lane.rows, 1))
            self._draw_displacement(scene, arrays, t)
            self._draw_crossings(scene, arrays, x, speed)
            self._draw_scale(name, unit)

    def _shades(self, sizes: np.ndarray | None, count: int) -> np.ndarray:
        """Colours of a lane; plain grey where nothing is known."""
        if sizes is None or not np.isfinite(sizes).any():
            return np.full((count, 3), 225, np.uint8)
        return self._scale.colours(sizes)

    def _draw_grid(self, scene: Scene) -> None:
        if scene == self._drawn_scene:
            return
        self._drawn_scene = scene
        edges = np.arange(scene.cells + 1) * scene.spacing
        low, high = TRUTH_LANE - 0.7 * LANE_HEIGHT, ESTIMATE_LANE + 0.7 * LANE_HEIGHT
        self._cells.points = _columns(edges, (low + high) / 2, high - low, depth=-0.01)
        self._lane = _Lane(scene.particles)
        for lane in self._lanes:
            lane.point_size = self._lane.size / 2
        self._largest.text = f"+{scene.motion_amplitude:.3g} m"
        self._smallest.text = f"−{scene.motion_amplitude:.3g} m"

    def _draw_displacement(self, scene: Scene, arrays: FrameArrays, t: float) -> None:
        X = np.linspace(0, 1, 121)
        scaled = CURVE_MIDDLE + CURVE_HEIGHT * exact.displacement(scene, X, t) / scene.motion_amplitude
        curve = _in_plane(X, scaled)
        self._exact.points = np.stack([curve[:-1], curve[1:]], axis=1)
        share = np.clip(np.nan_to_num(arrays.displacement / scene.motion_amplitude, nan=AWAY), -1.1, 1.1)
        X_p = (np.arange(scene.particles) + 0.5) / scene.particles
        self._dots.points = _in_plane(X_p, CURVE_MIDDLE + CURVE_HEIGHT * share, 0.01)
        self._dots.colors = np.full((scene.particles, 3), DOT, np.uint8)

    def _draw_crossings(self, scene: Scene, arrays: FrameArrays, x: np.ndarray, speed: float) -> None:
        since = arrays.steps_since_crossing * scene.time_step / max(speed, 1e-9)
        shown = (arrays.steps_since_crossing >= 0) & (since < FLASH_SECONDS)
        self._flashes.points = _in_plane(x, np.where(shown, CROSSINGS_AT, AWAY), 0.02)
        fade = np.clip(since / FLASH_SECONDS, 0, 1)[:, None]
        self._flashes.colors = (FLASH + fade * (255 - FLASH)).astype(np.uint8)

    def _draw_scale(self, name: str, unit: str) -> None:
        title = f"size of the error of {name} / {power_text(self._scale.power)}{unit}"
        ticks = self._scale.ticks()
        if self._title.text != title:
            self._title.text = title
        if ticks != self._drawn_ticks:
            self._drawn_ticks = ticks
            for k, label in enumerate(self._ticks):
                label.text = ticks[k][1] if k < len(ticks) else ""
                label.position = (ticks[k][0] if k < len(ticks) else AWAY, COLOUR_BAR - TICK_GAP, 0.0)

    def _labels(self, s: viser.SceneApi) -> None:
        above = 0.5 * LANE_HEIGHT + 0.03
        _label(s, "/bar/l1", "estimated error", 0.0, ESTIMATE_LANE + above, "bottom-left")
        _label(s, "/bar/l2", "true error", 0.0, TRUTH_LANE - above, "top-left")
        _label(s, "/bar/l3", "between the lanes: particles that cross a cell boundary", 1.0, TRUTH_LANE - above,
               "top-right", 0.85)
        axis = [[0, CURVE_MIDDLE], [1, CURVE_MIDDLE], [0, CURVE_MIDDLE - 1.1 * CURVE_HEIGHT],
                [0, CURVE_MIDDLE + 1.1 * CURVE_HEIGHT]]
        axis = _in_plane(*np.array(axis, float).T, -0.01).reshape(2, 2, 3)
        s.add_line_segments("/bar/axes", axis, FAINT, thickness=1.0, thickness_units="screen")
        top, bottom = CURVE_MIDDLE + CURVE_HEIGHT, CURVE_MIDDLE - CURVE_HEIGHT
        self._largest = _label(s, "/bar/high", "", -0.01, top, "center-right", 0.85)
        self._smallest = _label(s, "/bar/low", "", -0.01, bottom, "center-right", 0.85)
        _label(s, "/bar/zero", "0", -0.01, CURVE_MIDDLE, "center-right", 0.85)
        _label(s, "/bar/l4", "displacement u: particles (dots) on the exact curve", 0.5, bottom - 0.035, "top-center")
        _label(s, "/bar/l5", "X = 0", 0.0, bottom - 0.035, "top-center", 0.85)
        _label(s, "/bar/l6", "1 m", 1.0, bottom - 0.035, "top-center", 0.85)


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
        return _in_plane(np.tile(x, self.rows), np.repeat(heights, len(x)))


def _points(s: viser.SceneApi, name: str, size: float, shape: str = "circle") -> viser.PointCloudHandle:
    """Points of ``size`` across: the viewer counts from the middle."""
    return s.add_point_cloud(name, np.full((1, 3), AWAY, np.float32), np.zeros((1, 3), np.uint8),
                             point_size=size / 2, point_shape=shape, precision="float32", point_shading="flat")


def _label(s: viser.SceneApi, name: str, text: str, x: float, y: float, anchor: str,
           size: float = 1.0) -> viser.LabelHandle:
    return s.add_label(name, text, position=(x, y, 0.0), anchor=anchor, font_screen_scale=size)


def _in_plane(x: np.ndarray, y: np.ndarray, z: float = 0.0) -> np.ndarray:
    x, y = np.broadcast_arrays(x, y)
    return np.stack([x, y, np.full_like(x, z)], axis=1).astype(np.float32)


def _columns(x: np.ndarray, middle: float, height: float, depth: float = 0.0) -> np.ndarray:
    """Upright line segments (n, 2, 3) at x."""
    low, high = _in_plane(x, np.array(middle - height / 2), depth), _in_plane(x, np.array(middle + height / 2), depth)
    return np.stack([low, high], axis=1)


def _rgb(colour: str) -> tuple[int, int, int]:
    return tuple(int(colour[k:k + 2], 16) for k in (1, 3, 5))
