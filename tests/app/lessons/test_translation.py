"""Lessons in other languages: other words, and nothing else."""

from contextlib import closing
from dataclasses import replace

import pytest

from app.cli import main
from app.language.translation import LANGUAGES, use_language
from app.lessons import catalogue
from app.lessons.grading import grade_file
from app.lessons.lesson import LessonError, draw_numbers
from app.lessons.lesson_runs import RunCache
from app.lessons.student_progress import StudentProgress, parse_progress
from app.page.features.lesson.step_html import head_html, intro_html, lesson_list_html, step_html
from tests.app.lessons.test_lesson_format import TEXT, use_folder

GRID = "04-grid-crossing"
TRANSLATED = [(name, code) for code in LANGUAGES for name in catalogue.lesson_names()
              if (catalogue.FOLDER / f"{name}.{code}.md").is_file()]
GERMAN = TEXT.replace("title = \"A test\"", "title = \"Ein Test\"").replace("What happens?", "Was geschieht?")


def in_language(name, code, folder=catalogue.FOLDER):
    with use_language(code):
        return catalogue.load_lesson(name, folder)


@pytest.fixture
def folder(tmp_path):
    """With one lesson, in two languages."""
    (tmp_path / "01-test.md").write_text(TEXT, encoding="utf-8")
    (tmp_path / "01-test.de.md").write_text(GERMAN, encoding="utf-8")
    return tmp_path


@pytest.mark.parametrize("name, code", TRANSLATED)
def test_a_translation_is_the_same_lesson_in_other_words(name, code):
    original, own = catalogue.load_lesson(name), in_language(name, code)
    assert (own.name, own.fingerprint, own.language) == (name, original.fingerprint, code)
    assert own.variants == original.variants
    for step, other in zip(own.steps, original.steps, strict=True):
        assert (step.key, step.kind, bool(step.notes)) == (other.key, other.kind, bool(other.notes))
        assert step.title != other.title and (step.text != other.text or not step.text)
        assert [run.texts for run in step.runs] == [run.texts for run in other.runs] and step.stage == other.stage
        assert [claim.text for claim in step.claims] == [claim.text for claim in other.claims]
        if step.question:
            assert replace(step.question, line=0, options=()) == replace(other.question, line=0, options=())
            assert not set(step.question.options) & set(other.question.options)
    figures = [line for step in own.steps for line in step.text.splitlines() if line.startswith("![")]
    assert all(f".{code}." in line for line in figures)


@pytest.mark.parametrize("before, after, said", [
    ("in 1..3", "in 1..4", "the claims"), ("cells=8,16", "cells=8,20", "the runs"),
    ("A = 0.03", "A = 0.04", "the variants of the head"),
    ("## Observe: And", "## Predict: And", "the kinds of the steps, or which are core,"),
    ("unit = \"m\"", "unit = \"mm\"", "the question")])
def test_a_translation_that_changes_more_than_words_is_refused(folder, before, after, said):
    assert before in GERMAN
    (folder / "01-test.de.md").write_text(GERMAN.replace(before, after), encoding="utf-8")
    with pytest.raises(LessonError, match=f"01-test.de.md, line .*{said} differ from 01-test.md"):
        in_language("01-test", "de", folder)
    with use_language("de"):
        assert catalogue.load_lessons(folder)["01-test"].title == "A test"  # the page has it in English then


def test_a_mistake_in_a_translation_is_told_and_the_original_is_checked(folder, monkeypatch, capfd):
    (folder / "01-test.de.md").write_text(GERMAN.replace("## Explain: Why", "## Explain"), encoding="utf-8")
    use_folder(monkeypatch, folder)
    assert main(["lesson", "check", "--quiet", "--variants", "1"]) == 2
    said = capfd.readouterr()
    assert said.err.startswith("mpm-lab: 01-test.de.md, line") and said.out.startswith("1 lesson, ")
    assert said.out.endswith("1 file could not be read\n")


def test_a_translation_is_no_lesson_of_its_own(folder):
    assert catalogue.lesson_names(folder) == list(catalogue.load_lessons(folder)) == ["01-test"]
    with use_language("de"):
        assert catalogue.load_lessons(folder)["01-test"].title == "Ein Test"
    assert catalogue.load_lessons(folder)["01-test"].title == "A test"
    assert [lesson.file_stem for lesson in catalogue.load_every_language("01-test", folder)] == ["01-test",
                                                                                                 "01-test.de"]


@pytest.mark.parametrize("written, graded_in", [("de", "en"), ("en", "de")])
def test_what_is_handed_in_is_graded_in_any_language(written, graded_in):
    """By a question that needs no run."""
    lesson, key = in_language(GRID, written), "where-does-the-trouble-begin"
    handed = StudentProgress(lesson.name, lesson.fingerprint, "Ada")
    handed.record(key, 3.125, 1.0)
    with use_language(graded_in), closing(RunCache()) as outcomes:
        found = parse_progress(handed.text(), catalogue.load_lessons().get)
        row = grade_file("ada.json", found, catalogue.load_lessons()[GRID], outcomes)
    assert row.points == 1 and row.progress.fingerprint == row.lesson.fingerprint
    assert draw_numbers(lesson, "Ada") == draw_numbers(row.lesson, "Ada")


def test_a_lesson_that_is_in_english_only_says_so():
    with use_language("de"):
        own, other = (catalogue.load_lesson(name) for name in (GRID, "03-order"))
        assert "nur auf Englisch" in intro_html(other, other.variants[0], False)
        assert "nur auf Englisch" not in intro_html(own, own.variants[0], False)
        assert " lang='en'>" in head_html(other, StudentProgress("", "")) and "Einführung" in head_html(
            own, StudentProgress("", "")
        )
        assert lesson_list_html(catalogue.load_lessons()).count("lang='en'") == len(catalogue.lesson_names()) - len(
            TRANSLATED
        )
    assert "lang=" not in lesson_list_html(catalogue.load_lessons()) + intro_html(other, other.variants[0], False)


def test_what_a_text_tells_to_do_is_a_button_in_its_own_words():
    with use_language("de"):
        own, other = (catalogue.load_lesson(name) for name in (GRID, "03-order"))
        shown = [step_html(lesson, step, lesson.variants[0], "", False) for lesson in (own, other)
                 for step in lesson.steps if step.stage]
    assert any("Setze <b>Zellen</b> auf <b>80</b></button>" in html for html in shown)
    assert any(">Auf die Bühne</button>" in html for html in shown)
    assert any(">On the stage</button>" in html for html in shown)
    assert all("lang='en'" in html for html in shown if ">On the stage<" in html)


def test_a_guide_is_in_the_language_that_is_asked_for(folder, monkeypatch, tmp_path):
    use_folder(monkeypatch, folder)
    out = tmp_path / "guide.html"
    assert main(["lesson", "guide", "1", "--lang", "de", "--out", str(out), "--quiet"]) == 0
    html = out.read_text(encoding="utf-8")
    assert "lang='de'" in html and "Handreichung" in html and "Was geschieht?" in html
