"""Sketch: lines, dots and labels in the plane z = 0 that are redrawn each time; others disappear."""

from collections.abc import Iterator

import numpy as np

from app.frame.primitives import Anchor, Colour, Dots, Label, Lines, Mark, in_plane, join_points

THICKNESSES = (1.0, 2.0, 3.5, 5.5, 8.0)  # pixels
SIZES = (0.012, 0.024, 0.036)  # diameters of dots
LAYER = 1e-3  # z step: later marks are on top


class Sketch:
    """Collection of marks until :meth:`marks` returns them; points are (m, 2) in stage coordinates."""

    def __init__(self) -> None:
        self._most = 0  # labels so far
        self._clear()

    def _clear(self) -> None:
        none, shade = np.empty((0, 2, 3), np.float32), np.empty((0, 2, 3), np.uint8)
        self._segments = [[(none, shade)] for _ in THICKNESSES]
        self._points = [[(none[:, 0], shade[:, 0])] for _ in SIZES]
        self._texts: list[Label] = []
        self._depth = 0.0

    def line(self, starts: np.ndarray, ends: np.ndarray, colour: Colour, thickness: float | np.ndarray = 1.0) -> None:
        """Draws lines from starts to ends (m, 2), as thick as the available one nearest to a thickness in pixels."""
        self._depth += LAYER
        kind = np.abs(np.subtract.outer(np.broadcast_to(thickness, len(starts)), THICKNESSES)).argmin(axis=1)
        segments = join_points(*(in_plane(at[:, 0], at[:, 1], self._depth) for at in (starts, ends)))
        for k, drawn in enumerate(self._segments):
            chosen = segments[kind == k]
            drawn.append((chosen, np.broadcast_to(np.array(colour, np.uint8), chosen.shape)))

    def outline(self, corners: np.ndarray, colour: Colour, thickness: float = 1.0) -> None:
        """Draws m closed outlines through c corners each, (m, c, 2), with a thickness in pixels."""
        self.line(corners.reshape(-1, 2), np.roll(corners, -1, axis=1).reshape(-1, 2), colour, thickness)

    def arrow(self, starts: np.ndarray, along: np.ndarray, colour: Colour, thickness: float = 2.0) -> None:
        """Draws arrows from starts (m, 2) with the vectors ``along`` (m, 2), both in stage coordinates, with heads
        proportional to the length up to a limit and a thickness in pixels."""
        ends, length = starts + along, np.hypot(*along.T)[:, None]
        head = np.minimum(0.35, 0.022 / np.maximum(length, 1e-12)) * along
        side = 0.55 * np.stack([-head[:, 1], head[:, 0]], axis=1)
        self.line(np.concatenate([starts, ends, ends]), np.concatenate([ends, ends - head + side, ends - head - side]),
                  colour, thickness)

    def dots(self, at: np.ndarray, colour: Colour, size: int = 1) -> None:
        """Draws dots at points ``at`` (m, 2) of the stage; ``size`` is an index into ``SIZES``, their diameters."""
        self._depth += LAYER
        self._points[size].append((in_plane(at[:, 0], at[:, 1], self._depth),
                                   np.tile(np.array(colour, np.uint8), (len(at), 1))))

    def text(self, x: float, y: float, text: str, anchor: Anchor) -> None:
        """Writes a text at the point (x, y) of the stage."""
        self._texts.append(Label(f"label{len(self._texts)}", text, float(x), float(y), anchor, "step"))

    def marks(self) -> Iterator[Mark]:
        """Yields all marks, with empty labels in place of former ones, and clears the sketch."""
        for k, drawn in enumerate(self._segments):
            segments, colours = (np.concatenate(part) for part in zip(*drawn, strict=True))
            yield Lines(f"lines{k}", segments, colours, THICKNESSES[k])
        for k, drawn in enumerate(self._points):
            points, colours = (np.concatenate(part) for part in zip(*drawn, strict=True))
            yield Dots(f"dots{k}", points, colours, SIZES[k])
        yield from self._texts
        for k in range(len(self._texts), self._most):
            yield Label(f"label{k}", "", 0.0, 0.0, "top-left", "step")
        self._most = max(self._most, len(self._texts))
        self._clear()
