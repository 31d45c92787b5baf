"""All words that another language must have others for, found in the code of the app and the sentences of the solvers
(:mod:`tests.sentences`): ``python -m tests.words`` puts new ones into
``app/language/de.po``, without a translation, and takes out those that are said no more."""

import ast
import functools
import re
from collections.abc import Iterator
from io import BytesIO

from babel.messages.catalog import Catalog
from babel.messages.extract import extract_from_dir
from babel.messages.pofile import read_po, write_po

from tests.sentences import sentences
from tests.support.paths import ROOT

APP, GERMAN = ROOT / "app", ROOT / "app" / "language" / "de.po"
KEYWORDS = {"tr": None, "trn": (1, 2), "lazy": None}  # of app/language/translation.py, and of the scripts


def words_of_code(file, keywords, comments, options) -> Iterator[tuple]:
    """The words of Python: those within an f-string, too, which Babel's own way sees from Python 3.12 on."""
    for node in ast.walk(ast.parse(file.read())):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in keywords:
            texts = [given.value for given in node.args[:2]
                     if isinstance(given, ast.Constant) and isinstance(given.value, str)]
            if texts:
                yield node.lineno, node.func.id, tuple(texts), []


def words_of_a_template(file, keywords, comments, options) -> Iterator[tuple]:
    """The words of html with places, ``{{"Play"}}``."""
    for number, line in enumerate(file.read().decode().splitlines(), 1):
        for text in re.findall(r"\{\{\"([^\"]+)\"\}\}", line):
            yield number, "tr", text, []


#: What Babel says of a file beside its words, and what differs each time.
PASSING = (b"POT-Creation-Date", b"PO-Revision-Date", b"Last-Translator", b"Language-Team", b"Generated-By",
           b"Report-Msgid-Bugs-To")
METHODS = [("**.py", words_of_code), ("**.js", "javascript"), ("**.html", words_of_a_template)]


@functools.cache
def found() -> tuple[tuple[str | tuple[str, ...], str], ...]:
    """All of them, each with a file in which it stands."""
    said = extract_from_dir(APP, METHODS, keywords=KEYWORDS)
    return (*((text, f"app/{file}") for file, _, text, _, _ in said), *sentences())


def template() -> Catalog:
    """All of them, untranslated; of each the files in which it stands."""
    catalogue = Catalog(project="mpm-lab", charset="utf-8")
    for text, file in found():
        catalogue.add(text, locations=[(file, None)])
    return catalogue


def german() -> Catalog:
    with GERMAN.open("rb") as file:
        return read_po(file, locale="de")


def text_of(catalogue: Catalog) -> bytes:
    """As a file, without what differs from time to time."""
    out = BytesIO()
    write_po(out, catalogue, width=120, sort_output=True, ignore_obsolete=True, include_lineno=False)
    return re.sub(rb'"(%b)[^\n]*\n' % b"|".join(PASSING), b"", out.getvalue())


if __name__ == "__main__":
    german_words = german()
    german_words.update(template(), no_fuzzy_matching=True)
    GERMAN.write_bytes(text_of(german_words))
    missing = sum(not entry.string or not all(entry.string) for entry in german_words if entry.id)
    print(f"{missing} of {len(german_words)} texts have no translation")
