"""Lessons at the command line, answers and marks: everything that a teacher does without a page."""

from __future__ import annotations

import csv
import io
import json
import math
import re
from dataclasses import replace

import pytest

from app.cli import main
from app.lessons import catalogue, grading
from app.lessons.answer_marking import RightAnswer, format_answer, is_right, mark_answer, why_invalid
from app.lessons.lesson import draw_numbers, fill_numbers
from app.lessons.lesson_parser import parse_lesson
from app.lessons.lesson_runs import RunCache
from app.lessons.student_progress import InvalidProgress, StudentProgress, parse_progress
from app.lessons.teacher_guide import guide_page
from tests.app.lessons.test_lesson_format import TEXT, use_folder

SAVED = TEXT + """
## Predict: Drag

```question
kind = "drag"
control = "cells"
expected = "20"
tolerance = 0.2
```

## Predict: Bet

```question
kind = "interval"
expected = "first(grids.error.x.final)"
```

## Observe: Say

```question
kind = "text"
```
"""
EMPTY = {"schema": "mpm-lab/answers/1", "lesson": "99", "fingerprint": "", "name": "", "step": 0, "answers": {}}


@pytest.fixture
def shelf_of_one(tmp_path, monkeypatch):
    """A folder with one lesson, in the place of ours."""
    (tmp_path / "01-test.md").write_text(SAVED, encoding="utf-8")
    use_folder(monkeypatch, tmp_path)
    return tmp_path / "01-test.md"


@pytest.fixture(scope="module")
def outcomes():
    found = RunCache()
    yield found
    found.close()


def answers(lesson, name="Ada", **given) -> StudentProgress:
    progress = StudentProgress(lesson.name, lesson.fingerprint, name)
    for key, value in given.items():
        progress.record(key.replace("_", "-"), value, 1.5)
    return progress


def test_check_passes_and_fails_with_lesson_step_and_claim(shelf_of_one, capfd):
    assert main(["lesson", "check", "--quiet"]) == 0
    assert "1 lesson, " in capfd.readouterr().out
    shelf_of_one.write_text(shelf_of_one.read_text().replace("in 1..3", "in 4..5"))
    assert main(["lesson", "check", "1", "--quiet", "--variants", "1"]) == 1
    said = capfd.readouterr().err
    assert "01-test, line 29, step \"Look\": order(grids.error.x.max) in 4..5: does not hold, found 2." in said


def test_a_lesson_that_cannot_be_read_keeps_no_other_from_being_checked(shelf_of_one, capfd):
    (shelf_of_one.parent / "02-broken.md").write_text("no head", encoding="utf-8")
    (shelf_of_one.parent / "03-folder.md").mkdir()
    assert main(["lesson", "check", "--quiet", "--variants", "1", "--json", "-"]) == 2
    seen = capfd.readouterr()
    values = json.loads(seen.out)
    assert values["lessons"] == ["01-test"] and values["checks"] and all(check["holds"] for check in values["checks"])
    assert set(values["not_read"]) == {"02-broken", "03-folder"}
    assert [line.partition(", line")[0] for line in seen.err.splitlines()] == [
        "mpm-lab: 02-broken.md", "mpm-lab: 03-folder.md"] and "cannot be read: is a directory" in seen.err
    assert main(["lesson", "list"]) == main(["lesson", "guide", "2"]) == 2
    capfd.readouterr()
    assert main(["lesson", "check", "2", "3", "--quiet"]) == 2
    assert capfd.readouterr().out == "nothing was checked; 2 files could not be read\n"


def test_the_guide_has_notes_and_right_answers(shelf_of_one, tmp_path, capfd):
    assert main(["lesson", "guide", "1", "--quiet"]) == 0
    text = capfd.readouterr().out
    assert "Ask them." in text and "**Answer:** something" in text
    assert main(["lesson", "guide", "1", "--quiet", "--out", str(tmp_path / "guide.html")]) == 0
    page = (tmp_path / "guide.html").read_text()
    assert page.startswith("<!doctype html>") and "<math" in page
    assert not re.search("https?:", page.replace("http://www.w3.org", ""))  # nothing is loaded from elsewhere
    assert "default-src 'none'" in page and "script-src" not in page
    lesson = replace(parse_lesson(SAVED, "01-test"), title="</title><script>", steps=())
    assert "<script" not in guide_page(lesson, None)


def test_marks_are_derived_from_the_runs(outcomes):
    lesson = parse_lesson(SAVED, "01-test")
    steps, numbers = lesson.questions, lesson.variants[1]
    coarse = outcomes.result("bar cells=8 amplitude=0.03 periods=0.1")["error"]["x"]["final"]

    def right(key, answer):
        return mark_answer(lesson, steps[key], answer, numbers, outcomes).right

    assert right("what-happens", 2) and not right("what-happens", 1)
    assert right("and", 1.05 * coarse) and not right("and", 1.2 * coarse)
    assert right("drag", 23) and not right("drag", 25)
    assert right("say", "anything") is None


@pytest.mark.parametrize(("answer", "right"), [(0.905, True), (1.0, True), (1.1, True), (0.895, False), (1.105, False)])
def test_the_tolerance_is_one_of_what_came_out(answer, right):
    asked = next(step.question for step in parse_lesson(SAVED, "01-test").steps if step.key == "drag")
    for sign in (1, -1):
        assert is_right(replace(asked, tolerance=0.1 + 1e-12), sign * answer, RightAnswer("", value=sign)) is right


def test_the_minutes_are_those_of_all_answers():
    lesson = parse_lesson(SAVED, "01-test")
    taken = grading.GradedFile("a.json", answers(lesson, what_happens=2, drag=20.0), lesson, {}, {})
    assert taken.minutes == pytest.approx(2 * 1.5 / 60)


def test_grade_makes_one_table(shelf_of_one, outcomes, tmp_path, capfd):
    lesson = catalogue.load_lesson("01-test")
    hers, his = (outcomes.result(fill_numbers(lesson.runs["grids"].texts[0],
                                              draw_numbers(lesson, name)))["error"]["x"]["final"]
                 for name in ("Ada", "Émile"))
    one = answers(lesson, "Ada", what_happens=2, drag=20.0, bet=[hers / 2, hers * 2],
                  say="=1+1 <img src=x onerror=alert(1)>")
    two = answers(lesson, "Émile", what_happens=1, bet=[5.0, 6.0])
    for k, progress in enumerate((one, two)):
        (tmp_path / f"{k}.json").write_text(progress.text(), encoding="utf-8")
    assert main(["lesson", "grade", str(tmp_path / "0.json"), str(tmp_path / "1.json")]) == 0
    said = capfd.readouterr()
    first, second = csv.DictReader(io.StringIO(said.out))
    assert (first["name"], first["of"], first["same lesson"]) == ("Ada", "4", "yes")
    # A bet that holds and is four times as high as low scores log10 4 = .60, and counts 1 - .60/2; so do two answers 1.
    assert (first["right"], first["bet: score"], first["bet: right"]) == ("2.7", "0.60", "yes")
    assert [first[name] for name in ("intervals", "held", "mean score")] == ["1", "1", "0.60"]
    assert (second["right"], second["bet: right"], second["held"]) == ("0", "no", "0")
    assert first["what-happens: right"] == "yes" and second["what-happens: right"] == "no"
    assert first["say"].startswith("'=1+1 <img") and second["drag"] == ""
    missed = math.log10(6 / 5) + 10 * math.log10(5 / his)
    assert second["bet: score"] == second["mean score"] == f"{missed:.2f}"
    assert "01-test, bet: 1 of 2 intervals hold what came out, 50% where 80% was said; their mean score is " \
           f"{(math.log10(4) + missed) / 2:.2f}, and less is better" in said.err


@pytest.mark.parametrize("text, said", [
    ("", "is no JSON"), ("[" * 5000, "is no JSON"), ("{}", "it has no schema"), ("[]", "it is no object"),
    (json.dumps({**EMPTY, "schema": "x"}), "another version"), (json.dumps(EMPTY), "a lesson that is not here"),
    (json.dumps({**EMPTY, "lesson": 3}), "lesson is of the wrong kind")])
def test_a_file_of_something_else_is_told(text, said, tmp_path, capfd):
    with pytest.raises(InvalidProgress, match=said):
        parse_progress(text, {}.get)
    (tmp_path / "file.json").write_text(text)
    assert main(["lesson", "grade", str(tmp_path / "file.json"), str(tmp_path / "none.json")]) == 1
    told = capfd.readouterr().err
    assert f"{said}" in told and "mpm-lab: file.json: " in told and "none.json: no such file" in told


def test_answers_that_no_question_can_have_are_left_out():
    lesson = parse_lesson(SAVED, "01-test")
    progress = answers(lesson, what_happens=9, drag="20", bet=[1.0], say="x" * 501)
    progress.answers["no-such-step"] = progress.answers["drag"]
    assert parse_progress(progress.text(), {"01-test": lesson}.get).answers == {}
    progress = answers(lesson, drag=20.0)
    progress.record("drag", 30.0, 2.0)
    kept = parse_progress(progress.text(), {"01-test": lesson}.get).answers["drag"]
    assert (kept.first, kept.last, kept.attempts, kept.seconds) == (20.0, 30.0, 2, 3.5)


@pytest.mark.parametrize("key, answer, said", [
    ("what-happens", None, "choose one"), ("what-happens", True, "choose one"), ("and", None, "give a number"),
    ("and", float("nan"), "give a number"), ("bet", [2.0, 1.0], "must not be above"),
    ("bet", [None, 1.0], "two numbers"), ("bet", [0.0, 1.0], "give two numbers above 0: bets are scored by factors"),
    ("say", " ", "write one to 500")])
def test_what_is_no_answer_is_told(key, answer, said):
    lesson = parse_lesson(SAVED, "01-test")
    assert said in why_invalid(lesson.questions[key].question, answer)


def test_answers_in_words():
    lesson = parse_lesson(SAVED, "01-test")
    assert format_answer(lesson.questions["what-happens"].question, 2) == "something"
    assert format_answer(lesson.questions["bet"].question, [0.5, 2.0]) == "0.5 to 2"
    assert format_answer(lesson.questions["and"].question, 1.5) == "1.5 m"


def test_a_prediction_counts_as_it_was_first_made(outcomes):
    lesson = parse_lesson(SAVED, "01-test")
    progress = answers(lesson, what_happens=1)
    progress.record("what-happens", 2, 1.0)
    row = grading.grade_file("file", progress, lesson, outcomes)
    assert row.answers["what-happens"][0] == "nothing" and row.points == 0
