"""Validation of a scene's inputs, with one sentence for each that is invalid."""

import math
import sys
from typing import Any

import numpy as np

from solvers.translatable_message import Message
from solvers.untrusted import number_parsing, quoting

KEYS = {"estimators": "estimator"}  # where a field's name and its key in the JSON object differ
#: Synonyms of fields, which flags and links may use.
SYNONYMS = {"estimate": "estimators", "effect": "effects", "diagnostic": "effects", "diagnostics": "effects",
            "remedy": "remedies", "stabilisation": "remedies", "stabilisations": "remedies",
            **{key: field for field, key in KEYS.items()}}


class SceneError(ValueError):
    """Error for an input that no run can have: its name, ``field``, the ``value``, and a ``sentence`` that says what is
    wrong and what is allowed, a template with places for the further values."""

    def __init__(self, field: str, value: object, sentence: str, /, *values: object):
        message = Message(sentence, *values)
        self.field, self.value, self.sentence = field, value, quoting.one_line(message)
        # A number given as text is shown in quotes, to distinguish it from the number.
        shown = repr(value) if isinstance(value, str) and number_parsing.is_number(value) else value
        super().__init__(quoting.one_line(Message("{field} {value}: {message}", field_label(field),
                                                  quoting.quote(shown), message)))


def field_key(field: str) -> str:
    """Returns the key of a scene's field in the JSON object: ``estimators`` is ``estimator``."""
    return KEYS.get(field, field)


def key_field(key: str) -> str:
    """Returns the name of the scene's field that a key of the JSON object, or one of its synonyms, stands for."""
    return SYNONYMS.get(key, key)


def field_flag(field: str) -> str:
    """Returns the name of a field's flag, without the dashes in front: ``body_force`` is ``body-force``."""
    return field_key(field).replace("_", "-")


def field_label(field: str) -> str:
    """Returns the name of a field for people: ``body_force`` is ``body force``."""
    return Message(field_key(field).replace("_", " "))


def require_choice(field: str, value: object, allowed: tuple[str, ...], also: str = "") -> None:
    """Raises :class:`SceneError` for a field's value that is no allowed name; its sentence lists ``also`` too."""
    if value not in allowed:
        names = ", ".join((*allowed, also) if also else allowed)
        near = quoting.suggest_word(value, allowed) if isinstance(value, str) else ""
        raise SceneError(field, value, "is not known{near}; give {one_of}{names}", near,
                         Message("one of ") if "," in names else "", names)


def normalized_inputs(scene: Any, lists: tuple[str, ...]) -> dict[str, Any]:
    """Returns by field name the inputs of a scene that are replaced: NumPy scalars become Python numbers, and in the
    fields called ``lists`` a text becomes a tuple of names; names that begin with + are added to the default."""
    given = {name: getattr(scene, name) for name in scene.__dataclass_fields__}
    return {name: value.item() for name, value in given.items() if isinstance(value, np.generic)} | {
        name: _names_in_order(name, given[name], scene.__dataclass_fields__[name].default) for name in lists}


def _names_in_order(field: str, given: Any, default: tuple[str, ...]) -> Any:
    if not isinstance(given, (str, list, tuple)):
        return given
    names = tuple(given.replace(",", " ").split() if isinstance(given, str) else given)
    added = [item for item in names if str(item).startswith("+")]
    if added and len(added) < len(names):
        raise SceneError(field, " ".join(map(str, names)), "mixes names with a +, which are added to the default, with "
                                                           "others; give all names with a +, or none")
    return (*default, *(item[1:] for item in added if item[1:] not in default)) if added else names


def require_names(field: str, chosen: object, allowed: tuple[str, ...]) -> None:
    """Raises :class:`SceneError` for a field's value that is no tuple of allowed names, each once."""
    if not isinstance(chosen, tuple):
        raise SceneError(field, chosen, "give a list of names out of {allowed}", ", ".join((*allowed, "none")))
    for item in chosen:
        require_choice(field, item, allowed, also="none")
    if len(set(chosen)) != len(chosen):
        raise SceneError(field, " ".join(chosen), "names something twice; give each name once")


def require_whole(field: str, value: object, least: int, most: int) -> None:
    """Raises :class:`SceneError` for a field's value that is no whole number from ``least`` to ``most``."""
    if isinstance(value, bool) or not isinstance(value, int) or not least <= value <= most:
        given = repr(value) if isinstance(value, float) and value.is_integer() else value  # 40.0, not 40
        raise SceneError(field, given, "give a whole number from {least:,} to {most:,}", least, most)


def require_number(field: str, value: object, above: float, most: float, allowed: str = "") -> None:
    """Raises :class:`SceneError` for a field's value that is no number above ``above`` and up to ``most``; its sentence
    then says what is ``allowed``, by default these limits."""
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not abs(value) <= sys.float_info.max \
            or not above < value <= most:  # also NaN, infinity, and integers beyond all floats
        upper = "" if math.isinf(most) else Message(" and up to {most:g}", most)
        raise SceneError(field, value, allowed or Message("give a number above {above:g}{upper}", above, upper))
