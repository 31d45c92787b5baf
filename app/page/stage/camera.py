"""A camera that looks flat at a rectangle of the plane z = 0 and keeps it in view.

The viewer has no orthographic camera; one far away with a small field of view is as good. Its first reports
of the canvas size can be stale and come in any order, and it skips values that it believes unchanged, so a fit
is repeated while things settle, each time changed by a hair.
"""

import math
import threading
from time import monotonic

import numpy as np
import viser

FIELD_OF_VIEW = math.radians(4.0)
MARGIN = 1.02
SETTLE_SECONDS = 1.5
REPEAT_SECONDS = 0.5


class FlatCamera:
    """Fits ``rectangle`` = (x0, x1, y0, y1) into a client's canvas, whatever its shape."""

    def __init__(self, client: viser.ClientHandle, rectangle: tuple[float, float, float, float]):
        self._client, self._rectangle = client, rectangle
        self._lock = threading.Lock()
        self._size: tuple[int, int] | None = None
        self._target: np.ndarray | None = None
        self._settle_until = self._next_fit = 0.0
        self._hair = 0
        self._left = 0.0
        client.camera.on_update(lambda _: self.fit())
        self.fit(force=True)

    def show(self, rectangle: tuple[float, float, float, float]) -> None:
        """Look at another rectangle from now on."""
        if rectangle != self._rectangle:
            self._rectangle = rectangle
            self.fit(force=True)

    def leave(self, pixels: float) -> None:
        """Leave so many pixels free at the bottom, but no more than a third of the canvas."""
        if pixels != self._left:
            self._left = pixels
            self.fit(force=True)

    def settle(self) -> None:
        """Call now and then: repeats the fit while the canvas is settling."""
        now = monotonic()
        if now < self._settle_until + 1 and now > self._next_fit:
            self._next_fit = now + REPEAT_SECONDS
            self.fit(force=True)

    @property
    def width(self) -> int:
        """Of the canvas, in pixels."""
        return int(self._client.camera.image_width)

    @property
    def scale(self) -> float:
        """Pixels that a length of one on the stage takes."""
        camera = self._client.camera
        return camera.image_height / self._height(camera.image_width / max(1, camera.image_height))

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
            astray = monotonic() < self._settle_until and (
                self._target is None or not np.allclose(camera.position, self._target, rtol=1e-3, atol=1e-3))
            if force or size != self._size or turned or astray:
                self._size = size
                self._look(size[0] / max(1, size[1]))

    def _look(self, aspect: float) -> None:
        x0, x1, y0, y1 = self._rectangle
        self._hair = (self._hair + 1) % 7
        height = self._height(aspect) * (MARGIN + 1e-4 * self._hair)
        distance = 0.5 * height / math.tan(FIELD_OF_VIEW / 2)
        x, y = (x0 + x1) / 2, (y0 + y1) / 2 - 0.5 * self._share * height
        self._target = np.array((x, y, distance))
        camera = self._client.camera
        with self._client.atomic():
            camera.near, camera.far, camera.fov = 0.05 * distance, 20 * distance, FIELD_OF_VIEW
            camera.min_orbit_distance, camera.max_orbit_distance = distance / 20, 3 * distance
            camera.up_direction = (0.0, 1.0, 0.0)
            camera.position, camera.look_at = (x, y, distance), (x, y, 0.0)

    def _height(self, aspect: float) -> float:
        """Of what is looked at, at least the rectangle, on a canvas so many times as wide as high."""
        x0, x1, y0, y1 = self._rectangle
        return max((y1 - y0) / (1 - self._share), (x1 - x0) / aspect)

    @property
    def _share(self) -> float:
        """Of the canvas's height that is left free."""
        return min(1 / 3, self._left / max(1, self._client.camera.image_height))
