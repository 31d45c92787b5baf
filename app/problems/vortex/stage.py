"""The vortex, made to fit the stage: particles on the left half show the estimate, those on the right the truth; lines
of material that were straight, as the exact solution has them; and the field plot beside it."""

from collections.abc import Iterator

import numpy as np

from app.frame.field import Plotted
from app.frame.marks import Dots, Lines, Mark, joined
from app.frame.planar import PlanarStage
from app.language.spoken import tr
from solvers.engine.frames import FrameArrays
from solvers.problems.vortex import exact
from solvers.problems.vortex.exact import INNER, OUTER
from solvers.problems.vortex.scene import VortexScene

SPOKES, SPOKE_POINTS = 12, 41
_ANGLES = 2 * np.pi * np.arange(SPOKES)[:, None] / SPOKES
SPOKES_AT_REST = np.linspace(INNER, OUTER, SPOKE_POINTS)[:, None] * np.stack([np.cos(_ANGLES), np.sin(_ANGLES)], 2)


class VortexStage(PlanarStage[VortexScene]):
    """Makes marks of frames of the vortex. Its four quarters are alike, so that half of it shows all."""

    PLOT = Plotted(INNER, OUTER, (f"R = {INNER} m", f"{OUTER} m"), exact.field, "angular")
    LINES = SPOKES

    @staticmethod
    def outermost(scene: VortexScene) -> float:
        return OUTER  # circles keep their radius

    @staticmethod
    def note(scene: VortexScene) -> str:
        if not scene.solution_known:
            return f"h = {scene.spacing:.3g} m"
        return tr("h = {h:.3g} m, blue: exact lines", h=scene.spacing)  # the plot below says how large it is

    @staticmethod
    def first_line(scene: VortexScene) -> float:
        return 0.5 * scene.spacing * (scene.cells % 2)

    @staticmethod
    def exact_lines(scene: VortexScene, t: float, count: int) -> np.ndarray:
        return exact.position(scene, SPOKES_AT_REST[:count].reshape(-1, 2), t).reshape(count, SPOKE_POINTS, 2)

    def _moving(self, scene: VortexScene, arrays: FrameArrays, estimated: np.ndarray, true: np.ndarray, t: float,
                crossed: np.ndarray, age: np.ndarray) -> Iterator[Mark]:
        yield from super()._moving(scene, arrays, estimated, true, t, crossed, age)
        lines = self.exact_lines(scene, t, SPOKES * scene.solution_known)
        x = self._place(lines.reshape(-1, 2), 0.015).reshape(-1, SPOKE_POINTS, 3)
        yield Lines("spokes", joined(x[:, :-1].reshape(-1, 3), x[:, 1:].reshape(-1, 3)),
                    self._places.room.palette.exact, 1.5)

    def _halves(self, x: np.ndarray, estimated: np.ndarray, true: np.ndarray) -> Iterator[Mark]:
        colours = np.where(x[:, :1] < 0, estimated, true)
        yield Dots("particles", self._images(x, self.MIRRORS), colours, self._width, self._shape)
