"""A whole sweep or search in the background: one process that does one job and says how it goes.

The page goes on while a visitor's job runs, so that runs in a process of its own, which gives way to others when told
to, and ends when it is done, when it is cancelled, or when whoever started it is gone. Its messages::

    {"row": a row}                                   of a sweep
    {"look": n, "coarse": m, "task": a task}         of a search: run n begins; the first m are on coarse grids
    {"advice": {...}}                                what the search found; its task has every effect
    {"trouble": a sentence}, {"done": true}          the last of all, together where the process was lost
"""

import contextlib
import os
import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from solvers.scene.effects import EFFECTS
from solvers.scene.scene import Scene
from solvers.solver.norms import finite
from solvers.study.grid import Task, task_of
from solvers.workers.processes import ProcessDied, WorkerProcess

NICENESS = 10  # more than that of the process that asks
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
    from solvers.study.advise import COARSE, Goal, advise, families
    from solvers.study.family import ESTIMATOR

    job = SearchJob(**fields)
    base = Task(**job.base).scene()
    choices = families(base, job.methods, job.ppc, job.courant_numbers, job.quantity)
    if not choices:
        tell({"trouble": NO_CHOICE})
        return
    coarse = len(choices) * len(COARSE[base.DIMENSIONS])

    def look(looks: int, scene: Scene) -> None:
        tell({"look": looks, "coarse": coarse, "task": task_of(scene).to_dict()})

    advice = advise(choices, Goal(job.quantity, job.tolerance, job.budget), look)
    chosen = advice.chosen
    scene = replace(chosen.scene, estimators=(ESTIMATOR,), effects=tuple(EFFECTS))  # the one that it was found by
    tell({"advice": {"met": advice.met, "task": task_of(scene).to_dict(), "measured": chosen.measured,
                     "error": finite(chosen.error), "seconds": chosen.seconds, "why": advice.why,
                     "looks": advice.looks}})


class BackgroundJob(WorkerProcess):
    """A job under way: a ``"sweep"`` of a list of tasks or a ``"search"`` with the fields of a :class:`SearchJob`.
    ``on_message`` hears every message, from a thread of its own; the last has ``done``. That comes in every case, after
    the process has ended: with ``trouble`` if the process was lost."""

    def __init__(self, kind: str, question: list | dict, on_message: Callable[[dict], None]):
        super().__init__(f"{__name__}:{kind}")
        self.start()
        threading.Thread(target=self._follow, args=(question, on_message), name=kind, daemon=True).start()

    cancel = WorkerProcess.kill  # from any thread, also when it has ended

    def give_way(self) -> None:
        """Have the process wait for whatever else wants a processor, from now on: there is no way back."""
        if process_id := self.process_id:
            with contextlib.suppress(AttributeError, OSError):  # not everywhere is there such a thing
                os.setpriority(os.PRIO_PROCESS, process_id, os.getpriority(os.PRIO_PROCESS, 0) + NICENESS)

    def _follow(self, question: list | dict, on_message: Callable[[dict], None]) -> None:
        last: dict = {"done": True}
        try:
            for message in self.ask(question):
                on_message(message)
        except ProcessDied as error:
            last["trouble"] = f"the background process {error}"
        finally:
            self.close()
            on_message(last)
