"""Every text of the code is in the catalogue, and has a translation that goes with it."""

import ast
import re

import polib
import pytest

from tests.words import APP, GERMAN, template

CATALOGUE = polib.pofile(str(GERMAN))
TEXTS = {entry.id if isinstance(entry.id, tuple) else (entry.id,) for entry in template() if entry.id}
TOLD_BY = {"tr": 1, "later": 1, "trn": 2}  # how many texts each takes
LEFT_OUT = {"problem"}  # "the same ring": another language says "the same", for its gender
PLACE, TAG = re.compile(r"\{(\w*)[^}]*\}"), re.compile(r"</?\w+")


def test_the_catalogue_has_every_text_translated_and_no_other():
    """``python -m tests.words`` brings it up to date."""
    kept = {(entry.msgid, entry.msgid_plural) if entry.msgid_plural else (entry.msgid,)
            for entry in CATALOGUE if not entry.obsolete}
    assert kept == TEXTS and CATALOGUE.obsolete_entries() == [] and CATALOGUE.fuzzy_entries() == []
    assert [entry.msgid for entry in CATALOGUE.untranslated_entries()] == []


@pytest.mark.parametrize("marks", [PLACE, TAG], ids=["places", "tags"])
def test_a_translation_has_the_places_and_tags_of_its_text(marks):
    """Of two forms each those of either: that of one may do without its count. And a sentence of the solvers, which is
    made in English, may have an ending in a place of its own, for which another language has no use."""
    wrong = []
    for entry in CATALOGUE:
        asked = [sorted(marks.findall(text)) for text in (entry.msgid, entry.msgid_plural) if text]
        said = [sorted(marks.findall(text)) for text in entry.msgstr_plural.values() or [entry.msgstr]]
        heard = all(place.startswith("solvers/") for place, _ in entry.occurrences)
        less = [heard or set(asked[0]) - set(one) <= LEFT_OUT for one in said]
        wrong += [entry.msgid for one, may in zip(said, less, strict=True)
                  if one not in asked and not (may and set(one) <= set(asked[0]))]
    assert wrong == []


def test_no_text_is_where_it_is_not_looked_for():
    """The words are found by their tokens, and some Pythons have none within an f-string; nor are they found within a
    template of JavaScript."""
    said = {tuple(argument.value for argument in call.args[:TOLD_BY[call.func.id]]): path.name
            for path in APP.rglob("*.py") for call in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
            if isinstance(call, ast.Call) and isinstance(call.func, ast.Name) and call.func.id in TOLD_BY
            and all(isinstance(one, ast.Constant) for one in call.args)}
    said |= {(text,): path.name for path in APP.rglob("*.js")
             for text in re.findall(r"\btr\(\"((?:[^\"\\]|\\.)*)\"", path.read_text(encoding="utf-8"))}
    assert {text: place for text, place in said.items() if text not in TEXTS} == {}
