"""Pointing at the stage: a dragged rectangle reads the errors of the particles in it (an empty one ends that), a click
on a particle traces it with a ring. And the camera that shows exactly a rectangle of the plane z = 0.

The viewer has no orthographic camera, so it is a distant one with a small field of view. Visitors cannot move it:
overlaid text would stay behind. The page shapes the canvas like the rectangle (``stage.js``), so the camera depends on
that alone. The viewer skips values that it believes unchanged, so repeated fits while the canvas settles differ
slightly."""

import math
import threading
from time import monotonic

import numpy as np
import viser

from app.frame.layout import Rectangle
from app.frame.primitives import Lines, in_plane, join_points
from app.frame.stage import Stage
from app.language.translation import lazy, tr
from app.names_and_units import with_unit
from app.page.visit.traced_particle_series import ParticleTracer
from app.renderers.viewer_renderer import ViewerSurface
from solvers.engine.shared_frames import FrameArrays

FIELD_OF_VIEW = math.radians(4.0)
SETTLE_SECONDS = 1.5
REPEAT_SECONDS = 0.5


class FixedRectangleCamera:
    """Keeps ``rectangle`` = (x0, x1, y0, y1) of the stage's plane z = 0 in a browser's view."""

    def __init__(self, client: viser.ClientHandle, rectangle: Rectangle):
        self._client, self._rectangle = client, rectangle
        self._lock = threading.Lock()
        self._size: tuple[int, int] | None = None
        self._target: np.ndarray | None = None
        self._settle_until = self._next_fit = 0.0
        self._hair = 0
        client.camera.on_update(lambda _: self.fit())
        self.fit(force=True)

    def show_rectangle(self, rectangle: Rectangle) -> None:
        """Looks at another rectangle (x0, x1, y0, y1)."""
        if rectangle != self._rectangle:
            self._rectangle = rectangle
            self.fit(force=True)

    def refit_while_settling(self) -> None:
        """Repeats the fit for about 2 s after the canvas has changed its size, every 0.5 s; call it periodically."""
        now = monotonic()
        if now < self._settle_until + 1 and now > self._next_fit:
            self._next_fit = now + REPEAT_SECONDS
            self.fit(force=True)

    def stage_point(self, screen: tuple[float, float]) -> tuple[float, float]:
        """Returns the point of the plane z = 0 at a position on the canvas, (0, 0) top left to (1, 1) bottom right."""
        camera = self._client.camera
        x, y, distance = (float(v) for v in camera.position)
        height = 2 * distance * math.tan(camera.fov / 2)
        width = height * camera.image_width / max(1, camera.image_height)
        return x + (screen[0] - 0.5) * width, y + (0.5 - screen[1]) * height

    def fit(self, force: bool = False) -> None:
        """Looks straight at the rectangle if the canvas or the view has changed, or ``force`` is set."""
        with self._lock:
            camera = self._client.camera
            size = (camera.image_width, camera.image_height)
            if size != self._size:
                self._settle_until = monotonic() + SETTLE_SECONDS
            turn = viser.transforms.SO3(camera.wxyz).as_matrix()
            turned = turn[2, 2] > -0.9999 or abs(turn[0, 0]) < 0.9999
            astray = self._target is None or not np.allclose(camera.position, self._target, rtol=1e-3, atol=1e-3)
            if force or size != self._size or turned or astray:
                self._size = size
                self._set_camera()

    def _set_camera(self) -> None:
        x0, x1, y0, y1 = self._rectangle
        self._hair = (self._hair + 1) % 7
        distance = 0.5 * (y1 - y0) * (1 + 1e-5 * self._hair) / math.tan(FIELD_OF_VIEW / 2)
        x, y = (x0 + x1) / 2, (y0 + y1) / 2
        self._target = np.array((x, y, distance))
        camera = self._client.camera
        with self._client.atomic():
            camera.near, camera.far, camera.fov = 0.05 * distance, 20 * distance, FIELD_OF_VIEW
            camera.min_orbit_distance, camera.max_orbit_distance = 1e-6, 1e6  # each is limited by the other
            camera.min_orbit_distance, camera.max_orbit_distance = 0.999 * distance, 1.001 * distance
            camera.up_direction = (0.0, 1.0, 0.0)
            camera.position, camera.look_at = (x, y, distance), (x, y, 0.0)


ESTIMATED, TRUE = lazy("estimated mean {mean}, worst {worst}"), lazy("true mean {mean}, worst {worst}")
RADIUS = 0.018  # on the stage
#: On top of everything: the dots' colour over the ground's is visible on every colour of the map.
RINGS = ("ground", 5.0, 0.04), ("dot", 2.0, 0.045)
_ANGLES = np.linspace(0, 2 * np.pi, 25)
_RING = RADIUS * np.stack([np.cos(_ANGLES), np.sin(_ANGLES), 0 * _ANGLES], axis=1).astype(np.float32)


class RectangleErrorProbe:
    """Rectangle that a visitor drags on the stage; ``text`` has the errors of particles in it, None without one."""

    def __init__(self, client: viser.ClientHandle, sheet: ViewerSurface, camera: FixedRectangleCamera):
        self._rectangle: tuple[tuple[float, float], tuple[float, float]] | None = None
        self._sheet = sheet
        self.text: str | None = None
        # Rectangle selection also takes the left drag, which would otherwise rotate the view.
        client.scene.on_rect_select()(lambda event: self._select_region(camera, event))

    def measure(self, stage: Stage, arrays: FrameArrays, estimated: np.ndarray | None, true: np.ndarray | None,
                unit: str) -> None:
        """Sets ``text`` to mean and worst error of the particles in the region, from estimated and true errors (P,) in
        a ``unit``; ends the selection if no particle is in it."""
        self._sheet.visible, rectangle = True, self._rectangle
        if rectangle is None:
            self.text = None
            return
        inside = stage.particles_in(*rectangle, arrays)
        if not inside.any():
            self._clear()
            return
        parts = [tr("{n} particles", n=np.count_nonzero(inside))]
        for said, sizes in ((ESTIMATED, estimated), (TRUE, true)):
            if sizes is not None and np.isfinite(sizes[inside]).any():
                mean, worst = (with_unit(float(of(sizes[inside])), unit) for of in (np.nanmean, np.nanmax))
                parts.append(tr(said, mean=mean, worst=worst))
        self.text = "; ".join(parts)

    def hide(self) -> None:
        """Ends the selection, and takes none until the next :meth:`measure`: the stage shows something else."""
        self._sheet.visible = False
        self._clear()

    def _clear(self) -> None:
        self._rectangle, self.text = None, None
        self._draw_outline(np.empty((0, 2, 3), np.float32))

    def _select_region(self, camera: FixedRectangleCamera, event: viser.SceneRectSelectEvent) -> None:
        if not self._sheet.visible:
            return
        ends = camera.stage_point(event.screen_min), camera.stage_point(event.screen_max)
        (left, right), (bottom, top) = (sorted(coordinates) for coordinates in zip(*ends, strict=True))
        self._rectangle = (left, bottom), (right, top)
        corners = in_plane(np.array([left, right, right, left]), np.array([bottom, bottom, top, top]), 0.03)
        self._draw_outline(join_points(corners, np.roll(corners, -1, axis=0)))

    def _draw_outline(self, frame: np.ndarray) -> None:
        self._sheet.show_marks(Lines("rectangle", frame, self._sheet.stage_metrics.palette.dot, 1.5))


class TracedParticleRing:
    """Ring around a visitor's traced particle. A click on a particle traces it; on the same or elsewhere, none."""

    def __init__(self, client: viser.ClientHandle, sheet: ViewerSurface, trace: ParticleTracer):
        self._trace = trace
        self._last_drawn: tuple[Stage, FrameArrays] | None = None
        self._sheet = sheet
        client.scene.on_click()(lambda event: self._click(_clicked_stage_point(event)))

    def update(self, stage: Stage, arrays: FrameArrays) -> None:
        """Draws the ring around the traced particle in a frame on a problem's stage; hides it if none is traced."""
        self._last_drawn, traced = (stage, arrays), self._trace.traced
        if traced is None or traced.particle >= len(arrays.position):
            self._sheet.visible = False
            return
        middles = stage.drawn_particle_points(arrays, slice(traced.particle, traced.particle + 1))[:, 0]
        around = middles[:, None] + _RING  # (images, angles, 3)
        for name, width, height in RINGS:
            around[:, :, 2] = height
            self._sheet.show_marks(Lines(name, join_points(around[:, :-1].reshape(-1, 3), around[:, 1:].reshape(-1, 3)),
                                         getattr(self._sheet.stage_metrics.palette, name), width))
        self._sheet.visible = True

    def hide(self) -> None:
        """Hides the ring, because the stage shows something without traced particles."""
        self._last_drawn = None
        self._sheet.visible = False

    def _click(self, point: tuple[float, float]) -> None:
        if self._last_drawn is None:
            return
        stage, arrays = self._last_drawn
        particle, traced = stage.nearest_particle(point, arrays), self._trace.traced
        self._trace.choose(None if traced is not None and particle == traced.particle else particle)
        self.update(stage, arrays)


def _clicked_stage_point(event: viser.SceneClickEvent) -> tuple[float, float]:
    """Returns the point (x, y) of the plane z = 0 on the ray of a click; right even before the camera has settled."""
    (x, y, z), (dx, dy, dz) = event.ray_origin, event.ray_direction
    return x - z * dx / dz, y - z * dy / dz
