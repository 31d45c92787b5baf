"""Fields of a scene with help texts, the source of command-line flags, page widgets and ``help(BarScene)``."""

import inspect
import re
import textwrap
from dataclasses import field, fields
from typing import Any, TypeVar

from solvers.scene.effects import EFFECTS

Kind = TypeVar("Kind", bound=type[Any])  # of a scene
LINE_WIDTH = 100  # characters


def option(default: Any, help: str = "", unit: str = "", choices: tuple[str, ...] = (), hint: str = "") -> Any:
    """Returns a dataclass field of a scene, the source of its flag and widget. ``help`` is its meaning, beginning with
    a capital; after a semicolon comes the part that the flag's help puts behind the unit. ``unit`` is in SI, "" for
    none; ``choices`` are allowed names, if only a few are; ``hint`` is a text in place of a default that is None."""
    return field(default=default, metadata={"help": help, "unit": unit, "choices": choices, "hint": hint})


def document_fields(kind: Kind) -> Kind:
    """Class decorator above ``dataclass``: appends each field's meaning, unit and choices to the class's docstring."""
    told = [f"{field.name} : {_type_text(field.type)}\n{textwrap.indent(_help_text(kind, field), '    ')}"
            for field in fields(kind) if field.metadata["help"]]
    kind.__doc__ = "\n".join([inspect.cleandoc(kind.__doc__ or ""), "", "Parameters", "----------", *told])
    return kind


def _type_text(annotation: Any) -> str:
    return annotation if isinstance(annotation, str) else getattr(annotation, "__name__", str(annotation))


def _help_text(kind: type[Any], field: Any) -> str:
    meaning, unit, hint = (field.metadata[name] for name in ("help", "unit", "hint"))
    # Extensions are loaded only when a scene is made: a missing one must not make an import fail.
    here = {"estimators": kind.ESTIMATORS, "effects": (*EFFECTS, *kind.OWN_EFFECTS)}
    names = here.get(field.name) or kind.choices(field.name)
    default = hint.format(scene=kind) if hint else " ".join(field.default) if isinstance(field.default, tuple) else \
        field.default
    what, semicolon, rest = meaning.partition(";")
    several = "Any of" if isinstance(field.default, tuple) else "One of"
    parts = [f"{what}{f', in {unit}' * bool(unit)}{semicolon}{rest}.",
             f"{several} {', '.join(names)}." if names else "", f"Default: {default}."]
    text = re.sub(r"--([a-z]+)-?([a-z]*)", lambda flag: "_".join(filter(None, flag.groups())),  # a flag is a field here
                  " ".join(filter(None, parts)))
    return "\n".join(textwrap.wrap(text, LINE_WIDTH, break_on_hyphens=False))
