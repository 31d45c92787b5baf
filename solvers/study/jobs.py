"""A whole sweep or search in the background: one process of low priority that does one job and says how it goes.

The page keeps moving while a visitor's job runs, so that runs in a process that gives way to every other, ends when it
is done, when it is cancelled, or when whoever started it is gone. Its messages::

    {"row": a row}                                   of a sweep
    {"look": n, "coarse": m, "task": a task}         of a search: run n begins; the first m are on coarse grids
    {"advice": {...}}                                what the search found (see :func:`_advice`)
    {"trouble": a sentence}, {"done": true}          the last of all, together where the process was lost
"""

from __future__ import annotations

import contextlib
import math
import os
import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from solvers.effects import EFFECTS
from solvers.processes import ProcessDied, WorkerProcess
from solvers.scene import Scene
from solvers.study.grid import Task, task_of

if TYPE_CHECKING:
    from solvers.study.advise import Advice

NICENESS = 10
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

    _give_way()
    for task in tasks:
        tell({"row": measure(Task(**task))})


def search(fields: dict, tell: Callable[[dict], None]) -> None:
    """What the process of a search does: the job of these fields."""
    from solvers.study.advise import COARSE, Goal, advise, families

    _give_way()
    job = SearchJob(**fields)
    base = Task(**job.base).scene()
    choices = families(base, job.methods, job.ppc, job.courant_numbers, job.quantity)
    if not choices:
        tell({"trouble": NO_CHOICE})
        return
    coarse = len(choices) * len(COARSE[base.DIMENSIONS])

    def look(looks: int, scene: Scene) -> None:
        tell({"look": looks, "coarse": coarse, "task": task_of(scene).to_dict()})

    tell({"advice": _advice(advise(choices, Goal(job.quantity, job.tolerance, job.budget), look))})


def _give_way() -> None:
    with contextlib.suppress(AttributeError, OSError):  # not everywhere is there such a thing
        os.nice(NICENESS)


def _advice(advice: Advice) -> dict:
    """What a visitor wants to know of it, in plain values; the error is None where it is not finite.

    The scene has every effect, and the estimator that it was found by.
    """
    from solvers.study.family import ESTIMATOR

    chosen = advice.chosen
    scene = replace(chosen.scene, estimators=(ESTIMATOR,), effects=tuple(EFFECTS))
    return {"met": advice.met, "task": task_of(scene).to_dict(), "measured": chosen.measured,
            "error": chosen.error if math.isfinite(chosen.error) else None,
            "seconds": chosen.seconds, "why": advice.why, "looks": advice.looks}


class BackgroundJob:
    """A job under way: a ``"sweep"`` of a list of tasks or a ``"search"`` with the fields of a :class:`SearchJob`.

    ``on_message`` hears every message, from a thread of its own; the last has ``done``. That comes in every case, after
    the process has ended: with ``trouble`` if the process was lost.
    """

    def __init__(self, kind: str, question: list | dict, on_message: Callable[[dict], None]):
        self._on_message = on_message
        self._process = WorkerProcess(f"{__name__}:{kind}")
        self._process.start()
        threading.Thread(target=self._follow, args=(question,), name=kind, daemon=True).start()

    @property
    def process_id(self) -> int | None:
        """Of the process, while it runs."""
        return self._process.process_id

    def cancel(self) -> None:
        """End the process at once, whatever it does. From any thread, also when it has ended."""
        self._process.kill()

    def _follow(self, question: list | dict) -> None:
        last: dict = {"done": True}
        try:
            for message in self._process.ask(question):
                self._on_message(message)
        except ProcessDied as error:
            last["trouble"] = f"the background process {error}"
        finally:
            self._process.close()
            self._on_message(last)
