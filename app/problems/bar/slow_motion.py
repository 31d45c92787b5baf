"""Slow motion of the bar's step: its cells above, with the nodes' shape functions, and its particles below."""

import numpy as np

from app.frame.layout import Rectangle
from app.frame.primitives import Colour, StageMetrics
from app.frame.slow_motion.stage import DOMAINS, FRONT, NODE, OTHERS, SlowMotionStage, averaged_hat
from solvers.scene.scene import Scene
from solvers.solver.particle_step_breakdown import ParticleStepBreakdown

NODES_AT, PARTICLES_AT = 0.48, 0.16  # as shares of the picture's height
HEIGHT = 0.44  # of a shape function of one, as a share of it
LETTERS = 130, 190  # most letters above and below the picture
POINTS = 201  # of a curve


class BarSlowMotionStage(SlowMotionStage):
    """Slow-motion stage of the bar: nodes with their shape functions above, particles below, captions around them."""

    _above, _aside = 0.03, np.array([0.0, 1.0])

    def _split_text_and_picture(self, metrics: StageMetrics) -> tuple[float, Rectangle]:
        line, letters_per_line = metrics.line_height, metrics.letters_per_line(1.0)
        above, below = (line * (1 + letters // letters_per_line) for letters in LETTERS)
        return 1.0, (0.0, 1.0, below + metrics.line_height, metrics.high - above)

    def _row_height(self, share: float) -> float:
        """Returns the height on the stage at a share, 0 to 1, of the picture's height."""
        return self._picture[2] + share * (self._picture[3] - self._picture[2])

    def _fit_step_in_picture(self, a: ParticleStepBreakdown) -> None:
        x = np.concatenate([a.nodes, a.place])
        self._left, self._right = x.min() - 0.3 * a.spacing, x.max() + 0.3 * a.spacing
        self._per_metre = 1.0 / (self._right - self._left)

    def _stage_x(self, x: np.ndarray) -> np.ndarray:
        return self._per_metre * (x - self._left)

    def _stage_points(self, x: np.ndarray, y: float | np.ndarray) -> np.ndarray:
        return np.stack(np.broadcast_arrays(self._stage_x(x), y), axis=1)

    def _particle_spots(self, x: np.ndarray) -> np.ndarray:
        return self._stage_points(x[:, 0], self._row_height(PARTICLES_AT))

    def _node_spots(self, x: np.ndarray) -> np.ndarray:
        return self._stage_points(x[:, 0], self._row_height(NODES_AT))

    def _stage_vectors(self, vectors: np.ndarray) -> np.ndarray:
        return np.concatenate([vectors, np.zeros_like(vectors)], axis=1)

    def _draw_domains(self, x: np.ndarray, edges: np.ndarray, colour: Colour, thickness: float) -> None:
        ends = x + edges[:, 0] * np.array([[-1, 1]])
        low, high = (np.stack([self._stage_x(ends), np.full(ends.shape, self._row_height(PARTICLES_AT + y))], axis=2)
                     for y in (-0.04, 0.04))
        self._sketch.outline(np.concatenate([low, high[:, ::-1]], axis=1), colour, thickness)

    def _draw_cells(self, a: ParticleStepBreakdown) -> None:
        edges = a.spacing * np.arange(np.ceil(self._left / a.spacing), np.floor(self._right / a.spacing) + 1)
        low, high = self._row_height(PARTICLES_AT - 0.08), self._row_height(NODES_AT)
        self._sketch.line(self._stage_points(edges, low), self._stage_points(edges, high), DOMAINS)
        ends = np.array([self._left, self._right])
        for y in (NODES_AT, PARTICLES_AT):
            self._sketch.line(self._stage_points(ends[:1], self._row_height(y)),
                              self._stage_points(ends[1:], self._row_height(y)), OTHERS)

    def _draw_shape_functions(self, scene: Scene, a: ParticleStepBreakdown, s: float) -> None:
        """Draws a curve per node, ``s`` times as high as its values: the weight of a particle at any position with a
        domain like the selected one's."""
        h, place, high = a.spacing, a.place[0, 0], self._row_height(HEIGHT) - self._row_height(0.0)
        reach = 0.5 if scene.method == "bspline" else float(a.edges[0, 0, 0]) / h
        x = np.linspace(self._left, self._right, POINTS)
        for node in a.nodes[:, 0]:
            curve = self._stage_points(x, self._row_height(NODES_AT) + s * high * averaged_hat((x - node) / h, reach))
            self._sketch.line(curve[:-1], curve[1:], OTHERS, 2.0)
        read = self._stage_points(np.full(len(a.nodes), place),
                                  self._row_height(NODES_AT) + s * high * a.links.weight[0])
        self._sketch.line(self._spots[:1], self._stage_points(a.place[0], self._row_height(NODES_AT) + high), FRONT)
        self._sketch.line(read, np.stack([self._nodes[:, 0], read[:, 1]], axis=1), FRONT)
        self._sketch.dots(read, FRONT, 1)
        self._sketch.dots(np.stack([self._nodes[:, 0], read[:, 1]], axis=1), NODE, 0)
