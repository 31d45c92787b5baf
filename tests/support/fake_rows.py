"""Rows made up for tests of what reads them."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import replace

from solvers.problems.bar.scene import BarScene
from solvers.scene.effects import EFFECTS
from solvers.solver.samples import QUANTITIES
from solvers.study.parameter_grid import Task
from solvers.study.row import refused_row, solver_source_hash


def fake_row(method: str = "ugimp", cells: int = 20, cfl: float = 0.05, order: float = 2.0, status: str = "ok",
             estimate: float | None = 1.1, **changed) -> dict:
    """A row whose errors are cells^-order, estimated by ``estimate`` times as much."""
    inputs = {"method": method, "cells": cells, "cfl": cfl}
    scene = replace(BarScene(**inputs), effects=tuple(EFFECTS))
    norms = {q: dict.fromkeys(("final", "max", "mean"), float(cells) ** -order) for q in QUANTITIES}
    guess = {q: dict.fromkeys(("final", "max", "mean"), (estimate or 0) * cells**-order) for q in QUANTITIES}
    each = {} if estimate is None else {"transport": guess}
    seconds = 1e-5 * cells**2 / cfl
    row = {"schema": "mpm-lab/row/1", "key": Task("bar", inputs).key, "problem": "bar", "asked": inputs,
           "scene": scene.to_dict(), "h": 1 / cells, "status": status, "reason": None if status == "ok" else "too long",
           "t": 5.0, "steps": 100, "particles": 4 * cells, "particle_steps": 400 * cells, "error": norms,
           "estimate": each, "index": {name: dict.fromkeys(QUANTITIES, 1.1) for name in each}, "distance": {},
           "corrected": {}, "not_valid": {}, "grid_crossings": 0, "energy": None, "effects": [], "bytes": 1,
           "seconds": {"repeats": [seconds], "min": seconds, "full": 1.5 * seconds, "compile": 0.1, "setup": 0.0,
                       "estimators": {name: 0.2 * seconds for name in each}, "effects": {}},
           "rate": 50.0, "arch": "x64", "threads": 1, "plan": "serial", "host": "here", "version": "1",
           "life": {"accurate": None, "sound": None, "first_period": None}, "solvers": solver_source_hash()}
    return {**row, **changed}


def without_timings(row: dict) -> dict:
    """What two measurements of the same scene have in common."""
    return {name: value for name, value in row.items() if name not in ("seconds", "rate", "host")}


class InstantExecutor:
    """A place that needs no time, instead of ``solvers.study.executors.LocalExecutor``: it has each row from
    ``answer``; ``asked`` are the tasks that came."""

    def __init__(self, answer: Callable[[Task], dict] | None = None):
        self._answer, self.asked = answer or fake_answer, []

    def __call__(self, workers: int, work: str) -> InstantExecutor:
        return self

    def submit(self, task: Task) -> Future:
        self.asked.append(task)
        future: Future = Future()
        future.set_result(self._answer(task))
        return future

    def check(self) -> None: ...

    def close(self) -> None: ...


def fake_answer(task: Task) -> dict:
    """What a task might have given."""
    if refusal := task.refusal():
        return refused_row(task, refusal)
    return {**fake_row(task.inputs.get("method", "ugimp"), task.inputs["cells"]), "key": task.key, "asked": task.inputs}
