"""What a process of its own does for the fold *Who made this error?*. Its messages::

    {"part": .3}                        how far it is
    {"series": {...}, "again": {...}}   of a budget: the samples of the run, and of that without the cause, or None
    {"picture": base64}                 of a map: a PNG
    {"trouble": a sentence}             why there is none
    {"bad": a sentence}                 or that a run goes bad, and why; without words where that is before the end
"""

import base64
from collections.abc import Callable
from typing import Any

import numpy as np

from solvers.problems import PROBLEMS
from solvers.running.result import Result
from solvers.scene.rules import SceneError
from solvers.solver.norms import finite
from solvers.study.grid import Task

OFTEN = 0.02  # of the work: how often it is said how far it is

Tell = Callable[[dict[str, Any]], object]


def budget(question: dict[str, Any], tell: Tell) -> None:
    """The budget of a task's scene, and what is left of it without a cause."""
    from solvers.running.budget import run_budget

    try:
        found = run_budget(Task(**question["task"]).scene(), question["cause"], _progress(tell))
    except SceneError as error:
        tell({"trouble": str(error)})
        return
    bad = [result.reason for result in (found.result, found.again)
           if result is not None and result.status != "ok"]
    tell({"series": _columns(found.result), "again": found.again and _columns(found.again),
          **({"bad": bad[0]} if bad else {})})


def where_and_when(question: dict[str, Any], tell: Tell) -> None:
    """The map of the error at the end of a task's scene, as a picture."""
    from app.pictures.budget_map import budget_map_figure
    from app.pictures.run import png_bytes

    scene = Task(**question["task"]).scene()
    try:
        found = PROBLEMS[scene.problem].error_map(scene, question["field"], question["particle"], _progress(tell))
    except SceneError as error:
        tell({"trouble": str(error)})
        return
    if found is None:
        tell({"bad": ""})
    elif refusal := found.not_valid():
        tell({"trouble": refusal})
    else:
        tell({"picture": base64.b64encode(png_bytes(budget_map_figure(found))).decode()})


def _progress(tell: Tell) -> Callable[[float], None]:
    said = 0.0

    def show(part: float) -> None:
        nonlocal said
        if part >= said + OFTEN:
            said = part
            tell({"part": part})

    return show


def _columns(result: Result) -> dict[str, list[float | None]]:
    return {name: [finite(value) for value in np.asarray(values).tolist()] for name, values in result.series.items()
            if name == "time" or name.startswith("budget/")}
