"""The language in which a visitor is spoken to, what the words of the code are in it, and which one a browser
wants: that which its address names, else the first of its own that there is.

English is what the code says; ``CODE.po`` beside this file says what that is in another language. Whoever does
something for one visitor does it while his language is spoken (:func:`use_language`): then :func:`tr` finds his words.
A thread begins with English: what is done on another one for a visitor is :func:`with_language` there.
"""

import functools
import gettext
import io
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from typing import Any, NamedTuple, ParamSpec, TypeVar
from urllib.parse import parse_qs

import polib

from solvers.message import Message

P = ParamSpec("P")
T = TypeVar("T")

ENGLISH = "en"
FOLDER = Path(__file__).parent


class Language(NamedTuple):
    """A language: what it calls itself, and the file of its words, which English has not."""

    name: str
    file: Path | None = None


#: By their codes.
LANGUAGES = {ENGLISH: Language("English"), "de": Language("Deutsch", FOLDER / "de.po")}
COOKIE = "mpm-lab-language"
LONGEST = 1000  # characters of a wish that are read

_spoken: ContextVar[str] = ContextVar("language", default=ENGLISH)


class Catalogue:
    """What the words of the code are in one language; those that it does not have stay as they are."""

    def __init__(self, file: polib.POFile):
        self._words = gettext.GNUTranslations(io.BytesIO(file.to_binary()))
        self._texts = {entry.msgid: (entry.msgstr, {place for place, _ in entry.occurrences}) for entry in file}

    def one(self, text: str) -> str:
        return self._words.gettext(text)

    def several(self, one: str, many: str, count: float) -> str:
        return self._words.ngettext(one, many, int(count) if count == int(count) else 2)  # 2.5 are several

    def of_files(self, places: str | tuple[str, ...]) -> dict[str, str]:
        """The texts of files whose paths begin so, for those whose language is none of Python."""
        return {text: said for text, (said, files) in self._texts.items() if said
                and any(file.startswith(places) for file in files)}


@functools.lru_cache
def load_catalogue(code: str) -> Catalogue:
    """The words of a language; of English there are none, for the code has them."""
    file = LANGUAGES[code].file
    return Catalogue(polib.pofile(str(file)) if file else polib.POFile())


def current_language() -> str:
    """The code of the language that is spoken now."""
    return _spoken.get()


@contextmanager
def use_language(code: str) -> Iterator[None]:
    """Speak a language meanwhile."""
    before = _spoken.set(code)
    try:
        yield
    finally:
        _spoken.reset(before)


def with_language(work: Callable[P, T], code: str = "") -> Callable[P, T]:
    """The same work, on whatever thread, in the language that is spoken now, or in that of a ``code``."""
    code = code or current_language()

    def spoken(*args: P.args, **options: P.kwargs) -> T:
        before = _spoken.set(code)  # as in `speaking`, at half the price: it is done with every frame
        try:
            return work(*args, **options)
        finally:
            _spoken.reset(before)

    return spoken


def tr(text: str, /, **values: Any) -> str:
    """A text of the code in the language that is spoken, with the ``values`` in its places: ``{name}``."""
    said = text if current_language() == ENGLISH else load_catalogue(current_language()).one(text)
    return said.format(**values) if values else said


def trn(one: str, many: str, count: float, **values: Any) -> str:
    """Of two texts the one that goes with a count, which ``{count}`` is in both, in the language that is spoken."""
    if current_language() == ENGLISH:
        return (one if count == 1 else many).format(count=count, **values)
    return load_catalogue(current_language()).several(one, many, count).format(count=count, **values)


def translate_message(text: str) -> str:
    """A message of the solvers in the language that is spoken, with the messages that it is made of; names, numbers
    and quotes stay as they are."""
    if current_language() == ENGLISH or not isinstance(text, Message):
        return text
    return tr(text.template, **{name: translate_message(value) for name, value in text.values.items()})


def lazy(text: str) -> str:
    """A text that is put into the visitor's language by :func:`tr` where it is said: one of a table, say."""
    return text


def language_cache(most: int) -> Callable[[Callable[..., T]], Callable[..., T]]:
    """As :func:`functools.lru_cache`, of so many results, for what has words in it: each language has its own."""
    def keeping(work: Callable[..., T]) -> Callable[..., T]:
        @functools.lru_cache(most)
        def in_language(_: str, *args: Any, **options: Any) -> T:
            return work(*args, **options)

        return functools.wraps(work)(lambda *args, **options: in_language(current_language(), *args, **options))

    return keeping


def localised_path(path: Path) -> Path:
    """A file of text in the language that is spoken: ``about.de.html`` beside ``about.html``, where there is one."""
    own = path.with_suffix(f".{current_language()}{path.suffix}")
    return own if current_language() != ENGLISH and own.is_file() else path


def preferred_language(query: str, accepted: str) -> str:
    """The language of a page: of the ``query`` of its address (``lang=de``), else of the header Accept-Language."""
    asked = parse_qs(query[:LONGEST]).get("lang", [""])[-1].lower()
    if asked in LANGUAGES:
        return asked
    return next((code for code in _by_liking(accepted) if code in LANGUAGES), ENGLISH)


def _by_liking(accepted: str) -> list[str]:
    """The languages of a header such as ``de-CH, en;q=0.7``, the most wanted first, without their countries."""
    liked = []
    for place, part in enumerate(accepted[:LONGEST].split(",")):
        name, _, quality = part.strip().lower().partition(";q=")
        try:
            much = float(quality or 1)
        except ValueError:
            continue
        if much > 0:
            liked.append((-much, place, name.partition("-")[0]))
    return [name for _, _, name in sorted(liked)]


def as_cookie(code: str) -> str:
    """The header by which a browser tells its websocket, whose address is not the page's, what the page speaks."""
    return f"{COOKIE}={code}; Path=/; HttpOnly; SameSite=Strict"


def of_cookie(cookies: list[str]) -> str:
    """The language that the cookies of a request name."""
    pairs = (pair.strip().partition("=") for line in cookies for pair in line.split(";"))
    named = next((value for name, _, value in pairs if name == COOKIE), ENGLISH)
    return named if named in LANGUAGES else ENGLISH
