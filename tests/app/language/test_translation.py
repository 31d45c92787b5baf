"""Texts in the language that is spoken: with places and counts, on other threads, kept, and of files; and which one a
browser gets."""

from concurrent.futures import ThreadPoolExecutor

import polib
import pytest

from app.language import translation
from app.language.translation import (
    LANGUAGES,
    Language,
    current_language,
    localised_path,
    tr,
    trn,
    use_language,
    with_language,
)
from app.names_and_units import (
    format_number,
    format_ratio,
    number_format_script,
    parse_size,
    per_cent,
    with_unit,
)

WORDS = {"Play": "Los", "{n} of {all} are here": "von {all} sind {n} da"}


@pytest.fixture
def other(tmp_path, monkeypatch):
    """The code of a language with a few words."""
    file = polib.POFile(wrapwidth=100)
    file.metadata = {"Content-Type": "text/plain; charset=utf-8", "Plural-Forms": "nplurals=2; plural=(n != 1);"}
    for text, said in WORDS.items():
        file.append(polib.POEntry(msgid=text, msgstr=said, occurrences=[("app/page/web/js/a.js", "")]))
    file.append(polib.POEntry(msgid="{count} dot", msgid_plural="{count} dots",
                              msgstr_plural={0: "{count} Punkt", 1: "{count} Punkte"}))
    file.save(str(tmp_path / "zz.po"))
    monkeypatch.setitem(LANGUAGES, "zz", Language("Other", tmp_path / "zz.po"))
    yield "zz"
    translation.load_catalogue.cache_clear()


def test_a_text_is_what_the_language_says_and_english_is_the_code(other):
    assert tr("Play") == "Play" and tr("{n} of {all} are here", n=1, all=3) == "1 of 3 are here"
    with use_language(other):
        assert tr("Play") == "Los" and tr("{n} of {all} are here", n=1, all=3) == "von 3 sind 1 da"
        assert tr("not there") == "not there"
    assert current_language() == "en" and tr("Play") == "Play"


@pytest.mark.parametrize(("count", "english", "said"), [(1, "1 dot", "1 Punkt"), (2, "2 dots", "2 Punkte"),
                                                        (0, "0 dots", "0 Punkte"), (1.5, "1.5 dots", "1.5 Punkte")])
def test_a_count_chooses_its_form(other, count, english, said):
    assert trn("{count} dot", "{count} dots", count) == english
    with use_language(other):
        assert trn("{count} dot", "{count} dots", count) == said


def test_a_thread_speaks_what_was_spoken_where_its_work_was_given_to_it(other):
    with ThreadPoolExecutor(1) as thread, use_language(other):
        assert thread.submit(current_language).result() == "en"
        assert thread.submit(with_language(tr), "Play").result() == "Los"
        assert thread.submit(with_language(tr, "en"), "Play").result() == "Play"
        assert thread.submit(current_language).result() == "en"


def test_what_is_kept_is_kept_by_language(other):
    asked = []

    @translation.language_cache(4)
    def said(name):
        asked.append(name)
        return tr("Play")

    assert [said("a"), said("a")] == ["Play"] * 2
    with use_language(other):
        assert [said("a"), said("a")] == ["Los"] * 2
    assert asked == ["a", "a"]


def test_a_file_has_its_translation_beside_it_or_stands_for_itself(tmp_path):
    (tmp_path / "about.html").touch()
    assert localised_path(tmp_path / "about.html").name == "about.html"
    with use_language("de"):
        assert localised_path(tmp_path / "about.html").name == "about.html"
        (tmp_path / "about.de.html").touch()
        assert localised_path(tmp_path / "about.html").name == "about.de.html"


def test_numbers_have_the_marks_of_the_language():
    """Also those within a sentence; what is text already, as a command, stays."""
    with use_language("de"):
        assert [with_unit(0.0021, "m"), per_cent(0.064), per_cent(23.0), format_ratio(0.36), format_number(1234.5)] \
            == ["2,1 mm", "6,4 %", "2.300 %", "0,36", "1,23e+03"]
        assert tr("not above {least:g}, as in {command}", least=0.5, command="--cfl 0.5") \
            == "not above 0,5, as in --cfl 0.5"
        assert tr("{cells:,} cells", cells=12_345) == "12.345 cells"  # whole numbers, too
        assert parse_size(with_unit(0.0021, "m"), "m") == 0.0021
        assert '"marks": ",."' in number_format_script()


def test_scripts_get_their_own_words(other):
    assert translation.load_catalogue(other).translations_for_files("app/page/web/js/") == WORDS
    assert (
        translation.load_catalogue(other).translations_for_files("app/export/")
        == translation.load_catalogue("en").translations_for_files("app/")
        == {}
    )


@pytest.mark.parametrize(("query", "accepted", "found"), [
    ("", "", "en"), ("", "de", "de"), ("", "de-CH,de;q=0.9,en;q=0.8", "de"), ("", "fr, en;q=0.5, de;q=0.4", "en"),
    ("", "en;q=0.4,de;q=0.5", "de"), ("", "de;q=0, en", "en"), ("", "fr,nl", "en"), ("", "de;q=x, en", "en"),
    ("lang=de", "en", "de"), ("lang=en", "de", "en"), ("lang=DE&x=1", "", "de"), ("lang=klingon", "de", "de"),
    ("lang=fr&lang=de", "", "de"), ("lang=", "", "en"), ("&&=%ff;lang", ";q=1,,;;q=", "en"),
    ("x" * 10_000 + "&lang=de", "y," * 10_000, "en")])
def test_the_address_goes_first_then_what_the_browser_likes_best(query, accepted, found):
    assert translation.preferred_language(query, accepted) == found
