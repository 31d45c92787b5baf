"""One step of the bar in slow motion: its cell above, with the nodes' shape functions, and its particles below."""

import numpy as np

from app.frame.marks import Colour
from app.frame.slow.stage import DOMAINS, FRONT, NODE, OTHERS, SlowStage, shape
from solvers.scene.scene import Scene
from solvers.solver.step_breakdown import StepBreakdown

NODES_AT, PARTICLES_AT = 0.43, 0.14
HEIGHT = 0.42  # of a shape function that is one
POINTS = 201  # of a curve


class BarSlowStage(SlowStage):
    """Draws one step of the bar taken apart."""

    _picture = (-0.1, 1.06, 0.0, 0.9)
    _above, _aside = 0.06, np.array([0.0, 1.0])

    def _look_at(self, a: StepBreakdown) -> None:
        x = np.concatenate([a.nodes, a.place])
        self._left, self._right = x.min() - 0.3 * a.spacing, x.max() + 0.3 * a.spacing
        self._per_metre = 1.1 / (self._right - self._left)

    def _stage_x(self, x: np.ndarray) -> np.ndarray:
        return -0.07 + self._per_metre * (x - self._left)

    def _at(self, x: np.ndarray, y: float | np.ndarray) -> np.ndarray:
        return np.stack(np.broadcast_arrays(self._stage_x(x), y), axis=1)

    def _particle_spots(self, x: np.ndarray) -> np.ndarray:
        return self._at(x[:, 0], PARTICLES_AT)

    def _node_spots(self, x: np.ndarray) -> np.ndarray:
        return self._at(x[:, 0], NODES_AT)

    def _aim(self, vectors: np.ndarray) -> np.ndarray:
        return np.concatenate([vectors, np.zeros_like(vectors)], axis=1)

    def _outline(self, x: np.ndarray, edges: np.ndarray, colour: Colour, thickness: float) -> None:
        ends = x + edges[:, 0] * np.array([[-1, 1]])
        low, high = (np.stack([self._stage_x(ends), np.full(ends.shape, PARTICLES_AT + y)], axis=2)
                     for y in (-0.03, 0.03))
        self._sketch.outline(np.concatenate([low, high[:, ::-1]], axis=1), colour, thickness)

    def _ground(self, a: StepBreakdown) -> None:
        first = np.ceil(self._left / a.spacing)
        edges = a.spacing * np.arange(first, np.floor(self._right / a.spacing) + 1)
        self._sketch.line(self._at(edges, PARTICLES_AT - 0.06), self._at(edges, NODES_AT), DOMAINS)
        ends = np.array([self._left, self._right])
        for y in (NODES_AT, PARTICLES_AT):
            self._sketch.line(self._at(ends[:1], y), self._at(ends[1:], y), OTHERS)

    def _functions(self, scene: Scene, a: StepBreakdown, s: float) -> None:
        """A curve for each node: the weight of a particle like the one in front, wherever it were."""
        h, place = a.spacing, a.place[0, 0]
        reach = 0.5 if scene.method == "bspline" else float(a.edges[0, 0, 0]) / h
        x = np.linspace(self._left, self._right, POINTS)
        for node in a.nodes[:, 0]:
            curve = self._at(x, NODES_AT + s * HEIGHT * shape((x - node) / h, reach))
            self._sketch.line(curve[:-1], curve[1:], OTHERS, 2.0)
        read = self._at(np.full(len(a.nodes), place), NODES_AT + s * HEIGHT * a.links.weight[0])
        self._sketch.line(self._spots[:1], self._at(a.place[0], NODES_AT + HEIGHT), FRONT)
        self._sketch.line(read, np.stack([self._nodes[:, 0], read[:, 1]], axis=1), FRONT)
        self._sketch.dots(read, FRONT, 1)
        self._sketch.dots(np.stack([self._nodes[:, 0], read[:, 1]], axis=1), NODE, 0)
