"""A whole sweep or search in one worker process (``solvers.workers``), with messages about its progress::

    {"row": a row}                                   a row of a sweep
    {"row": a row, "known": bool, "point": {...}}    a run of a search, ``known`` if it was recalled; the point, if
                                                     measured, can be passed to another search
    {"look": n, "certain": m, "task": a task}        run n of a search begins; at least m will be made or are known
    {"advice": {...}}                                the result of a search; its task has every effect
    {"trouble": a sentence}                          why there can be no result
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

from solvers.scene.effects import EFFECTS
from solvers.scene.scene import Scene
from solvers.solver.error_series import finite_or_none
from solvers.solver.soundness import OK
from solvers.study.advise import COARSE, SearchGoal, advise, refinement_families, usual_family_per_method
from solvers.study.parameter_grid import Task, task_of
from solvers.study.refinement_error_and_cost import ESTIMATOR, RefinementFamily, RefinementPoint, forget_rates
from solvers.study.row import measure, unmeasured_row
from solvers.translatable_message import Message

#: Default choices of a search: often the cheapest runs have one particle per cell, or steps near the longest stable.
PARTICLES_PER_CELL, COURANT_NUMBERS = (1, 2, 3, 4), (0.1, 0.3, 0.4, 0.5, 0.6)
READY = "ready"  # beside the fields of a job: only compile
NO_CHOICE = Message("no method makes a valid scene with these settings")


@dataclass(frozen=True)
class SearchJob:
    """Search for the cheapest run like ``base`` (a task as a dict) with an RMS error of ``quantity`` up to
    ``tolerance`` (SI unit) in ``budget`` s; other choices as in ``refinement_families``. ``known`` has points of other
    searches for the quantity, by the keys of their rows; one without a rate is timed again."""

    base: dict
    methods: Sequence[tuple[str, bool]]
    ppc: Sequence[int]
    courant_numbers: Sequence[float]
    quantity: str
    tolerance: float
    budget: float
    known: dict[str, dict] = field(default_factory=dict)


def sweep(tasks: Sequence[dict], tell: Callable[[dict], None]) -> None:
    """Measures tasks (as dicts) in order, in a worker process; passes each ``{"row": row}`` to ``tell``."""
    for task in tasks:
        tell({"row": measure(Task(**task))})


def search(fields: dict, tell: Callable[[dict], None]) -> None:
    """Runs the search with the fields of a :class:`SearchJob` in a worker process, and passes messages on rows, runs
    and the result to ``tell``; with the field ``ready`` only compiles for one like it, without messages."""
    ready = fields.pop(READY, False)
    job = SearchJob(**fields)
    base = Task(**job.base).scene()
    choices = refinement_families(base, job.methods, job.ppc, job.courant_numbers, job.quantity)
    if not choices:
        tell({"trouble": NO_CHOICE})
        return
    if ready:
        usual_family_per_method(choices)[0].compile(COARSE[base.DIMENSIONS])
        return
    forget_rates()  # of an earlier search by this process: its times were given away with its points
    recalled: set[str] = set()

    def recall(family: RefinementFamily, cells: int) -> RefinementPoint | None:
        key = task_with_all_effects(family.member(cells)).key
        if key not in job.known:
            return None
        recalled.add(key)
        found = job.known[key]
        rate = found.get("rate", math.nan)  # it is yet to be timed
        return RefinementPoint(cells, math.inf if found["error"] is None else found["error"],
                               math.inf if rate is None else rate, found["status"], found["reason"])

    def report_look(looks: int, certain: int, scene: Scene) -> None:
        tell({"look": looks, "certain": certain, "task": task_of(scene).to_dict()})

    def keep(family: RefinementFamily, point: RefinementPoint) -> None:
        row = point_row(family, point)
        known = row["key"] in recalled
        message: dict = {"row": row, "known": known}
        if not known or "rate" not in job.known[row["key"]]:  # None for what went bad
            message["point"] = {"error": finite_or_none(point.error),
                                "rate": finite_or_none(point.seconds_per_particle_step), "status": point.status,
                                "reason": point.reason}
        tell(message)

    advice = advise(choices, SearchGoal(job.quantity, job.tolerance, job.budget), report_look, keep, recall)
    chosen = advice.chosen
    tell({"advice": {"met": advice.met, "task": task_with_all_effects(chosen.scene).to_dict(),
                     "measured": chosen.is_measured, "error": finite_or_none(chosen.error), "seconds": chosen.seconds,
                     "why": advice.why, "looks": advice.looks}})


def point_row(family: RefinementFamily, point: RefinementPoint) -> dict:
    """Returns a row (dict of ``solvers.study.row``) with what a search knows of a run: the estimate of one quantity,
    and the seconds of a bare run from its steps, particles and separately measured rate. It has no true error, which a
    search does not use. Its task is :func:`task_with_all_effects`."""
    scene = family.member(point.cells)
    task, seconds = task_with_all_effects(scene), finite_or_none(family.seconds(point.cells))
    estimate = {ESTIMATOR: {family.quantity: {"max": point.error}}} if math.isfinite(point.error) else {}
    return {**unmeasured_row(task, scene), "status": point.status,
            "reason": None if point.status == OK else point.reason, "t": scene.end_time, "steps": scene.steps,
            "particles": scene.particles, "particle_steps": scene.steps * scene.particles, "error": {},
            "estimate": estimate, "effects": list(scene.effects),
            "seconds": {} if seconds is None else {"min": seconds}}


def task_with_all_effects(scene: Scene) -> Task:
    """Returns the task of a scene with the companion alone as estimator, as in a search, and every effect."""
    return task_of(replace(scene, estimators=(ESTIMATOR,), effects=tuple(EFFECTS)))
