"""The ring, made to fit the stage: a quarter and its mirror images, estimate on the left half, truth on the right, and
the field plot below."""

from collections.abc import Iterator

import numpy as np

from app.frame.field import PlotPlace
from app.frame.marks import Dots, Mark, shades
from app.frame.planar import PlanarStage
from solvers.problems.ring import exact
from solvers.problems.ring.exact import INNER, OUTER
from solvers.problems.ring.scene import RingScene

MIRRORS = ((1, 1), (1, -1), (-1, 1), (-1, -1))  # signs of x and y; the first two are the truth's half


class RingStage(PlanarStage[RingScene]):
    """Makes marks of frames of the ring."""

    PLOT = PlotPlace(-0.22, 0.1, INNER, OUTER, (f"R = {INNER} m", f"{OUTER} m"), exact.field, "radial")
    MIRRORS, OUTLINED = MIRRORS, MIRRORS[::2]

    @staticmethod
    def outermost(scene: RingScene) -> float:
        return OUTER + scene.amplitude

    @staticmethod
    def note(scene: RingScene) -> str:
        return f"outer radius {OUTER} m at rest, h = {scene.spacing:.3g} m"

    def _halves(self, x: np.ndarray, estimated: np.ndarray | None, true: np.ndarray | None) -> Iterator[Mark]:
        for half, mirrors, sizes in (("truth", MIRRORS[:2], true), ("estimate", MIRRORS[2:], estimated)):
            yield Dots(half, self._images(x, mirrors), np.tile(shades(self._scale, sizes, len(x)), (2, 1)),
                       1.16 * self._width)
