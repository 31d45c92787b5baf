"""Scene in the metadata of a file of particles: one line of JSON, in our own files and in any other.

It is untrusted: anything but a valid scene is rejected, and so is a scene that the particles do not fit
(``solvers.judging.particle_scene_matching``).
"""

from dataclasses import fields, replace
from typing import Any

from solvers.judging.particle_data_types import ProblemMismatch, RawTable, SceneMetadata
from solvers.problems import PROBLEMS
from solvers.problems.judging_reference import METHOD_FIELDS
from solvers.running.scene_json_line import FAMILY, HINT, parse_scene_json_line, scene_from_inputs
from solvers.scene.scene import Scene
from solvers.scene.validation import SceneError, field_flag, field_label, key_field
from solvers.translatable_message import Message, join_messages
from solvers.untrusted.quoting import FileError, quote

NOT_OF_THE_PROBLEM = METHOD_FIELDS | {"t_end", "periods"}  # what does not matter to a judge


def parse_scene_line(file: str, text: object, cells: int | None) -> SceneMetadata | None:
    """Returns the scene in a file's line of JSON; None for other lines. ``cells`` is the number of cells elsewhere in
    the file. Raises :class:`FileError` where that differs, or the scene is invalid."""
    if not isinstance(text, str) or FAMILY not in text[:100]:
        return None
    problem, inputs = parse_scene_json_line(file, text)
    given = {key_field(key): value for key, value in inputs.items()}
    try:
        step = PROBLEMS[problem].scene(**given).time_step
    except (SceneError, TypeError, ValueError, OverflowError):
        step = None
    relevant = {name: value for name, value in given.items() if name not in NOT_OF_THE_PROBLEM}
    metadata = SceneMetadata(problem, relevant, step)
    own = scene_of_metadata(file, metadata)
    if "cells" in relevant and cells is not None and cells != own.cells:
        raise FileError(file, "states {cells} cells, but {own_cells} in its scene; {hint}", cells, own.cells, HINT)
    return metadata


def scene_of_metadata(file: str, metadata: SceneMetadata) -> Scene:
    """Returns the scene with the inputs in a file's metadata. Raises :class:`FileError` where it is invalid."""
    return scene_from_inputs(file, metadata.problem, dict(metadata.inputs))


def resolve_scene(files: list[RawTable], asked: Scene) -> tuple[Scene, list[str]]:
    """Returns the scene to judge files with, and notes (sentences) about it: metadata of the files replace inputs that
    have their defaults in ``asked``, except the number of cells, which may differ between files.

    Raises :class:`ProblemMismatch` for files of another problem, :class:`FileError` where a file contradicts an input
    that was given, or another file.
    """
    notes: list[str] = []
    by: dict[str, str] = {}  # the first file with each field
    default, settled_scene = type(asked)(), asked
    for raw in files:
        if raw.metadata is None:
            continue
        if raw.metadata.problem != asked.problem:
            raise ProblemMismatch(raw.file, Message("is a file of the {problem}", Message(raw.metadata.problem)), HINT,
                                  (raw.metadata.problem,))
        own, taken = scene_of_metadata(raw.file, raw.metadata), dict[str, Any]()
        names = sorted((f.name for f in fields(own) if f.name not in NOT_OF_THE_PROBLEM),
                       key=lambda name: name != "motion")  # first, because a patch test changes others with it
        for name in names:
            value, now = getattr(own, name), getattr(settled_scene, name)
            if name == "cells" or value == now:
                continue
            if name in by or now != getattr(default, name):
                says = Message("{by} has", by[name]) if name in by else Message("--{flag} is", field_flag(name))
                raise FileError(raw.file, "has {name} {value}, but {says} {now}; give the value of the run, or leave "
                                "it out", field_label(name), _plain_value(value), says, _plain_value(now))
            taken[name] = value
        by |= dict.fromkeys(names, raw.file)
        if taken:
            try:
                settled_scene = replace(settled_scene, **taken)
            except SceneError as error:
                raise FileError(raw.file, "has a scene that contradicts the other settings: {error}; {hint}", error,
                                HINT) from None
            told = join_messages(", ", (Message("{name} {value}", field_label(name), _plain_value(value))
                                        for name, value in taken.items()))
            notes.append(Message("judged with the scene of {file}: {told}", quote(raw.file), told))
    return settled_scene, notes


def _plain_value(value: object) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)
