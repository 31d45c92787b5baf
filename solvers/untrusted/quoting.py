"""Safe and short quoting of untrusted text: file names, values, words, table cells; and the error for an invalid file.

A character that does not show, or that tells a terminal or a browser to do something (control, escape and bidirectional
characters, half a surrogate), stands as its escape, ``\\x1b``. What is cut has an ellipsis. One function for each place
where such a text may go: within a sentence, a sentence as a whole, Markdown, HTML, a cell of a CSV.
"""

import csv
import html
import io
import re
from collections.abc import Iterable
from difflib import get_close_matches
from pathlib import PurePath

from solvers.translatable_message import Message
from solvers.untrusted.number_parsing import is_number

QUOTE, SENTENCE, NAME, CELL = 60, 400, 60, 1000  # characters, at most
LONGEST_PATH = 4000  # that any system has
ELLIPSIS = "…"
NOTHING = Message("(no value)")
FORMULA_SIGNS = tuple("=+-@\uff1d\uff0b\uff0d\uff20")  # a spreadsheet would reckon what begins so, also in wide letters
CUTS = re.compile("([;,\t\r\n])")  # where a spreadsheet may begin another cell, also within quotes
MARKDOWN_SIGNS = re.compile(r"([\\`*_\[\]<>$#~])")  # that mean something within a line of Markdown


class FileError(ValueError):
    """Error for a file that cannot be read or judged: ``file`` is its name, ``sentence`` says why, made of a
    ``template`` with {places} for ``values``."""

    def __init__(self, file: str, template: str, /, *values: object):
        message = Message(template, *values)
        self.file, self.sentence = file, one_line(message)
        super().__init__(one_line(Message("{file}: {message}", quote(file), message)))

    @staticmethod
    def from_os_error(file: str, error: Exception) -> "FileError":
        """Returns the error for a file that the system does not open or read, with the system's reason."""
        why = quote((getattr(error, "strerror", None) or str(error)).lower())
        return FileError(file, "cannot be read: {why}; give a file that exists and may be read", why)


def quote(value: object, most: int = QUOTE) -> str:
    """Returns a value for a sentence, on one line of at most ``most`` characters; of a longer one the middle is left
    out, because the end of a name shows its type. An empty one is "(no value)"."""
    text = _to_text(value)
    return _cut_middle(text, most) if text.strip() else NOTHING


def one_line(value: object, most: int = SENTENCE) -> str:
    """Returns a sentence on one line, cut after ``most`` characters, with escapes for invisible characters."""
    text = _to_text(value)
    shown = _cut_end(_escape_invisible(" ".join(text[:4 * most].split())), most)
    return text if text == shown else shown  # a message stays one


def file_name(path: object, most: int = NAME) -> str:
    """Returns the file name at the end of a path of any system, "the file" if it is empty."""
    return _cut_middle(PurePath(_to_text(path)[-LONGEST_PATH:].replace("\\", "/")).name, most) or Message("the file")


def escape_markdown(value: object, most: int = SENTENCE) -> str:
    """Returns a text on one line, cut after ``most`` characters, with Markdown's signs escaped by backslashes."""
    return MARKDOWN_SIGNS.sub(r"\\\1", one_line(value, most))


def code_span(value: object, most: int = NAME) -> str:
    """Returns a text as inline code of Markdown, in backticks; beyond ``most`` characters its middle is left out."""
    text = _cut_middle(_to_text(value), most)
    fence = "`" * (1 + max(map(len, re.findall("`+", text)), default=0))
    pad = " " if "`" in text or not text.strip() else ""
    return f"{fence}{pad}{text}{pad}{fence}"


def escape_html(value: object, most: int = SENTENCE) -> str:
    """Returns a text on one line, cut after ``most`` characters, with the signs of HTML and quotes escaped."""
    return html.escape(one_line(value, most), quote=True)


def csv_text(rows: Iterable[Iterable[object]]) -> str:
    """Returns rows of cells as a CSV with every text in quotes and none that is a formula (:func:`csv_cell`)."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n", quoting=csv.QUOTE_NONNUMERIC)
    writer.writerows([csv_cell(value) for value in row] for row in rows)
    return out.getvalue()


def csv_cell(value: object) -> object:
    """Returns a value for a cell of a CSV that no spreadsheet takes for a formula: a text gets a ' before what begins
    like one, first or after a separator, and is cut after 1000 characters; other types are unchanged."""
    if not isinstance(value, str):
        return value
    parts = [f"'{part}" if _is_formula(part) else part for part in CUTS.split(value[:CELL + 1])]
    return _cut_end(_escape_invisible("".join(parts)), CELL)


def suggest_word(word: str, known: Iterable[str]) -> str:
    """Returns " (did you mean WORD?)" with the nearest of the known words, for a sentence; "" where none is near."""
    close = get_close_matches(word[:QUOTE], list(known), n=1)
    return Message(" (did you mean {close}?)", close[0]) if close else ""


def _is_formula(part: str) -> bool:
    return part.lstrip(" ").startswith(FORMULA_SIGNS) and not all(map(is_number, part.split()))


def _to_text(value: object) -> str:
    """Returns a value as text; for an int of more digits than Python converts, a description instead."""
    try:
        return f"{value:.12g}" if isinstance(value, float) else str(value)
    except ValueError:
        return Message("a number of more than {value:,} digits", 10**3)


def _escape_invisible(text: str) -> str:
    if text.isprintable():
        return text
    return "".join(letter if letter.isprintable() else letter.encode("unicode_escape").decode() for letter in text)


def _cut_middle(text: str, most: int) -> str:
    shown = _escape_invisible(text if len(text) <= 2 * most else text[:most] + text[-most:])
    half = (most - 1) // 2
    return shown if len(shown) <= most else shown[:most - 1 - half] + ELLIPSIS + shown[-half:]


def _cut_end(text: str, most: int) -> str:
    return text if len(text) <= most else text[:most - 1] + ELLIPSIS
