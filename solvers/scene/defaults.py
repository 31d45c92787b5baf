"""What holds for the scene of most problems, and what a problem that knows better replaces."""

from collections.abc import Mapping
from typing import ClassVar

from solvers.scene.rules import SceneError, require_whole

MOST_PER_CELL = 64  # particles, along each direction


class SceneDefaults:
    """Rules and facts of a scene whose motion swings to and fro and whose cells hold whole numbers of particles."""

    #: Fields that only single runs and sweeps have, each with the reason why no other command has them.
    RUN_ONLY: ClassVar[Mapping[str, str]] = {}
    DIMENSIONS: ClassVar[int]
    ppc: float
    arch: str
    threads: int
    plan: str  # of a problem that has several

    @property
    def for_gpu(self) -> bool:
        """Whether it is to run on a GPU, if there is one: what it may be does not depend on that."""
        return self.arch != "cpu" and self.DIMENSIONS > 1

    @property
    def swings(self) -> bool:
        """Whether the exact motion goes to and fro; where it does not, exactly nothing should happen."""
        return True

    @property
    def lost_from(self) -> Mapping[str, float]:
        """Errors beside that of x from which on a run counts as lost, over ``size_of`` their quantities."""
        return {}

    def _check_per_cell(self) -> None:
        """Refuse what is no number of particles in a cell."""
        require_whole("ppc", self.ppc, 1, MOST_PER_CELL)

    def _check_plan(self) -> None:
        """Refuse a plan that does not go with the threads or with a GPU."""
        if self.plan == "serial" and self.threads > 1:
            raise SceneError("threads", self.threads,
                             "the serial plan runs on one; give 1, or the plan parallel or auto")
        if self.for_gpu and self.plan != "auto":
            raise SceneError("plan", self.plan, "is for processors, and a GPU has a plan of its own; give auto, or "
                             "--arch cpu")

    def _check_combinations(self) -> None:
        """Refuse what does not go together."""
