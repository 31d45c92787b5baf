"""Text of a scene in a file, one line of JSON, and its validated parser.

Imports only the scenes: files of particles and results store the scene of their run with it."""

import json
import math
from dataclasses import fields
from typing import Any

from solvers.problems import PROBLEMS
from solvers.scene.scene import Scene
from solvers.scene.validation import SceneError, field_key, key_field
from solvers.translatable_message import Message
from solvers.untrusted.quoting import FileError, quote

SCHEMA, FAMILY = "mpm-lab/particles/1", "mpm-lab/particles/"
MAX_LINE = 4000  # characters of a line
MAX_WORD = 40  # characters of a text in it
HINT = Message("take the line called scene out of it, or write it anew")


def scene_line(scene: Scene) -> str:
    """Returns the scene as one line of JSON without spaces, which also fits into a comment of a .csv."""
    said = {"schema": SCHEMA, "problem": scene.problem, "inputs": scene_inputs(scene)}
    return json.dumps(said, separators=(",", ":"))


def scene_inputs(scene: Scene) -> dict[str, Any]:
    """Returns the inputs of a scene, values that JSON can represent, by the names of flags, without None."""
    given = {field.name: getattr(scene, field.name) for field in fields(scene) if field.name != "problem"}
    return {field_key(name): to_json_value(value) for name, value in given.items() if value is not None}


def to_json_value(value: object) -> object:
    """Returns a value that JSON can represent: a list for a tuple, text for an infinite number or NaN."""
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    return list(value) if isinstance(value, tuple) else value


def parse_scene_json_line(file: str, text: str) -> tuple[str, dict[str, Any]]:
    """Returns the problem's name and the unvalidated inputs, by flag, from the line ``text`` (:func:`scene_line`) of a
    file, whose name is for messages. Raises :class:`FileError` if it is malformed."""
    try:
        values = json.loads(text[:MAX_LINE + 1])
        schema, problem, given = values["schema"], values["problem"], dict(values["inputs"])
    except (ValueError, TypeError, KeyError, RecursionError):
        raise FileError(file, "has a scene that cannot be read; {hint}", HINT) from None
    if schema != SCHEMA:
        raise FileError(file, "has a scene of another format version ({schema}), and {needed} is needed; {hint}",
                        quote(schema, MAX_WORD), SCHEMA, HINT)
    if not isinstance(problem, str) or problem not in PROBLEMS:
        raise FileError(file, "names an unknown problem; {hint}", HINT)
    return problem, given


def scene_from_inputs(file: str, problem: str, given: dict[str, Any]) -> Scene:
    """Returns a problem's scene with inputs ``given`` by flag or field. Raises :class:`FileError`, which names the
    ``file``, for invalid ones."""
    try:
        values: dict[str, Any] = {key_field(key): tuple(value) if isinstance(value, list) else value
                                  for key, value in given.items()}
        if not all(map(_is_plain, values.values())):
            raise TypeError
        return PROBLEMS[problem].scene(**values)
    except SceneError as error:
        raise FileError(file, "has an invalid scene: {error}; {hint}", error, HINT) from None
    except (TypeError, ValueError, OverflowError):
        raise FileError(file, "has a scene with inputs that the {problem} does not accept; {hint}", Message(problem),
                        HINT) from None


def _is_plain(value: object) -> bool:
    if isinstance(value, tuple):
        return len(value) <= MAX_WORD and all(isinstance(word, str) and _is_plain(word) for word in value)
    return isinstance(value, (int, float)) or (isinstance(value, str) and len(value) <= MAX_WORD)
