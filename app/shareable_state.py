"""State of the stage as a text that fits into a link, a lesson or a command: scene, view and pinned run.

    bar;method=mpm;cells=80;estimators=recovered,transport;error-of=sigma;pinned;method=bspline;cells=80

The problem comes first, then the fields that differ from its defaults, named as the command line's flags are, and words
of the view. The word ``pinned`` precedes the fields of the pinned run, of the same problem. Words are separated by
``;``, ``&``, spaces or new lines. The grammar:

    state  = problem {word} ["pinned" {field}]
    word   = field | view
    field  = name ["=" value]        of the scene, each once
    view   = name ["=" value]        of ``VIEW``, each once
    value  = a number (``solvers.untrusted.number_parsing``), a name, names with commas between, or yes or no"""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from functools import lru_cache
from typing import Any
from urllib.parse import unquote

from app.names_and_units import MAGNIFICATIONS, QUANTITIES
from solvers.problems import PROBLEMS
from solvers.scene.scene import LISTS, Scene
from solvers.scene.validation import SceneError, key_field
from solvers.translatable_message import Message, join_messages
from solvers.untrusted import number_parsing, quoting

LONGEST = 2000  # characters
PINNED = "pinned"
YES, NO = ("yes", "true", "on", "1", ""), (Message("no"), "false", "off", "0")


class StateError(ValueError):
    """Raised for an invalid state; the message, a template with values, names the word and what is allowed."""

    def __init__(self, sentence: str, /, *values: object):
        super().__init__(quoting.one_line(Message(sentence, *values)))


@dataclass(frozen=True)
class State:
    """What a visitor sees: the scene, and the settings of the view.

    ``quantity`` is the key of the quantity whose error is shown, ``estimator`` the one on the stage if it is not the
    first; ``difference`` shows estimate minus truth, ``magnified`` is the factor of a plotted field's deviation,
    ``logarithmic`` the scale of errors over time, ``domains`` shows those of the particles; ``speed`` is in periods per
    second, None for the problem's own; ``traced`` is a particle's number; a run that ``stops`` pauses at its end.
    Beside it runs the same scene by the ``compared`` method (its key), or the scene ``pinned``."""

    scene: Scene
    quantity: str = next(iter(QUANTITIES))
    estimator: str | None = None
    difference: bool = False
    magnified: int = 1
    logarithmic: bool = False
    domains: bool = False
    speed: float | None = None
    traced: int | None = None
    stops: bool = False
    compared: str | None = None
    pinned: Scene | None = None


def write_state(state: State) -> str:
    """Returns the shortest text of a state, which :func:`parse_state` reads."""
    view = [_word(key, getattr(state, field)) for key, (field, _) in VIEW.items()
            if getattr(state, field) != getattr(State(state.scene), field)]
    pinned = [] if state.pinned is None else [PINNED, *_scene_words(state.pinned)]
    return ";".join([state.scene.problem, *_scene_words(state.scene), *view, *pinned])


def parse_state(text: str) -> State:
    """Returns the state that a text describes; raises :class:`StateError` if it is invalid."""
    if len(text) > LONGEST:
        raise StateError("a scene of {text:,} characters is too long; at most {most:,} are allowed", len(text), LONGEST)
    problem, *rest = _split_words(text) or [""]
    if problem not in PROBLEMS:
        raise StateError("{problem} is no problem{suggestion}; begin with {problems}", _quote_in_message(problem),
                         quoting.suggest_word(problem, PROBLEMS), join_messages(" or ", PROBLEMS))
    cut = rest.index(PINNED) if PINNED in rest else len(rest)
    view: dict[str, Any] = {}
    scene = _parse_scene(problem, [word for word in rest[:cut] if not _read_view_word(word, view)])
    pinned = _parse_scene(problem, rest[cut + 1:], of_pinned=True) if PINNED in rest else None
    state = State(scene, **view, pinned=pinned)
    if state.estimator is not None and state.estimator not in scene.estimators:
        raise StateError("on-stage={estimator}: this estimator does not run; give one of {estimators}",
                         _quote_in_message(state.estimator),
                         ", ".join(scene.estimators) or Message("none, for none runs"))
    if state.traced is not None and state.traced >= scene.particles:
        raise StateError("trace={traced}: there are particles 0 to {particles}", state.traced, scene.particles - 1)
    if state.compared is not None and (pinned or state.compared not in scene.choices("method")):
        raise StateError("compare={compared}: give one of {methods}, and no pinned run",
                         _quote_in_message(state.compared), ", ".join(scene.choices("method")))
    return state


def looks_like_state(text: str) -> bool:
    """Whether a text begins with a problem's name, as states do."""
    return len(text) <= LONGEST and next(iter(_split_words(text)), "") in PROBLEMS


def _split_words(text: str) -> list[str]:
    return [word for word in re.split(r"[;&\s]+", unquote(text)) if word]


@lru_cache(maxsize=256)  # a page needs its own repeatedly
def _scene_words(scene: Scene) -> tuple[str, ...]:
    """Returns the words, such as "cells=80", for fields of a scene that differ from its problem's defaults."""
    default = type(scene)()
    return tuple(_word(_key(f.name), getattr(scene, f.name)) for f in fields(scene)
                 if f.name != "problem" and getattr(scene, f.name) != getattr(default, f.name))


def _word(key: str, value: Any) -> str:
    return key if value is True else f"{key}={_format_value(value)}"


def _parse_scene(problem: str, words: list[str], of_pinned: bool = False) -> Scene:
    kind, given = PROBLEMS[problem].scene, dict[str, Any]()
    names = {_key(f.name): f for f in fields(kind) if f.name != "problem"}
    for word in words:
        name, _, value = word.partition("=")
        key = _key(key_field(name.replace("-", "_")))
        if key not in names or PINNED in word.split("="):
            raise StateError(_unknown_word(problem, word, name, [*names, *(() if of_pinned else VIEW)], of_pinned))
        if names[key].name in given:
            raise _duplicate_error(key)
        given[names[key].name] = _parse_value(kind, names[key], key, value)
    try:
        return kind(**given)
    except SceneError as error:
        raise StateError("{given}: {sentence}", f"{_key(error.field)}={quoting.quote(_format_value(error.value))}",
                         error.sentence) from None


def _unknown_word(problem: str, word: str, name: str, known: list[str], of_pinned: bool) -> str:
    """Returns the sentence why a word, which begins with ``name``, is no field of a scene; ``known`` are suggested."""
    quoted = _quote_in_message(word)
    if name in ("problem", *PROBLEMS):
        return Message("{word}: the problem stands once, as the first word", quoted) + \
            Message("; the pinned run is of the {problem} too", Message(problem)) * of_pinned
    if name == PINNED:
        return Message("{word}: the word pinned stands once, alone, before what differs in the pinned run", quoted)
    if of_pinned and name in VIEW:
        return Message("{word} is of the view, which both runs share; give it before the word pinned", quoted)
    more = "" if of_pinned else Message(", or {names}", ", ".join(VIEW))
    return Message("{word} means nothing here{name}; give what `mpm-lab run {problem} --help` names{more}", quoted,
                   quoting.suggest_word(name, known), problem, more)


def _duplicate_error(key: str) -> StateError:
    return StateError("{key} is given twice; give it once", key)


def _parse_value(kind: type[Scene], f: Any, key: str, text: str) -> Any:
    """Returns the value of a scene class's field ``f``: names, a bool, a number or a text; the scene validates it."""
    if f.name in LISTS:
        names = tuple(name for name in text.split(",") if name)
        return () if names == ("none",) else kind.choices(f.name) if names == ("all",) else names
    if f.type == "bool":
        return _parse_yes_or_no(key, text)
    return text if kind.choices(f.name) or f.type == "str" else _parse_number_or_text(text)


def _read_view_word(word: str, view: dict[str, Any]) -> bool:
    """Stores a word's value in ``view`` by the state's field; returns False if the word is none of the view."""
    key, _, text = word.partition("=")
    if key not in VIEW:
        return False
    field, read_word = VIEW[key]
    if field in view:
        raise _duplicate_error(key)
    view[field] = read_word(key, text)
    return True


def _parse_number_or_text(text: str) -> Any:
    """Returns an integer or a float if the text is one, else the text, which the scene will reject."""
    return number_parsing.parse_number(text) if number_parsing.is_number(text) else text


def _parse_yes_or_no(key: str, text: str) -> bool:
    if text not in (*YES, *NO):
        raise StateError("{key}={text}: give yes or no", key, _quote_in_message(text))
    return text in YES


def _choice_parser(meanings: Mapping[str, Any]) -> Callable[[str, str], Any]:
    """Returns a parser of a value's text, for a word with this key, that allows only the texts in ``meanings``."""
    def read_one(key: str, text: str) -> Any:
        if text not in meanings:
            raise StateError(Message("{key}={text}: give one of {meanings}", key, _quote_in_message(text),
                                     ", ".join(meanings)) + quoting.suggest_word(text, meanings))
        return meanings[text]

    return read_one


def _parse_speed(key: str, text: str) -> float:
    value = _parse_number_or_text(text)
    if isinstance(value, str) or value <= 0:
        raise StateError("{key}={text}: give periods a second, above 0", key, _quote_in_message(text))
    return float(value)


def _parse_particle(key: str, text: str) -> int:
    if (number := number_parsing.parse_count(text)) is None:
        raise StateError("{key}={text}: give the number of a particle, 0 or more", key, _quote_in_message(text))
    return number


def _format_value(value: Any) -> str:
    if isinstance(value, (tuple, list)):
        return ",".join(map(str, value)) or "none"
    if isinstance(value, bool):
        return NO[0]
    return short if isinstance(value, float) and float(short := f"{value:g}") == value else str(value)


def _quote_in_message(text: str) -> str:
    return f"'{quoting.quote(text, 40)}'" if text else "''"


def _key(field: str) -> str:
    """Returns a field's name in a text: ``linearity-preserving``."""
    return field.replace("_", "-")


#: Words of the view, in the order of writing, with the state's field of each and the parser of its value.
VIEW: dict[str, tuple[str, Callable[[str, str], Any]]] = {
    "error-of": ("quantity", _choice_parser({key: key for key in QUANTITIES})),
    "on-stage": ("estimator", lambda _, text: text), "difference": ("difference", _parse_yes_or_no),
    "magnify": ("magnified", _choice_parser({str(factor): factor for factor in MAGNIFICATIONS})),
    "logarithmic": ("logarithmic", _parse_yes_or_no), "domains": ("domains", _parse_yes_or_no),
    "speed": ("speed", _parse_speed), "trace": ("traced", _parse_particle), "stops": ("stops", _parse_yes_or_no),
    "compare": ("compared", lambda _, text: text)}
