"""Tasks from lists of values: every combination, its scene, and its key."""

import hashlib
import itertools
import json
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from solvers.problems import PROBLEMS
from solvers.running import scene_json_line
from solvers.scene.kernel_options import kernel_key
from solvers.scene.scene import Scene
from solvers.scene.validation import SceneError, key_field

MOST_ROWS = 10_000


@dataclass(frozen=True)
class Task:
    """Combination of inputs to be measured, in plain values, so that it can be sent as JSON.

    ``inputs`` maps flags (``ppc``, ``body_force``, ...) to values; absent or None is the scene's default. ``repeats``
    is how often the bare run is timed, 0 for not at all; ``price_effects`` whether with each effect alone, too.
    """

    problem: str
    inputs: dict[str, Any]
    repeats: int = 3
    price_effects: bool = False
    version: str = ""

    def scene(self) -> Scene:
        """Returns the scene of this combination. Raises :class:`SceneError` where it is invalid."""
        inputs: dict[str, Any] = {key_field(key): tuple(value) if isinstance(value, list) else value
                                  for key, value in self.inputs.items()}
        return PROBLEMS[self.problem].scene(**inputs)

    def refusal(self) -> SceneError | None:
        """Returns the error for a combination that makes no valid scene, or None."""
        try:
            self.scene()
        except SceneError as error:
            return error
        return None

    def remarks(self) -> list[str]:
        """Returns warnings about the scene, or why it is refused, as sentences for the user."""
        try:
            return [f"warning: {sentence}" for sentence in self.scene().warnings()]
        except SceneError as error:
            return [f"refused: {error}"]

    @property
    def key(self) -> str:
        """Hash of the inputs with defaults filled in, not of options of timing: equal scenes have equal keys."""
        try:
            values = self.scene().to_dict()
        except SceneError:
            values = {"problem": self.problem, **self.inputs}
        values = {name: float(value) if type(value) is int else value for name, value in values.items()}  # 1 is 1.0
        return hashlib.sha256(json.dumps(values, sort_keys=True).encode()).hexdigest()[:16]

    @property
    def kind(self) -> Hashable:
        """Key of the kernels that the scene needs, None for an invalid combination."""
        try:
            return kernel_key(self.scene())
        except SceneError:
            return None

    def to_dict(self) -> dict:
        return asdict(self)


def task_of(scene: Scene, **options) -> Task:
    """Returns the task that measures a scene; ``options`` are other fields of :class:`Task`."""
    return Task(scene.problem, scene_json_line.scene_inputs(scene), **options)


def combinations(axes: Mapping[str, Sequence]) -> list[dict]:
    """Returns a dict for every combination of one value from each axis, the last varying fastest."""
    return [dict(zip(axes, values, strict=True)) for values in itertools.product(*axes.values())]


def plan_tasks(problem: str, axes: Mapping[str, Sequence], **options) -> list[Task]:
    """Returns a task for every combination, each scene once. ``axes`` has each input's values by its flag; those of the
    last vary fastest. ``options`` are other fields of :class:`Task`. Raises :class:`SceneError` where none is valid."""
    tasks: dict[str, Task] = {}
    for given in combinations(axes):
        task = Task(problem, {name: scene_json_line.to_json_value(value) for name, value in given.items()}, **options)
        tasks.setdefault(task.key, task)
    refusals = [task.refusal() for task in tasks.values()]
    if refusals and refusals[0] and all(refusals):
        raise refusals[0]
    return list(tasks.values())
