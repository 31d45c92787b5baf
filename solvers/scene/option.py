"""A field of a scene with what is said of it: the flags of the command line and the page's widgets are made of that."""

from dataclasses import field
from typing import Any


def option(default: Any, help: str = "", unit: str = "", choices: tuple[str, ...] = (), hint: str = "") -> Any:
    """A field of a scene, from which its flag and its widget are made.

    Parameters
    ----------
    default
    help
        What it is, in words that begin with a capital; after a semicolon what the flag's help puts behind the unit.
    unit
        In SI, "" for a mere number.
    choices
        What it may be, where that is one of a few names.
    hint
        What stands for a default that is None.
    """
    return field(default=default, metadata={"help": help, "unit": unit, "choices": choices, "hint": hint})
