"""From lists of values to tasks: every combination, the scene it means, and the key that it is known by."""

import hashlib
import itertools
import json
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from solvers.problems import PROBLEMS
from solvers.running import scene_text
from solvers.scene.kernel_options import kernel_key
from solvers.scene.scene import Scene
from solvers.scene.validation import SceneError, key_field

MOST_ROWS = 10_000


@dataclass(frozen=True)
class Task:
    """One combination to be measured, in plain values, so that it can travel anywhere as JSON.

    ``inputs`` maps the names of flags (``ppc``, ``body_force``, ...) to values; what is absent or None takes the
    scene's default. ``repeats`` is how often the bare run is timed, 0 for not at all; ``price_effects`` asks for
    the time with each effect alone as well.
    """

    problem: str
    inputs: dict[str, Any]
    repeats: int = 3
    price_effects: bool = False
    version: str = ""

    def scene(self) -> Scene:
        """The scene of this combination; :class:`SceneError` where there is none."""
        inputs: dict[str, Any] = {key_field(key): tuple(value) if isinstance(value, list) else value
                                  for key, value in self.inputs.items()}
        return PROBLEMS[self.problem].scene(**inputs)

    def refusal(self) -> SceneError | None:
        """Why there is no such scene, or None."""
        try:
            self.scene()
        except SceneError as error:
            return error
        return None

    def remarks(self) -> list[str]:
        """What whoever asks is to know before it is measured, in sentences."""
        try:
            return [f"warning: {sentence}" for sentence in self.scene().warnings()]
        except SceneError as error:
            return [f"refused: {error}"]

    @property
    def key(self) -> str:
        """A hash of the inputs with the defaults filled in, not of how a run is timed: equal scenes have equal keys."""
        try:
            values = self.scene().to_dict()
        except SceneError:
            values = {"problem": self.problem, **self.inputs}
        values = {name: float(value) if type(value) is int else value for name, value in values.items()}  # 1 is 1.0
        return hashlib.sha256(json.dumps(values, sort_keys=True).encode()).hexdigest()[:16]

    @property
    def kind(self) -> Hashable:
        """What has to be compiled for it, None where there is no such scene."""
        try:
            return kernel_key(self.scene())
        except SceneError:
            return None

    def to_dict(self) -> dict:
        return asdict(self)


def task_of(scene: Scene, **options) -> Task:
    """The task that asks for a scene; ``options`` as of :func:`plan_tasks`."""
    return Task(scene.problem, scene_text.scene_inputs(scene), **options)


def combinations(axes: Mapping[str, Sequence]) -> list[dict]:
    """Every combination of one value from each axis, the last varying fastest."""
    return [dict(zip(axes, values, strict=True)) for values in itertools.product(*axes.values())]


def plan_tasks(problem: str, axes: Mapping[str, Sequence], **options) -> list[Task]:
    """A task for every combination, each scene once.

    Parameters
    ----------
    problem : "bar", "ring", "vortex" or "square"
    axes
        The values of each input by the name of its flag; those of the last vary fastest.
    options
        The other fields of :class:`Task`.

    Raises
    ------
    SceneError
        Where no combination makes a scene.
    """
    tasks: dict[str, Task] = {}
    for given in combinations(axes):
        task = Task(problem, {name: scene_text.to_json_value(value) for name, value in given.items()}, **options)
        tasks.setdefault(task.key, task)
    refusals = [task.refusal() for task in tasks.values()]
    if refusals and refusals[0] and all(refusals):
        raise refusals[0]
    return list(tasks.values())
