"""Schemas of stored JSON, and descriptions of mismatches, in words.

A schema (``form``) is a type or a tuple of types; a mapping from required keys to the schemas of their values; or
:class:`MapOf`, for an object of any keys. Numbers are finite, and booleans are not numbers.
"""

import json
from dataclasses import dataclass
from typing import Any

from solvers.untrusted import quoting

NUMBER = (int, float)
NUMBER_OR_NONE = (int, float, type(None))


@dataclass(frozen=True)
class MapOf:
    """Schema of an object with any keys, whose values all have the schema ``form``."""

    form: Any


def parse_json(text: bytes | str) -> Any:
    """Returns the value of a JSON text. Raises :class:`ValueError` where it is invalid, or cannot be written again: NaN
    and infinity, half a character, or nested too deep."""
    try:
        value = json.loads(text)
        json.dumps(value, allow_nan=False, ensure_ascii=False).encode()
    except RecursionError:
        raise ValueError("nested too deep") from None
    return value


def describe_mismatch(value: Any, form: Any, name: str = "") -> str | None:
    """Returns what is wrong with a JSON value called ``name``, ``it has no status`` for example; None where it matches
    the schema ``form``: a type or several, a dict of required keys with schemas, or :class:`MapOf`."""
    if isinstance(form, (dict, MapOf)):
        if not isinstance(value, dict):
            return f"{name or 'it'} is no object"
        missing = [] if isinstance(form, MapOf) else [key for key in form if key not in value]
        if missing:
            return f"it has no {_json_path(name, missing[0])}"
        parts = dict.fromkeys(value, form.form) if isinstance(form, MapOf) else form
        found = (describe_mismatch(value[key], part, _json_path(name, key)) for key, part in parts.items())
        return next(filter(None, found), None)
    types = form if isinstance(form, tuple) else (form,)
    right = isinstance(value, types) and (bool in types or not isinstance(value, bool))
    return None if right else f"{name or 'it'} is of the wrong kind"


def _json_path(name: str, key: str) -> str:
    return f"{name}.{quoting.quote(key)}" if name else quoting.quote(key)
