"""What the scenes of plane problems have in common: rings around the origin, whole or a part, on a square grid."""

import math
from abc import abstractmethod
from typing import Any, ClassVar

import numpy as np

from solvers.scene.rules import SceneError, require_whole
from solvers.scene.scene import Scene

MOST_CELLS = 10_000
GHOSTS = 2  # rows of nodes beyond a symmetry plane


class PlanarScene(Scene):
    """A run of a ring; no dataclass itself, for the fields are the problem's own, in the order of its flags."""

    layout: str  # "polar" or "cartesian": the lattice on which particles begin
    ppc: int  # per direction
    plan: str  # how the step is spread over the threads

    DIMENSIONS = 2
    EXTRA_ERROR = "a_nodes"
    SIDE: ClassVar[float]  # of the grid, m
    INNER: ClassVar[float]  # radii of the rims, m
    OUTER: ClassVar[float]
    ANGLE: ClassVar[float]  # that the body fills from the x axis on, in radians
    EXACT: ClassVar[Any]  # the exact motion with the built-in force: functions of (scene, X, t)
    PLANES: ClassVar[tuple[bool, bool]]  # whether symmetry planes are at the lower and at the upper ends of x and y
    NOT_LINEARITY_PRESERVING: ClassVar[str]  # why, as the end of a sentence
    MENDS: ClassVar[str]  # what of the other remedies frozen weights have no need of

    @staticmethod
    @abstractmethod
    def polar_counts(cells: int, ppc: int) -> tuple[int, int]:
        """Particles around and across the ring: as many as make their domains about h/ppc wide."""

    @classmethod
    def draw_point(cls, chance: np.random.Generator) -> tuple[float, float]:
        """A material point somewhere in the body, in m."""
        R, angle = chance.uniform(cls.INNER, cls.OUTER), chance.uniform(0, cls.ANGLE)
        return R * math.cos(angle), R * math.sin(angle)

    @property
    def solution_known(self) -> bool:
        """The manufactured solution needs its own force: without it the body moves freely, nobody knows how."""
        return self.body_force == "material"

    @property
    def spacing(self) -> float:
        """Cell size h."""
        return self.SIDE / self.cells

    @property
    def row(self) -> int:
        """Nodes in a row of the grid, those beyond symmetry planes among them."""
        return self.cells + 1

    @property
    def particles(self) -> int:
        """Number of particles in the polar layout; close to it in the Cartesian one."""
        return math.prod(self.polar_counts(self.cells, self.ppc))

    @property
    def uneven(self) -> bool:
        """Whether particles stand so unevenly that recovered's fits follow them, and no more than x and v can be told.

        Measured on 14 such runs of the ring: sigma 1.06 to 5.6 times the error, x .97 to 1.06 while the verdict does
        not doubt it.
        """
        return self.ppc == 1 or self.velocity == "particle"

    @property
    def coarse(self) -> bool:
        """Whether cells are so wide that recovered's fits lose the short waves of the acceleration."""
        return False

    def warnings(self) -> list[str]:
        sentences = super().warnings()
        if "recovered" in self.active_estimators and self.uneven:
            sentences.append("recovered says nothing of sigma and a here: its fits would follow the unevenness of "
                             "particles that are one per cell or move with their own velocity")
        elif "recovered" in self.active_estimators and self.coarse:
            sentences.append("recovered says nothing of a here: on so few cells its fits are as wide as the ring, and "
                             "lose a third of it or more")
        return sentences

    def _check_combinations(self) -> None:
        require_whole("ppc", self.ppc, 1, 6)
        if self.cells > MOST_CELLS:
            raise SceneError("cells", self.cells, f"give a whole number from {self.FEWEST_CELLS} to {MOST_CELLS:,}")
        if self.linearity_preserving:
            raise SceneError("linearity_preserving", True, self.NOT_LINEARITY_PRESERVING)
        if self.frozen and len(self.remedies) > 1:
            raise SceneError("remedies", " ".join(self.remedies), f"frozen-weights stands alone: {self.MENDS} what "
                             "comes of particles that move through the grid; leave one of the two out")
        self._check_remedies()
        if self.plan == "serial" and self.threads > 1:
            raise SceneError("threads", self.threads,
                             "the serial plan runs on one; give 1, or the plan parallel or auto")
        if self.for_gpu and self.plan != "auto":
            raise SceneError("plan", self.plan, "is for processors, and a GPU has a plan of its own; give auto, or "
                             "--arch cpu")

    def _check_remedies(self) -> None:
        """Refuse a remedy that does harm to the method; without one that does, there is nothing to refuse."""
