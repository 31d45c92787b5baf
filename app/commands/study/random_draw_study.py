"""RandomDrawStudy: base of studies of random draws, which are not timed."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from app.commands.lenient_flag_types import NumberFlag, ProcessesFlag
from app.commands.study.study_command import StudyFlags
from solvers.scene.validation import require_whole
from solvers.study.coverage.random_draw import IDENTITY, RandomDraw
from solvers.study.parameter_grid import MOST_ROWS

if TYPE_CHECKING:
    from solvers.study.executors import MeasurementTask

MOST_SEED = 2**31 - 1


@dataclass(frozen=True, kw_only=True)
class RandomDrawStudy(StudyFlags):
    """Study of so many ``runs`` of random draws of the class ``DRAW`` with a ``seed``."""

    DRAW: ClassVar[type[Any]]  # a RandomDraw
    TIMED = False
    IDENTITY = IDENTITY

    runs: NumberFlag
    seed: NumberFlag
    workers: ProcessesFlag = None
    """Processes on this machine that run rows side by side; nothing is timed."""

    def measurement_tasks(self) -> Sequence["MeasurementTask"]:
        require_whole("runs", self.runs, 1, MOST_ROWS)
        require_whole("seed", self.seed, 0, MOST_SEED)
        self.check_study_flags(self.runs)
        return [self.DRAW(self.only_problem, self.seed, number) for number in range(self.runs)]

    def failed_task_row(self, task: RandomDraw, reason: str) -> dict:
        return task.failed_row(reason)

    def with_timing_conditions(self, row: dict) -> dict:
        return row
