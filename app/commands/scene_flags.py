"""Flags of a scene, generated from the scene's own fields with their help, units, defaults and choices."""

from dataclasses import Field, dataclass, field, fields, make_dataclass
from typing import Annotated, Any, ClassVar

import tyro

from app.commands.lenient_flag_types import BadInput, NumberFlag, RealFlag, TextFlag, one_of, several_of
from solvers.scene.scene import Scene
from solvers.scene.validation import field_key, key_field

#: Words for no names, or all.
SPECIAL = {"estimators": ("none",), "effects": ("all", "none"), "remedies": ("none",)}


@dataclass(frozen=True, kw_only=True)
class SceneFlags:
    """Flags of a problem's scene: fields that the class ``SCENE`` has too are its inputs, which it validates."""

    SCENE: ClassVar[type[Scene]]
    LEFT_OUT: ClassVar[frozenset[str]] = frozenset()  # fields of a scene without a flag

    def scene(self, **instead: Any) -> Scene:
        """Returns the scene from the flags, of which ``instead`` replaces some by name; raises SceneError."""
        return self.SCENE(**{key_field(key): value for key, value in {**self.inputs(), **instead}.items()})

    def inputs(self) -> dict[str, Any]:
        """Returns the values of the scene's inputs, by the names of their flags with underscores."""
        values = {key: getattr(self, key) for f in fields(self.SCENE) if hasattr(self, key := field_key(f.name))}
        for name, words in SPECIAL.items():
            if (key := field_key(name)) in values:
                meanings = {"none": (), "all": self.SCENE.choices(name)}
                values[key] = _expand_special_words(key, values[key], {word: meanings[word] for word in words})
        return values


def command_of_problem(command: type[SceneFlags], scene: type[Scene], **kinds: Any) -> type:
    """Returns a command class for the problem of ``scene``: the scene's flags, then its own. ``kinds`` are types that
    replace those of the scene's flags, by field."""
    flags = [(field_key(f.name), describe_flag(scene, f, kinds.get(f.name)),
              field(default=("none",) if f.default == () else f.default))
             for f in fields(scene) if f.name != "problem" and f.name not in command.LEFT_OUT]
    bases = (command, make_dataclass("Flags", flags, bases=(SceneFlags,), frozen=True, kw_only=True))
    return _make_command(command, scene, bases)


def with_scene_flags(command: type, scene: type[Scene], **kinds: Any) -> type:
    """Returns a command class for one problem; flags that it shares with the scene get the scene's type, help
    and default, or the type in ``kinds``, by field, and the command's default."""
    own = {f.name: f.default for f in fields(command)}
    flags = [(f.name, kinds[f.name], field(default=own[f.name])) if f.name in kinds
             else (f.name, describe_flag(scene, f), field(default=f.default)) for f in fields(scene) if f.name in own]
    return _make_command(command, scene, (make_dataclass("Flags", flags, bases=(command,), frozen=True, kw_only=True),))


def describe_flag(scene: type[Scene], f: Field, kind: Any = None) -> Any:
    """Returns the type of the flag for a scene class's field ``f``, or ``kind``, with its help, unit and default."""
    text, separator, rest = f.metadata["help"].partition(";")
    unit = f", {f.metadata['unit']}" if f.metadata["unit"] else ""
    hint = f"(default: {f.metadata['hint'].format(scene=scene)})" if f.metadata["hint"] and kind is None else None
    about = tyro.conf.arg(help=f"{text}{unit}{separator}{rest}.", help_behavior_hint=hint)
    return Annotated[kind or _flag_type(scene, f), about]


def _flag_type(scene: type[Scene], f: Field) -> Any:
    choices = scene.choices(f.name)
    if f.name in SPECIAL:
        return Annotated[Any, several_of((*choices, *SPECIAL[f.name]))]
    if choices:
        return Annotated[Any, one_of(choices)]
    if f.type == "str":
        return TextFlag
    return bool if f.type == "bool" else NumberFlag if "int" in str(f.type) else RealFlag


def _make_command(command: type[Any], scene: type[Scene], bases: tuple[type, ...]) -> type:
    methods = " ".join(scene.choices("method")[1:3])
    text = command.HELP.format(title=scene.TITLE, setting=scene.SETTING, methods=methods)
    example = command.EXAMPLE.format(problem=scene.problem, methods=methods)
    kind = type(f"{command.__name__}{scene.problem.capitalize()}", bases,
                {"SCENE": scene, "EXAMPLE": example, "__doc__": text})
    return dataclass(frozen=True, kw_only=True)(kind)


def _expand_special_words(flag: str, words: tuple[str, ...], special: dict[str, tuple[str, ...]]) -> tuple[str, ...]:
    """Returns a flag's words, or the meaning of a ``special`` one; raises BadInput if that does not stand alone."""
    if not words:
        raise BadInput(flag, "", "give one or several names (--help lists them)")
    alone = next((word for word in words if word in special), None)
    if alone and len(words) > 1:
        raise BadInput(flag, " ".join(words), f"{alone} stands alone; leave it or the others out")
    return special[alone] if alone else words
