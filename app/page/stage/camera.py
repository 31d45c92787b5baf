"""A camera that looks flat at a rectangle of the plane z = 0: all of the canvas shows it and nothing else.

The viewer has no orthographic camera; one far away with a small field of view is as good. Nobody turns, moves or
enlarges the picture: what is written over it would be left behind. The page shapes the canvas like
the rectangle (``stage.js``), so where the camera stands depends on that alone, however large the window is. The
viewer skips values that it believes unchanged, so a fit is repeated while things settle, each time changed by a hair.
"""

import math
import threading
from time import monotonic

import numpy as np
import viser

FIELD_OF_VIEW = math.radians(4.0)
SETTLE_SECONDS = 1.5
REPEAT_SECONDS = 0.5

Rectangle = tuple[float, float, float, float]


class FlatCamera:
    """Keeps ``rectangle`` = (x0, x1, y0, y1) in a client's view."""

    def __init__(self, client: viser.ClientHandle, rectangle: Rectangle):
        self._client, self._rectangle = client, rectangle
        self._lock = threading.Lock()
        self._size: tuple[int, int] | None = None
        self._target: np.ndarray | None = None
        self._settle_until = self._next_fit = 0.0
        self._hair = 0
        client.camera.on_update(lambda _: self.fit())
        self.fit(force=True)

    def show(self, rectangle: Rectangle) -> None:
        """Look at another rectangle from now on."""
        if rectangle != self._rectangle:
            self._rectangle = rectangle
            self.fit(force=True)

    def settle(self) -> None:
        """Call now and then: repeats the fit while the canvas is settling."""
        now = monotonic()
        if now < self._settle_until + 1 and now > self._next_fit:
            self._next_fit = now + REPEAT_SECONDS
            self.fit(force=True)

    def on_stage(self, screen: tuple[float, float]) -> tuple[float, float]:
        """The point of the plane z = 0 at a place of the canvas, (0, 0) top left to (1, 1) bottom right."""
        camera = self._client.camera
        x, y, distance = (float(v) for v in camera.position)
        height = 2 * distance * math.tan(camera.fov / 2)
        width = height * camera.image_width / max(1, camera.image_height)
        return x + (screen[0] - 0.5) * width, y + (0.5 - screen[1]) * height

    def fit(self, force: bool = False) -> None:
        """Look straight at the rectangle if the canvas changed, the view was turned, or ``force``."""
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
                self._look()

    def _look(self) -> None:
        x0, x1, y0, y1 = self._rectangle
        self._hair = (self._hair + 1) % 7
        distance = 0.5 * (y1 - y0) * (1 + 1e-5 * self._hair) / math.tan(FIELD_OF_VIEW / 2)
        x, y = (x0 + x1) / 2, (y0 + y1) / 2
        self._target = np.array((x, y, distance))
        camera = self._client.camera
        with self._client.atomic():
            camera.near, camera.far, camera.fov = 0.05 * distance, 20 * distance, FIELD_OF_VIEW
            camera.min_orbit_distance, camera.max_orbit_distance = 1e-6, 1e6  # each must stay within the other
            camera.min_orbit_distance, camera.max_orbit_distance = 0.999 * distance, 1.001 * distance
            camera.up_direction = (0.0, 1.0, 0.0)
            camera.position, camera.look_at = (x, y, distance), (x, y, 0.0)
