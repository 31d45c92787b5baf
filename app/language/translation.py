"""Translation of the code's English texts by ``CODE.po`` in this folder, and choice of the language: that in the page's
address, else the first that the browser accepts.

Work for a visitor runs in the visitor's language (:func:`use_language`), which :func:`tr` uses. New threads begin with
English; work passed to one is wrapped by :func:`with_language`."""

import functools
import gettext
import io
import re
import string
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from numbers import Real
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
    """Language: its name in itself, the .po file of its translations, which English does not have, and the marks of its
    decimals and thousands."""

    name: str
    file: Path | None = None
    marks: str = ".,"


#: By code.
LANGUAGES = {ENGLISH: Language("English"), "de": Language("Deutsch", FOLDER / "de.po", ",.")}
_NUMBER = r"[-+]?\d[\d,]*(\.\d+)?(e[-+]?\d+)?"  # as in English
_NUMBERS = re.compile(f"{_NUMBER}(, {_NUMBER})*")
LONGEST = 1000  # characters of a request that are read

_current: ContextVar[str] = ContextVar("language", default=ENGLISH)


class Catalogue:
    """Translations of the code's texts into one language, from a gettext ``file``; unknown texts stay."""

    def __init__(self, file: polib.POFile):
        self._words = gettext.GNUTranslations(io.BytesIO(file.to_binary()))
        self._texts = {entry.msgid: (entry.msgstr, {place for place, _ in entry.occurrences}) for entry in file}

    def singular(self, text: str) -> str:
        return self._words.gettext(text)

    def plural(self, one: str, many: str, count: float) -> str:
        """Returns the translation of ``one`` or ``many``, as the count needs; ``{count}`` stays in it."""
        return self._words.ngettext(one, many, int(count) if count == int(count) else 2)  # 2.5 are several

    def translations_for_files(self, prefixes: str | tuple[str, ...]) -> dict[str, str]:
        """Returns, by English text, translations of texts in files whose paths begin with a prefix: "app/page/web/"."""
        return {text: said for text, (said, files) in self._texts.items() if said
                and any(file.startswith(prefixes) for file in files)}


@functools.lru_cache
def load_catalogue(code: str) -> Catalogue:
    """Returns the catalogue of the language with this code; that of English is empty."""
    file = LANGUAGES[code].file
    return Catalogue(polib.pofile(str(file)) if file else polib.POFile())


def current_language() -> str:
    """Returns the code of the current language, such as "de"."""
    return _current.get()


@contextmanager
def use_language(code: str) -> Iterator[None]:
    """Context manager: sets the current language by its ``code`` within the block."""
    before = _current.set(code)
    try:
        yield
    finally:
        _current.reset(before)


def with_language(work: Callable[P, T], code: str = "") -> Callable[P, T]:
    """Returns a function like ``work`` that runs, on any thread, in the present language or in that of ``code``."""
    code = code or current_language()

    def in_language(*args: P.args, **options: P.kwargs) -> T:
        before = _current.set(code)  # as in `use_language`, at half the cost, for every frame
        try:
            return work(*args, **options)
        finally:
            _current.reset(before)

    return in_language


def localise_number(text: str) -> str:
    """Returns a number, written as in English, with the marks of the current language: "2,5" in German."""
    return text.translate(str.maketrans(".,", LANGUAGES[current_language()].marks))


def localise_numbers(text: str) -> str:
    """Returns one or several numbers, written as in English with ", " between them, as in the current language: with
    decimal commas there are semicolons between them, "0,4; 0,25"."""
    between = "; " if localise_number(".") == "," and "." in text else ", "
    return between.join(map(localise_number, text.split(", ")))


class _NumberFormatter(string.Formatter):
    """Fills placeholders like :meth:`str.format`, and writes numbers as in the current language."""

    def format_field(self, value: Any, format_spec: str) -> str:
        text = super().format_field(value, format_spec)
        return localise_number(text) if isinstance(value, Real) else text


_FORMATTER = _NumberFormatter()


def tr(text: str, /, **values: Any) -> str:
    """Translates a text of the code into the current language; ``values`` replace its placeholders ``{name}``."""
    if current_language() == ENGLISH:
        return text.format(**values) if values else text
    said = load_catalogue(current_language()).singular(text)
    return _FORMATTER.vformat(said, (), values) if values else said


def trn(one: str, many: str, count: float, **values: Any) -> str:
    """Translates ``one`` or ``many``, as the count needs, which replaces ``{count}`` in it, and ``values`` the rest."""
    if current_language() == ENGLISH:
        return (one if count == 1 else many).format(count=count, **values)
    said = load_catalogue(current_language()).plural(one, many, count)
    return _FORMATTER.vformat(said, (), {"count": count, **values})


def translate_message(text: str) -> str:
    """Translates a :class:`Message` of the solvers, with the messages and numbers among its values; any other text
    stays as it is."""
    if current_language() == ENGLISH or not isinstance(text, Message):
        return text
    return tr(text.template, **{name: localise_numbers(value) if _NUMBERS.fullmatch(value) else translate_message(value)
                               for name, value in text.values.items()})


def lazy(text: str) -> str:
    """Returns a text unchanged, marked for the catalogue; :func:`tr` translates it where it is shown."""
    return text


def language_cache(max_size: int) -> Callable[[Callable[..., T]], Callable[..., T]]:
    """Decorator like :func:`functools.lru_cache` of ``max_size`` results, which are separate for each language."""
    def decorate(work: Callable[..., T]) -> Callable[..., T]:
        @functools.lru_cache(max_size)
        def in_language(_: str, *args: Any, **options: Any) -> T:
            return work(*args, **options)

        return functools.wraps(work)(lambda *args, **options: in_language(current_language(), *args, **options))

    return decorate


def localised_path(path: Path) -> Path:
    """Returns the file beside a path in the current language, ``about.de.html`` for ``about.html``, else the path."""
    own = path.with_suffix(f".{current_language()}{path.suffix}")
    return own if current_language() != ENGLISH and own.is_file() else path


def preferred_language(query: str, accepted: str) -> str:
    """Returns a language's code: from the address's ``query`` ("lang=de"), else Accept-Language (``accepted``)."""
    asked = parse_qs(query[:LONGEST]).get("lang", [""])[-1].lower()
    if asked in LANGUAGES:
        return asked
    return next((code for code in _languages_by_preference(accepted) if code in LANGUAGES), ENGLISH)


def _languages_by_preference(accepted: str) -> list[str]:
    """Returns the codes in a header such as ``de-CH, en;q=0.7`` by preference, without countries: de, en."""
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
