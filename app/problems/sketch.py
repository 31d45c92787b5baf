"""Sketch: lines, dots and words in the plane z = 0 that are drawn anew each time; what is not drawn again goes."""

import numpy as np
import viser

from app import drawing

THICKNESSES = (1.0, 2.0, 3.5, 5.5, 8.0)  # pixels
SIZES = (0.012, 0.024, 0.036)  # across, of dots
LAYER = 1e-3  # what is drawn later lies higher
Colour = tuple[int, int, int]


class Sketch:
    """Collects what is drawn until :meth:`show` sends it; points are (m, 2) of the stage."""

    def __init__(self, s: viser.SceneApi, root: str):
        self._scene, self._root = s, root
        self._lines = [drawing.lines(s, f"{root}/lines{k}", drawing.DOT, t) for k, t in enumerate(THICKNESSES)]
        self._dots = [drawing.points(s, f"{root}/dots{k}", size) for k, size in enumerate(SIZES)]
        self._labels: list[viser.LabelHandle] = []
        self._clear()

    def _clear(self) -> None:
        away = np.full((1, 2, 3), drawing.AWAY, np.float32)
        self._segments = [[(away, np.zeros((1, 2, 3), np.uint8))] for _ in THICKNESSES]
        self._points = [[(away[:, 0], np.zeros((1, 3), np.uint8))] for _ in SIZES]
        self._texts: list[tuple[str, tuple[float, float, float], drawing.Anchor, float]] = []
        self._depth = 0.0

    def line(self, starts: np.ndarray, ends: np.ndarray, colour: Colour, thickness: float | np.ndarray = 1.0) -> None:
        """From each start to its end, as near to so many pixels thick as there is."""
        self._depth += LAYER
        kind = np.abs(np.subtract.outer(np.broadcast_to(thickness, len(starts)), THICKNESSES)).argmin(axis=1)
        segments = drawing.joined(drawing.in_plane(starts[:, 0], starts[:, 1], self._depth),
                                  drawing.in_plane(ends[:, 0], ends[:, 1], self._depth))
        for k, drawn in enumerate(self._segments):
            chosen = segments[kind == k]
            drawn.append((chosen, np.broadcast_to(np.array(colour, np.uint8), chosen.shape)))

    def outline(self, corners: np.ndarray, colour: Colour, thickness: float = 1.0) -> None:
        """Closed outlines through corners (m, c, 2)."""
        self.line(corners.reshape(-1, 2), np.roll(corners, -1, axis=1).reshape(-1, 2), colour, thickness)

    def arrow(self, starts: np.ndarray, along: np.ndarray, colour: Colour, thickness: float = 2.0) -> None:
        """From each start along a vector, with a head of a size that goes with the length, up to a limit."""
        ends, length = starts + along, np.hypot(*along.T)[:, None]
        head = np.minimum(0.35, 0.022 / np.maximum(length, 1e-12)) * along
        side = 0.55 * np.stack([-head[:, 1], head[:, 0]], axis=1)
        self.line(np.concatenate([starts, ends, ends]), np.concatenate([ends, ends - head + side, ends - head - side]),
                  colour, thickness)

    def dots(self, at: np.ndarray, colour: Colour, size: int = 1) -> None:
        """Of one of the ``SIZES``."""
        self._depth += LAYER
        self._points[size].append((drawing.in_plane(at[:, 0], at[:, 1], self._depth),
                                   np.tile(np.array(colour, np.uint8), (len(at), 1))))

    def text(self, x: float, y: float, text: str, anchor: drawing.Anchor, size: float = 0.85) -> None:
        self._texts.append((text, (float(x), float(y), 0.0), anchor, size))

    def show(self) -> None:
        """Send it all, and begin anew."""
        for lines, drawn in zip(self._lines, self._segments, strict=True):
            lines.points, lines.colors = (np.concatenate(part) for part in zip(*drawn, strict=True))
        for cloud, points in zip(self._dots, self._points, strict=True):
            cloud.points, cloud.colors = (np.concatenate(part) for part in zip(*points, strict=True))
        for k in range(len(self._labels), len(self._texts)):
            self._labels.append(drawing.label(self._scene, f"{self._root}/label{k}", " ", 0.0, 0.0, "top-left"))
        for handle in self._labels[len(self._texts):]:
            handle.visible = False
        for handle, (text, at, anchor, size) in zip(self._labels, self._texts, strict=False):
            drawing.resize(self._scene, handle, size)
            for name, value in (("text", text), ("anchor", anchor), ("visible", True)):
                if getattr(handle, name) != value:
                    setattr(handle, name, value)
            if tuple(handle.position) != at:
                handle.position = at
        self._clear()
