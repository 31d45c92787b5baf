"""A body with several values of its fields: a row for each combination, as in sweeps of problems.

Keys of a row::

    schema, key, problem ("body"), asked (the values given), scene (all numbers of the body; null if refused), h,
    solvers, status ("ok", "unstable", "failed", "refused"), reason, and those of ``BodyResult.to_dict`` but "body"

Nobody knows the errors: ``estimate`` has the estimated ones, with delta, and ``goals`` have bars.
"""

import hashlib
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, fields, replace
from typing import Any

from solvers.bodies.body import Body
from solvers.bodies.body_file import body_from_dict
from solvers.scene.validation import SceneError
from solvers.study.json_schema import NUMBER, NUMBER_OR_NONE, MapOf
from solvers.study.parameter_grid import combinations
from solvers.study.row import BLANK, FAILED, REFUSED, solver_source_hash

PROBLEM, SCHEMA = "body", "mpm-lab/body-row/1"
IDENTITY = {"key": str, "problem": str, "asked": dict, "status": str, "reason": (str, type(None)),
            "scene": (dict, type(None))}
MEASURED = {"scene": dict, "h": NUMBER, "steps": int, "particles": int, "estimated_until": NUMBER,
            "estimate": MapOf({"final": NUMBER_OR_NONE, "max": NUMBER_OR_NONE, "mean": NUMBER_OR_NONE, "delta": NUMBER,
                               "trust": str, "unit": str}),
            "goals": MapOf({"value": NUMBER_OR_NONE, "bar": NUMBER_OR_NONE, "unit": str}), "seconds": MapOf(NUMBER)}
WHOLE = ("patches", "goals")  # fields that no sweep varies
MEASURE_BODY = f"{__name__}:measure_in_worker"
VARIED = tuple(one.name for one in fields(Body) if one.name not in WHOLE)


@dataclass(frozen=True)
class BodyTask:
    """Run of a body, given by its fields as in JSON, with ``inputs`` in place of its own."""

    fields: dict[str, Any]
    inputs: dict[str, Any]

    def body(self) -> Body:
        """Returns the body; raises SceneError where it is invalid."""
        return replace(body_from_dict(self.fields), **self.inputs)

    def refusal(self) -> SceneError | None:
        """Returns the error for an invalid combination, or None."""
        try:
            self.body()
        except SceneError as error:
            return error
        return None

    def remarks(self) -> list[str]:
        """Returns warnings about the body, or why it is refused, as sentences for the user."""
        if refusal := self.refusal():
            return [f"refused: {refusal}"]
        return [f"warning: {sentence}" for sentence in self.body().warnings()]

    @property
    def key(self) -> str:
        """Hash of the body's fields: equal bodies have equal keys."""
        values = {name: float(value) if type(value) is int else value  # 1 is 1.0
                  for name, value in {**self.fields, **self.inputs}.items()}
        return hashlib.sha256(json.dumps(values, sort_keys=True).encode()).hexdigest()[:16]

    @property
    def kind(self) -> str:
        """The method: runs of one share their compiled code."""
        return str(self.inputs.get("method", self.fields["method"]))

    def to_dict(self) -> dict:
        return {"fields": self.fields, "inputs": self.inputs}

    def failed_row(self, reason: str, status: str = FAILED) -> dict:
        """Returns the row of a run that has no result, with the ``reason`` as one line."""
        known = None if status == REFUSED else {**self.fields, **self.inputs}
        return {**BLANK, "schema": SCHEMA, "key": self.key, "problem": PROBLEM, "asked": self.inputs,
                "scene": known and {name: known[name] for name in VARIED}, "solvers": solver_source_hash(),
                "status": status, "reason": " ".join(reason.split())}


def plan_body_tasks(body: Body, axes: Mapping[str, Sequence]) -> list[BodyTask]:
    """Returns a task for every combination of values, each body once; ``axes`` has the values by field, those of the
    last vary fastest. Raises SceneError for what is no field, and where no combination is valid."""
    for name, values in axes.items():
        if name not in VARIED:
            raise SceneError(name, values, f"is nothing that varies in a body; give some of {', '.join(VARIED)}")
    tasks: dict[str, BodyTask] = {}
    for given in combinations(axes):
        task = BodyTask(json.loads(json.dumps(asdict(body))), given)
        tasks.setdefault(task.key, task)
    refusals = [task.refusal() for task in tasks.values()]
    if refusals[0] and all(refusals):
        raise refusals[0]
    return list(tasks.values())


def measure(task: BodyTask) -> dict:
    """Returns the row of a task; an error becomes a row, never raised."""
    if refusal := task.refusal():
        return task.failed_row(str(refusal), REFUSED)
    try:
        from solvers.bodies.run import run_body  # here: a row can be read, kept and drawn without Taichi
        result = run_body(task.body())
    except SceneError as error:  # a force that changes too fast
        return task.failed_row(str(error), REFUSED)
    except Exception as error:
        return task.failed_row(f"{type(error).__name__}: {error}")
    found = {name: value for name, value in result.to_dict().items() if name not in ("schema", "body")}
    return {**task.failed_row(""), **found, "h": result.body.spacing,
            "particle_steps": result.steps * result.particles}


def measure_in_worker(question: dict, answer: Callable[[dict], None]) -> None:
    """Calls ``answer`` with the row of a task, given as a dict, in a worker process."""
    answer(measure(BodyTask(**question)))
