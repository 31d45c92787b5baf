"""Runs of lessons whose exact solution nobody knows: a body that comes along, with changes to its file.

    body cantilever cells_per_metre=4 method=ugimp
"""

import functools
from dataclasses import fields, replace
from typing import Any

from app.shareable_state import StateError
from solvers.bodies.body import Body
from solvers.bodies.body_file import library_names, library_text, parse_body
from solvers.scene.validation import SceneError

WORD = "body"
CHANGEABLE = ("method", "cells_per_metre", "ppc", "t_end", "youngs_modulus", "poissons_ratio", "density")


def is_body_run(text: str) -> bool:
    """Returns whether a run's ``text`` is that of a body, and not of a scene."""
    return text.split()[:1] == [WORD]


@functools.cache
def body_of_run(text: str) -> Body:
    """Returns the body of a run's ``text``; raises :class:`StateError` if it is invalid."""
    rest = text.split()[1:]
    if not rest or rest[0] not in library_names():
        raise StateError("{text}: give body and one of {names}", text, ", ".join(library_names()))
    body, changes = parse_body(library_text(rest[0])), dict[str, Any]()
    kinds = {one.name: type(getattr(body, one.name)) for one in fields(Body)}
    for name, _, value in (part.partition("=") for part in rest[1:]):
        if name not in CHANGEABLE:
            raise StateError("{name} is no part of a body's run; give {names}", name, ", ".join(CHANGEABLE))
        try:
            changes[name] = kinds[name](value)
        except ValueError:
            raise StateError("{name} = {value}: give a number", name, value) from None
    try:
        return replace(body, **changes)
    except SceneError as error:
        raise StateError("{error}", error) from None


def goal_names() -> tuple[str, ...]:
    """Returns the names of the goals of all bodies that come along."""
    return tuple(sorted({goal for name in library_names() for goal in parse_body(library_text(name)).goals}))
