"""What ``help(BarScene)`` says of its fields: what they are, in which unit, and what they may be."""

import inspect
import re
import textwrap
from dataclasses import fields
from typing import TYPE_CHECKING, Any, TypeVar

from solvers.scene.effects import EFFECTS

if TYPE_CHECKING:
    from solvers.scene.scene import Scene

Kind = TypeVar("Kind", bound="type[Scene]")
WIDTH = 100  # of a line


def described(kind: Kind) -> Kind:
    """A decorator of a scene's class, above ``dataclass``: its fields are told behind what its docstring says."""
    told = [f"{field.name} : {_type(field.type)}\n{textwrap.indent(_words(kind, field), '    ')}"
            for field in fields(kind) if field.metadata["help"]]
    kind.__doc__ = "\n".join([inspect.cleandoc(kind.__doc__ or ""), "", "Parameters", "----------", *told])
    return kind


def _type(annotation: Any) -> str:
    return annotation if isinstance(annotation, str) else getattr(annotation, "__name__", str(annotation))


def _words(kind: "type[Scene]", field: Any) -> str:
    meaning, unit, hint = (field.metadata[name] for name in ("help", "unit", "hint"))
    # Those from outside are looked for when a scene is made: one that is missing must not be the end of an import.
    here = {"estimators": kind.ESTIMATORS, "effects": (*EFFECTS, *kind.OWN_EFFECTS)}
    names = here.get(field.name) or kind.choices(field.name)
    default = hint.format(scene=kind) if hint else " ".join(field.default) if isinstance(field.default, tuple) else \
        field.default
    what, semicolon, rest = meaning.partition(";")
    several = "Any of" if isinstance(field.default, tuple) else "One of"
    parts = [f"{what}{f', in {unit}' * bool(unit)}{semicolon}{rest}.",
             f"{several} {', '.join(names)}." if names else "", f"Default: {default}."]
    text = re.sub(r"--([a-z]+)-?([a-z]*)", _as_field, " ".join(filter(None, parts)))
    return "\n".join(textwrap.wrap(text, WIDTH, break_on_hyphens=False))


def _as_field(flag: re.Match[str]) -> str:
    """A flag that a help text names is a field here."""
    return "_".join(filter(None, flag.groups()))
