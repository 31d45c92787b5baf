"""The ring, made to fit the stage: a quarter and its mirror images, estimate on the left half, truth on the right, and
the field plot below."""

import numpy as np
import viser

from app import drawing
from app.problems.field import Place
from app.problems.planar_stage import PlanarStage
from app.problems.stage import Stage
from app.scale import ColourScale
from solvers.problems.planar.layout import Layout, half_edges, particle_layout
from solvers.problems.ring import exact
from solvers.problems.ring.exact import INNER, OUTER
from solvers.problems.ring.scene import RingScene

MIRRORS = ((1, 1), (1, -1), (-1, 1), (-1, -1))  # signs of x and y; the first two are the truth's half
FIELD = Place(-0.22, 0.1, INNER, OUTER, (f"R = {INNER} m", f"{OUTER} m"), exact.field, "radial")


class RingStage(PlanarStage[RingScene]):
    """Draws frames of the ring in one client's scene."""

    PROBLEM, PLOT = "ring", FIELD
    MIRRORS, OUTLINED = MIRRORS, MIRRORS[::2]

    def __init__(self, client: viser.ClientHandle, scale: ColourScale, beside: Stage | None = None):
        super().__init__(client, scale, beside)
        self._halves = [drawing.points(client.scene, f"{self.at}/{name}", 0.01) for name in ("truth", "estimate")]

    def _draw_halves(self, x: np.ndarray, estimated: np.ndarray | None, true: np.ndarray | None) -> None:
        for half, mirrors, sizes in zip(self._halves, (MIRRORS[:2], MIRRORS[2:]), (true, estimated), strict=True):
            drawing.put(half, self._images(x, mirrors), np.tile(drawing.shades(self._scale, sizes, len(x)), (2, 1)))

    def _layout(self, scene: RingScene) -> Layout:
        return particle_layout(scene)

    def _reach(self, scene: RingScene) -> float:
        return outermost(scene)

    @staticmethod
    def note(scene: RingScene) -> str:
        return f"outer radius {OUTER} m at rest, h = {scene.spacing:.3g} m"

    def _size_dots(self, width: float) -> None:
        super()._size_dots(width)
        for half in self._halves:
            half.point_size = 0.58 * width


def outermost(scene: RingScene) -> float:
    """How far from the middle a particle should come, in metres."""
    return OUTER + scene.amplitude


def domains(scene: RingScene, F: np.ndarray) -> np.ndarray:
    """Half the edge vectors (P, 2, 2) in metres of the particles' domains for deformation gradients F (P, 2, 2)."""
    return half_edges(scene, F, particle_layout(scene).edges)


STAGE = RingStage
