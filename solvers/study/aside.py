"""A whole study beside something else: one process of low priority that does one job and says how it goes.

The page keeps moving while a visitor's sweep or search runs, so that runs in a process that gives way to every other,
ends when it is done, when it is cancelled, or when whoever started it is gone. Messages are a line of JSON each::

    {"row": a row}                                   of a sweep
    {"look": n, "coarse": m, "task": a task}         of a search: run n begins; the first m are on coarse grids
    {"advice": {...}}                                what the search found (see :func:`_advice`)
    {"trouble": a sentence}, {"done": true}          the last of all
"""

from __future__ import annotations

import contextlib
import json
import math
import os
import threading
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from typing import TYPE_CHECKING

from solvers.effects import EFFECTS
from solvers.scene import Scene
from solvers.study.apart import end_process, how_it_ended, pipes, start_process
from solvers.study.grid import Task, task_of

if TYPE_CHECKING:
    from solvers.study.advise import Advice

NICENESS = 10
NO_CHOICE = "no method makes a valid scene with these settings"


@dataclass(frozen=True)
class SweepJob:
    """Measure these tasks, in this order."""

    tasks: Sequence[dict]

    def work(self, tell: Callable[..., None]) -> None:
        from solvers.study.row import measure

        for task in self.tasks:
            tell(row=measure(Task(**task)))


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

    def work(self, tell: Callable[..., None]) -> None:
        from solvers.study.advise import COARSE, Goal, advise, families

        base = Task(**self.base).scene()
        choices = families(base, self.methods, self.ppc, self.courant_numbers, self.quantity)
        if not choices:
            tell(trouble=NO_CHOICE)
            return
        coarse = len(choices) * len(COARSE[base.DIMENSIONS])

        def look(looks: int, scene: Scene) -> None:
            tell(look=looks, coarse=coarse, task=task_of(scene).to_dict())

        tell(advice=_advice(advise(choices, Goal(self.quantity, self.tolerance, self.budget), look)))


JOBS = {job.__name__: job for job in (SweepJob, SearchJob)}


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


class Aside:
    """A job under way. ``on_message`` hears every message, from a thread of its own; the last has ``done``.

    That comes in every case, after the process has ended: with ``trouble`` if the process was lost.
    """

    def __init__(self, job: SweepJob | SearchJob, on_message: Callable[[dict], None]):
        self._on_message = on_message
        self._process = start_process(__name__)
        threading.Thread(target=self._follow, args=(job,), name="aside", daemon=True).start()

    @property
    def process_id(self) -> int:
        return self._process.pid

    def cancel(self) -> None:
        """End the process at once, whatever it does. From any thread, also when it has ended."""
        self._process.kill()

    def _follow(self, job: SweepJob | SearchJob) -> None:
        last: dict = {}
        try:
            with contextlib.suppress(OSError):  # it was cancelled before it could read
                self._process.stdin.write(json.dumps({"kind": type(job).__name__, **asdict(job)}) + "\n")
                self._process.stdin.flush()
            for line in self._process.stdout:
                if not line.endswith("\n"):
                    break  # the process was killed in the middle of it
                last = json.loads(line)
                if "done" not in last:
                    self._on_message(last)
        finally:
            status = end_process(self._process)
            lost = {} if "done" in last else {"trouble": f"the background process {how_it_ended(status)}"}
            self._on_message({"done": True, **lost})


def main() -> None:
    """The process: one job, told by standard input."""
    with contextlib.suppress(AttributeError, OSError):  # not everywhere is there such a thing
        os.nice(NICENESS)
    lines, answers = pipes()
    job = json.loads(lines.get())

    def tell(**message: object) -> None:
        answers.write(json.dumps(message, allow_nan=False) + "\n")
        answers.flush()

    try:
        JOBS[job.pop("kind")](**job).work(tell)
    except Exception as error:
        tell(trouble=f"{type(error).__name__}: {error}")
    tell(done=True)
    os._exit(0)  # at once: nothing here is worth tidying up
