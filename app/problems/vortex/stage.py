"""The vortex, made to fit the stage: particles on the left half show the estimate, those on the right the truth; lines
of material that were straight, as the exact solution has them; and the field plot below."""

import numpy as np
import viser

from app import drawing
from app.colours import TRUTH
from app.problems.field import Place
from app.problems.planar_stage import PlanarStage
from app.problems.stage import Stage
from app.scale import ColourScale
from solvers.engine.frames import FrameArrays
from solvers.problems.planar.layout import Layout, half_edges, particle_layout
from solvers.problems.vortex import exact
from solvers.problems.vortex.exact import INNER, OUTER
from solvers.problems.vortex.scene import VortexScene

SPOKES, SPOKE_POINTS = 12, 41
_ANGLES = 2 * np.pi * np.arange(SPOKES)[:, None] / SPOKES
SPOKES_AT_REST = np.linspace(INNER, OUTER, SPOKE_POINTS)[:, None] * np.stack([np.cos(_ANGLES), np.sin(_ANGLES)], 2)
FIELD = Place(-0.22, 0.1, INNER, OUTER, (f"R = {INNER} m", f"{OUTER} m"), exact.field, "angular")


class VortexStage(PlanarStage[VortexScene]):
    """Draws frames of the vortex in one client's scene. Its four quarters are alike, so that half of it shows all."""

    PROBLEM, PLOT, LINES = "vortex", FIELD, SPOKES

    def __init__(self, client: viser.ClientHandle, scale: ColourScale, beside: Stage | None = None):
        super().__init__(client, scale, beside)
        self._dots = drawing.points(client.scene, f"{self.at}/particles", 0.01)
        self._spokes = drawing.lines(client.scene, f"{self.at}/spokes", drawing.rgb(TRUTH), 1.5)

    def _draw_frame(self, scene: VortexScene, arrays: FrameArrays, estimated: np.ndarray | None,
                    true: np.ndarray | None, t: float, speed: float) -> None:
        super()._draw_frame(scene, arrays, estimated, true, t, speed)
        self._spokes.visible = scene.solution_known
        if scene.solution_known:
            x = self._place(self.exact_lines(scene, t, SPOKES).reshape(-1, 2), 0.015).reshape(SPOKES, SPOKE_POINTS, 3)
            drawing.put(self._spokes, drawing.joined(x[:, :-1].reshape(-1, 3), x[:, 1:].reshape(-1, 3)))

    def _draw_halves(self, x: np.ndarray, estimated: np.ndarray | None, true: np.ndarray | None) -> None:
        on_left = x[:, 0] < 0
        shades = np.where(on_left[:, None], drawing.shades(self._scale, estimated, len(x)),
                          drawing.shades(self._scale, true, len(x)))
        drawing.put(self._dots, self._images(x, self.MIRRORS), shades)

    @staticmethod
    def exact_lines(scene: VortexScene, t: float, count: int) -> np.ndarray:
        return exact.position(scene, SPOKES_AT_REST[:count].reshape(-1, 2), t).reshape(count, SPOKE_POINTS, 2)

    def _layout(self, scene: VortexScene) -> Layout:
        return particle_layout(scene)

    def _reach(self, scene: VortexScene) -> float:
        return outermost(scene)

    @staticmethod
    def note(scene: VortexScene) -> str:
        lines = ", blue: exact lines" * scene.solution_known
        return f"h = {scene.spacing:.3g} m{lines}"  # the plot below says how large it is

    @staticmethod
    def first_line(scene: VortexScene) -> float:
        return 0.5 * scene.spacing * (scene.cells % 2)

    def _size_dots(self, width: float) -> None:
        super()._size_dots(width)
        self._dots.point_size = 0.58 * width


def outermost(scene: VortexScene) -> float:
    """How far from the middle a particle should come, in metres: circles keep their radius."""
    return OUTER


def domains(scene: VortexScene, F: np.ndarray) -> np.ndarray:
    """Half the edge vectors (P, 2, 2) in metres of the particles' domains for deformation gradients F (P, 2, 2)."""
    return half_edges(scene, F, particle_layout(scene).edges)


STAGE = VortexStage
