"""A whole sweep or search as the work of one process (``solvers.workers``), which says how it goes. Its messages::

    {"row": a row}                                   of a sweep; of a search what it knows of a run that it has made
    {"look": n, "coarse": m, "task": a task}         of a search: run n begins; the first m are on coarse grids
    {"advice": {...}}                                what the search found; its task has every effect
    {"trouble": a sentence}                          why nothing can be found
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from solvers.scene.scene import Scene
from solvers.solver.norms import finite
from solvers.study.grid import Task, task_of

#: What a search chooses from unless it is told: the cheapest runs are often those of one particle per cell, or of steps
#: near the longest that are stable.
PARTICLES_PER_CELL, COURANT_NUMBERS = (1, 2, 3, 4), (0.1, 0.3, 0.4, 0.5, 0.6)
NO_CHOICE = "no method makes a valid scene with these settings"


@dataclass(frozen=True)
class SearchJob:
    """Find the cheapest run like ``base`` (a task) that meets a tolerance, in the unit of ``quantity``."""

    base: dict
    methods: Sequence[tuple[str, bool]]
    ppc: Sequence[int]
    courant_numbers: Sequence[float]
    quantity: str
    tolerance: float
    budget: float


def sweep(tasks: Sequence[dict], tell: Callable[[dict], None]) -> None:
    """What the process of a sweep does: measure tasks in their order."""
    from solvers.study.row import measure

    for task in tasks:
        tell({"row": measure(Task(**task))})


def search(fields: dict, tell: Callable[[dict], None]) -> None:
    """What the process of a search does: the job of these fields."""
    from solvers.study.advise import Goal, advise, families
    from solvers.study.found import point_row, to_watch

    job = SearchJob(**fields)
    base = Task(**job.base).scene()
    choices = families(base, job.methods, job.ppc, job.courant_numbers, job.quantity)
    if not choices:
        tell({"trouble": NO_CHOICE})
        return
    coarse = len(choices)

    def look(looks: int, scene: Scene) -> None:
        tell({"look": looks, "coarse": coarse, "task": task_of(scene).to_dict()})

    advice = advise(choices, Goal(job.quantity, job.tolerance, job.budget), look,
                    lambda family, point: tell({"row": point_row(family, point)}))
    chosen = advice.chosen
    tell({"advice": {"met": advice.met, "task": to_watch(chosen.scene).to_dict(), "measured": chosen.measured,
                     "error": finite(chosen.error), "seconds": chosen.seconds, "why": advice.why,
                     "looks": advice.looks}})
