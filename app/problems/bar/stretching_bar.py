"""A picture of what the method moves, before any run: a bar in pieces, which stretches over a grid that stays."""

from dataclasses import replace

import numpy as np

from app.colour_palette import PIECE_COLOURS, rgb
from app.frame.layout import Rectangle, drawing_rectangle
from app.frame.primitives import Dots, Label, Lines, Mark, StageMetrics, Surface, in_plane, join_points, wrap_text
from app.language.translation import tr
from solvers.problems.bar import exact_solution
from solvers.problems.bar.scene import BarScene

PIECES, MAGNIFIED = 80, 20
SECONDS = 2.0  # that a period of the motion takes on the screen
HEIGHT, LEAST, MOST = 0.076, 40.0, 84.0  # of the bar, as a share of its length, and in pixels
GAP, SPOT = 1.5, 4.8  # pixels between two pieces, and across the spot in the middle of one
LOWEST = 0.3  # height of the picture
OVER, OVER_TENTH = 26.0, 34.0  # pixels by which the grid's lines are longer than the bar is high, to either side
TIGHT = 1.02  # factor on the size of points, to close gaps from rounding
ABOVE, BELOW = 12.0, 24.0  # pixels between the grid and the words
WORDS, NAME, NOTE = 1.17, 1.08, 1.0  # sizes of letters


class StretchingBar:
    """Picture of a scene's bar in pieces, on the surface ``sheet``; they move as the exact solution, 20 times as
    far."""

    def __init__(self, sheet: Surface, scene: BarScene):
        self.sheet, self._scene = sheet, scene
        self._drawn: StageMetrics | None = None

    def draw(self, seconds: float) -> Rectangle:
        """Draws the bar so many seconds after its start, when it is at rest; returns the rectangle of the picture."""
        metrics = self.sheet.stage_metrics.rounded()
        metrics = replace(metrics, high=max(metrics.high, LOWEST))
        if metrics != self._drawn:
            self._drawn = metrics
            self._lay_out(metrics)
            self.sheet.show_marks(*self._still_marks(metrics))
        self.sheet.show_marks(*self._moving_marks(seconds, metrics.pixel))
        return drawing_rectangle(metrics.high)

    def _lay_out(self, metrics: StageMetrics) -> None:
        """Places the bar, and tiles its pieces with as few square points as can be: one row has a point for each piece
        at its left end, wide enough when it is longest, and one in the ground's colour for the gap on its right. Each
        covers what is too long of the point before."""
        pixel, colours = metrics.pixel, metrics.palette
        self._middle, self._high = 0.58 * metrics.high, min(max(HEIGHT, LEAST * pixel), MOST * pixel)
        slope = exact_solution.WAVENUMBER * MAGNIFIED * self._scene.amplitude
        rows = max(1, int(self._high * PIECES / (1 + slope)))
        self._size = self._high / rows
        self._up = self._middle + (np.arange(rows) + 0.5) * self._size - 0.5 * self._high
        tones = np.array([rgb(shades[metrics.dark]) for shades in PIECE_COLOURS], np.uint8)
        columns = np.empty((PIECES, 2, 3), np.uint8)
        columns[::2, 0], columns[1::2, 0], columns[:, 1] = *tones, colours.ground
        self._colours = np.tile(columns.reshape(-1, 3), (rows, 1))
        self._spot_colour = np.array(colours.ground, np.uint8)
        self._apart = int(np.ceil(SPOT * pixel * PIECES / (1 - slope)))  # pieces from one with a spot to the next

    def _still_marks(self, metrics: StageMetrics) -> list[Mark]:
        """Returns the grid, every tenth line longer, and the words above and below it."""
        pixel, high, middle = metrics.pixel, 0.5 * self._high, self._middle
        nodes = np.linspace(0, 1, self._scene.cells + 1)
        over = high + pixel * np.where(np.arange(len(nodes)) % 10, OVER, OVER_TENTH)
        edges = in_plane(np.zeros(2), middle + (high + OVER * pixel) * np.array([-1, 1]), -0.01)
        lines = join_points(in_plane(nodes, middle - over, -0.01), in_plane(nodes, middle + over, -0.01))
        grid = np.concatenate([lines, join_points(edges, edges + np.array([1, 0, 0], np.float32))])
        outside = high + OVER_TENTH * pixel
        words = tr("each piece is a particle; it carries mass, velocity and stress")
        letters, below = metrics.letters_per_line(1.0, WORDS), middle - outside - BELOW * pixel
        rows = 1 + wrap_text(words, letters).count("\n")
        return [Lines("grid", grid, metrics.palette.cell, 1.0),
                Label("name", tr("the grid stays"), 0.0, middle + outside + ABOVE * pixel, "bottom-left", "note", NAME),
                Label("words", words, 0.5, below, "top-center", "note", WORDS, letters, bold=True),
                Label("note", tr("motion drawn {factor} times as large", factor=MAGNIFIED), 0.5,
                      below - (WORDS * rows + 0.4) * metrics.line_height, "top-center", "note", NOTE, tone="faint")]

    def _moving_marks(self, seconds: float, pixel: float) -> list[Mark]:
        X = np.linspace(0, 1, PIECES + 1)
        t = self._scene.period * seconds / SECONDS
        edges = X + MAGNIFIED * exact_solution.displacement(self._scene, X, t)
        gap, half = 0.5 * GAP * pixel, 0.5 * self._size
        across = np.stack([edges[:-1] + gap, edges[1:] - gap], axis=1).ravel() + half
        rows = in_plane(np.tile(across, len(self._up)), np.repeat(self._up, len(across)))
        spots = in_plane(0.5 * (edges[:-1] + edges[1:])[::self._apart], self._middle, 0.02)
        return [Dots("pieces", rows, self._colours, TIGHT * self._size, "square"),
                Dots("spots", spots, self._spot_colour, SPOT * pixel)]
