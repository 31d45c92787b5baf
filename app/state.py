"""State: what is on the stage, as a text that fits into a link, a lesson or a command: scene, view and pinned run.

    bar;method=mpm;cells=80;estimators=recovered,transport;error-of=sigma;pinned;method=bspline;cells=80

The problem comes first, then what differs from its defaults, named as the command line's flags are; words of the view
are among them. What follows the word ``pinned`` is the pinned run, of the same problem. Words stand apart by ``;``,
``&``, spaces or new lines.
"""

import math
import re
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, fields
from difflib import get_close_matches
from functools import lru_cache
from typing import Any
from urllib.parse import unquote

from app.words import MAGNIFICATIONS, QUANTITIES
from solvers.problems import PROBLEMS
from solvers.scene.rules import SceneError, key_field
from solvers.scene.scene import LISTS, Scene

LONGEST = 2000  # characters that anybody needs
PINNED = "pinned"
YES, NO = ("yes", "true", "on", "1", ""), ("no", "false", "off", "0")


class StateError(ValueError):
    """A text that is no state: one sentence that names the word, says what is wrong and what is allowed."""


@dataclass(frozen=True)
class State:
    """What a visitor sees: the scene, and of the view what does not stand at its default.

    ``quantity`` is the key of the one whose error is shown, ``estimator`` the one on the stage where it is not the
    first; ``speed`` is in periods a second, None for the problem's own; ``traced`` is a particle's number;
    a run that ``stops`` pauses at its end.
    """

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
    pinned: Scene | None = None


def write(state: State) -> str:
    """The text of a state, as short as it can be."""
    view = [_word(key, getattr(state, field)) for key, (field, _) in VIEW.items()
            if getattr(state, field) != getattr(State(state.scene), field)]
    pinned = [] if state.pinned is None else [PINNED, *_scene_words(state.pinned)]
    return ";".join([state.scene.problem, *_scene_words(state.scene), *view, *pinned])


def read(text: str) -> State:
    """The state of a text; :class:`StateError` where it is none."""
    if len(text) > LONGEST:
        raise StateError(f"a scene of {len(text):,} characters is too long; at most {LONGEST:,} are allowed")
    problem, *rest = _words(text) or [text]
    if problem not in PROBLEMS:
        raise StateError(f"{_quoted(problem)} is no problem; begin with {' or '.join(PROBLEMS)}")
    first, pinned = rest, None
    if PINNED in rest:
        cut = rest.index(PINNED)
        first, pinned = rest[:cut], rest[cut + 1:]
    view: dict[str, Any] = {}
    scene = _scene(problem, [word for word in first if not _take(word, view)])
    state = State(scene, **view, pinned=None if pinned is None else _scene(problem, pinned))
    if state.estimator is not None and state.estimator not in scene.estimators:
        raise StateError(f"on-stage={state.estimator}: this estimator does not run; give one of "
                         f"{', '.join(scene.estimators) or 'none, for none runs'}")
    if state.traced is not None and state.traced >= scene.particles:
        raise StateError(f"trace={state.traced}: there are particles 0 to {scene.particles - 1}")
    return state


def begins(text: str) -> bool:
    """Whether a text is meant as a state: it begins with a problem."""
    return next(iter(_words(text)), "") in PROBLEMS


def _words(text: str) -> list[str]:
    return [word for word in re.split(r"[;&\s]+", unquote(text)) if word]


@lru_cache(maxsize=256)  # a page asks for its own again and again
def _scene_words(scene: Scene) -> tuple[str, ...]:
    """What of a scene differs from its problem's defaults."""
    default = type(scene)()
    return tuple(_word(_key(f.name), getattr(scene, f.name)) for f in fields(scene)
                 if f.name != "problem" and getattr(scene, f.name) != getattr(default, f.name))


def _word(key: str, value: Any) -> str:
    return key if value is True else f"{key}={_shown(value)}"


def _scene(problem: str, words: list[str]) -> Scene:
    kind, given = PROBLEMS[problem].scene, dict[str, Any]()
    names = {_key(f.name): f for f in fields(kind) if f.name != "problem"}
    for word in words:
        key, _, value = word.partition("=")
        key = _key(key_field(key.replace("-", "_")))
        if key not in names:
            close = get_close_matches(key, [*names, *VIEW], n=1)
            raise StateError(f"{_quoted(word)} means nothing here" + f" (did you mean {close[0]}?)" * bool(close)
                             + f"; give what `mpm-lab run {problem} --help` names, or {', '.join(VIEW)}")
        given[names[key].name] = _value(kind, names[key], key, value)
    try:
        return kind(**given)
    except SceneError as error:
        raise StateError(f"{_key(error.field)}={_shown(error.value)}: {error.sentence}") from None


def _value(kind: type[Scene], f: Any, key: str, text: str) -> Any:
    """What a word says of a field: names, yes or no, a number where it is one; the scene knows what is allowed."""
    if f.name in LISTS:
        names = tuple(name for name in text.split(",") if name)
        return () if names == ("none",) else kind.choices(f.name) if names == ("all",) else names
    if f.type == "bool":
        return _yes_or_no(key, text)
    return text if kind.choices(f.name) else _number(text)


def _take(word: str, view: dict[str, Any]) -> bool:
    """Whether a word is one of the view's, which is then put there."""
    key, _, text = word.partition("=")
    if key not in VIEW:
        return False
    field, read_word = VIEW[key]
    view[field] = read_word(key, text)
    return True


def _number(text: str) -> Any:
    """A whole number or a float where the text is one, else the text, of which the scene knows what to say."""
    for kind in (int, float):
        with suppress(ValueError):
            return kind(text)
    return text


def _yes_or_no(key: str, text: str) -> bool:
    if text not in (*YES, *NO):
        raise StateError(f"{key}={_quoted(text)}: give yes or no")
    return text in YES


def _one_of(meanings: Mapping[str, Any]) -> Callable[[str, str], Any]:
    def read_one(key: str, text: str) -> Any:
        if text not in meanings:
            raise StateError(f"{key}={_quoted(text)}: give one of {', '.join(meanings)}")
        return meanings[text]

    return read_one


def _speed(key: str, text: str) -> float:
    value = _number(text)
    if isinstance(value, str) or not 0 < value < math.inf:
        raise StateError(f"{key}={_quoted(text)}: give periods a second, above 0")
    return float(value)


def _particle(key: str, text: str) -> int:
    if not re.fullmatch(r"\d{1,9}", text):
        raise StateError(f"{key}={_quoted(text)}: give the number of a particle, 0 or more")
    return int(text)


def _shown(value: Any) -> str:
    if isinstance(value, (tuple, list)):
        return ",".join(map(str, value)) or "none"
    if isinstance(value, bool):
        return NO[0]
    return short if isinstance(value, float) and float(short := f"{value:g}") == value else str(value)


def _quoted(text: str) -> str:
    return repr(text if len(text) <= 40 else text[:37] + "...")


def _key(field: str) -> str:
    """How a field is called in a text: ``linearity-preserving``."""
    return field.replace("_", "-")


#: The words of the view, in the order in which they are written: the field of a state that each sets, and how its
#: text is read.
VIEW: dict[str, tuple[str, Callable[[str, str], Any]]] = {
    "error-of": ("quantity", _one_of({key: key for key in QUANTITIES})),
    "on-stage": ("estimator", lambda _, text: text), "difference": ("difference", _yes_or_no),
    "magnify": ("magnified", _one_of({str(factor): factor for factor in MAGNIFICATIONS})),
    "logarithmic": ("logarithmic", _yes_or_no), "domains": ("domains", _yes_or_no), "speed": ("speed", _speed),
    "trace": ("traced", _particle), "stops": ("stops", _yes_or_no)}
