"""Slow motion of a plane problem's step: the cells around one particle, with shape functions plotted over them."""

import numpy as np

from app.frame.layout import Rectangle
from app.frame.primitives import Colour, StageMetrics
from app.frame.slow_motion.stage import DOMAINS, FRONT, OTHERS, SlowMotionStage, averaged_hat
from solvers.problems.planar.particle_layout import CORNERS
from solvers.scene.scene import Scene
from solvers.solver.particle_step_breakdown import ParticleStepBreakdown

AROUND = 0.75  # cells shown around the nodes
HEIGHT = 0.13  # height of a shape function of one, as a share of the picture
BESIDE = 0.36  # width of the text beside the picture
POINTS = 121  # of a curve


class PlanarSlowMotionStage(SlowMotionStage):
    """Slow-motion stage of a plane problem: cells and particles in the plane beside the captions."""

    _above, _aside = 0.02, np.array([0.0, 0.0])

    def _split_text_and_picture(self, metrics: StageMetrics) -> tuple[float, Rectangle]:
        return BESIDE, (BESIDE + 0.03, 1.0, 0.0, metrics.high)

    def _fit_step_in_picture(self, a: ParticleStepBreakdown) -> None:
        x = np.concatenate([a.nodes, a.place[:1]])
        low, high = x.min(axis=0) - AROUND * a.spacing, x.max(axis=0) + AROUND * a.spacing
        x0, x1, y0, y1 = self._picture
        self._per_metre = float(min((x1 - x0) / (high[0] - low[0]), (y1 - y0) / (high[1] - low[1])))
        self._middle, self._low, self._high = 0.5 * (low + high), low, high

    def _to_stage(self, x: np.ndarray) -> np.ndarray:
        x0, x1, y0, y1 = self._picture
        return np.array([0.5 * (x0 + x1), 0.5 * (y0 + y1)]) + self._per_metre * (x - self._middle)

    _particle_spots = _node_spots = _to_stage

    def _stage_vectors(self, vectors: np.ndarray) -> np.ndarray:
        return vectors

    def _draw_domains(self, x: np.ndarray, edges: np.ndarray, colour: Colour, thickness: float) -> None:
        corners = x[:, None] + np.einsum("ce,ked->kcd", 2 * np.array(CORNERS), edges)
        self._sketch.outline(self._to_stage(corners), colour, thickness)

    def _draw_cells(self, a: ParticleStepBreakdown) -> None:
        for axis in range(2):
            h, low, high = a.spacing, self._low[axis], self._high[axis]
            at = h * np.arange(np.ceil(low / h), np.floor(high / h) + 1)
            ends = np.empty((2, len(at), 2))
            ends[:, :, axis] = at
            ends[0, :, 1 - axis], ends[1, :, 1 - axis] = self._low[1 - axis], self._high[1 - axis]
            starts, stops = self._to_stage(ends)
            self._sketch.line(starts, stops, DOMAINS)

    def _draw_shape_functions(self, scene: Scene, a: ParticleStepBreakdown, s: float) -> None:
        """Draws a node's weight as the product of a function of x and one of y, ``s`` times as high as its value; for
        CPDI read at the corners of the particle's domain, otherwise at the particle."""
        cpdi = scene.method == "cpdi"
        feet = a.place[0] + 2 * np.array(CORNERS) @ a.edges[0] if cpdi else a.place[:1]
        for axis in range(2):
            reach = 0.0 if cpdi else float(a.edges[0, axis, axis]) / a.spacing
            x = np.linspace(self._low[axis], self._high[axis], POINTS)
            base = self._to_stage(self._low)[1 - axis]

            def graph_points(along: np.ndarray, value: np.ndarray, axis: int = axis, base: float = base) -> np.ndarray:
                """Returns stage points (n, 2) for a function's values (n,) at positions (n,) in m along the axis."""
                out = np.empty((len(along), 2))
                out[:, axis] = self._to_stage(np.stack([along, along], axis=1))[:, axis]
                out[:, 1 - axis] = base + s * HEIGHT * (self._picture[3] - self._picture[2]) * value
                return out

            for node in np.unique(a.nodes[:, axis].round(12)):
                curve = graph_points(x, averaged_hat((x - node) / a.spacing, reach))
                self._sketch.line(curve[:-1], curve[1:], OTHERS, 2.0)
                read = graph_points(feet[:, axis], averaged_hat((feet[:, axis] - node) / a.spacing, reach))
                self._sketch.dots(read, FRONT, 0)
            self._sketch.line(graph_points(feet[:, axis], np.zeros(len(feet))), self._to_stage(feet), FRONT)
        if cpdi:
            self._sketch.dots(self._to_stage(feet), FRONT, 0)
