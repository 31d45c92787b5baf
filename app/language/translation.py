"""Translation of the code's English texts by ``CODE.po`` in this folder, and choice of the language: that in the page's
address, else the first that the browser accepts.

Work for a visitor runs in the visitor's language (:func:`use_language`), which :func:`tr` uses. New threads begin with
English; work passed to one is wrapped by :func:`with_language`."""

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

from solvers.translatable_message import Message

P = ParamSpec("P")
T = TypeVar("T")

ENGLISH = "en"
FOLDER = Path(__file__).parent


class Language(NamedTuple):
    """Language: its own name, and the file of its translations, which English does not have."""

    name: str
    file: Path | None = None


#: By code.
LANGUAGES = {ENGLISH: Language("English"), "de": Language("Deutsch", FOLDER / "de.po")}
COOKIE = "mpm-lab-language"
LONGEST = 1000  # characters of a request that are read

_current: ContextVar[str] = ContextVar("language", default=ENGLISH)


class Catalogue:
    """Translations of the code's texts into one language; unknown ones stay as they are."""

    def __init__(self, file: polib.POFile):
        self._words = gettext.GNUTranslations(io.BytesIO(file.to_binary()))
        self._texts = {entry.msgid: (entry.msgstr, {place for place, _ in entry.occurrences}) for entry in file}

    def singular(self, text: str) -> str:
        return self._words.gettext(text)

    def plural(self, one: str, many: str, count: float) -> str:
        return self._words.ngettext(one, many, int(count) if count == int(count) else 2)  # 2.5 are several

    def translations_for_files(self, places: str | tuple[str, ...]) -> dict[str, str]:
        """Returns the translations of texts in files whose paths begin so, such as scripts."""
        return {text: said for text, (said, files) in self._texts.items() if said
                and any(file.startswith(places) for file in files)}


@functools.lru_cache
def load_catalogue(code: str) -> Catalogue:
    """Returns the catalogue of a language; that of English is empty."""
    file = LANGUAGES[code].file
    return Catalogue(polib.pofile(str(file)) if file else polib.POFile())


def current_language() -> str:
    """Returns the code of the current language."""
    return _current.get()


@contextmanager
def use_language(code: str) -> Iterator[None]:
    """Context manager: sets the current language."""
    before = _current.set(code)
    try:
        yield
    finally:
        _current.reset(before)


def with_language(work: Callable[P, T], code: str = "") -> Callable[P, T]:
    """Wraps a function to run, on any thread, in the present language or in that of ``code``."""
    code = code or current_language()

    def in_language(*args: P.args, **options: P.kwargs) -> T:
        before = _current.set(code)  # as in `use_language`, at half the cost, for every frame
        try:
            return work(*args, **options)
        finally:
            _current.reset(before)

    return in_language


def tr(text: str, /, **values: Any) -> str:
    """Translates a text of the code into the current language; ``values`` replace its placeholders ``{name}``."""
    said = text if current_language() == ENGLISH else load_catalogue(current_language()).singular(text)
    return said.format(**values) if values else said


def trn(one: str, many: str, count: float, **values: Any) -> str:
    """Translates the text that fits a count, which replaces ``{count}`` in both, into the current language."""
    if current_language() == ENGLISH:
        return (one if count == 1 else many).format(count=count, **values)
    return load_catalogue(current_language()).plural(one, many, count).format(count=count, **values)


def translate_message(text: str) -> str:
    """Translates a message of the solvers, and the messages among its values; names, numbers and quotes stay."""
    if current_language() == ENGLISH or not isinstance(text, Message):
        return text
    return tr(text.template, **{name: translate_message(value) for name, value in text.values.items()})


def lazy(text: str) -> str:
    """Marks a text for translation by :func:`tr` where it is used, such as one of a table."""
    return text


def language_cache(most: int) -> Callable[[Callable[..., T]], Callable[..., T]]:
    """Decorator like :func:`functools.lru_cache`, with separate results for each language."""
    def decorate(work: Callable[..., T]) -> Callable[..., T]:
        @functools.lru_cache(most)
        def in_language(_: str, *args: Any, **options: Any) -> T:
            return work(*args, **options)

        return functools.wraps(work)(lambda *args, **options: in_language(current_language(), *args, **options))

    return decorate


def localised_path(path: Path) -> Path:
    """Returns the file in the current language, ``about.de.html`` beside ``about.html``, if there is one."""
    own = path.with_suffix(f".{current_language()}{path.suffix}")
    return own if current_language() != ENGLISH and own.is_file() else path


def preferred_language(query: str, accepted: str) -> str:
    """Returns a page's language, from the ``query`` of its address (``lang=de``), else the header Accept-Language."""
    asked = parse_qs(query[:LONGEST]).get("lang", [""])[-1].lower()
    if asked in LANGUAGES:
        return asked
    return next((code for code in _languages_by_preference(accepted) if code in LANGUAGES), ENGLISH)


def _languages_by_preference(accepted: str) -> list[str]:
    """Returns the languages of a header such as ``de-CH, en;q=0.7`` by preference, without their countries."""
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


def language_cookie_header(code: str) -> str:
    """Returns the header of a cookie with the page's language, for its websocket, which has another address."""
    return f"{COOKIE}={code}; Path=/; HttpOnly; SameSite=Strict"


def language_from_cookies(cookies: list[str]) -> str:
    """Returns the language in the cookies of a request."""
    pairs = (pair.strip().partition("=") for line in cookies for pair in line.split(";"))
    named = next((value for name, _, value in pairs if name == COOKIE), ENGLISH)
    return named if named in LANGUAGES else ENGLISH
