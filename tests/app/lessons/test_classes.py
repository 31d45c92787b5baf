"""Pages for a class are read and checked like lessons: claims, timetables that add up, and time for each core."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from app.cli import main
from app.lessons import catalogue, class_plans
from app.lessons.lesson import LessonError
from app.lessons.lesson_runs import RunCache
from tests.app.lessons.test_lesson_format import use_folder

TEXT = """+++
title = "A class"
minutes = 40
+++

Words.

## Morning

| from | minutes | what |
|--:|--:|:--|
| 0 | 10 | Talk |
| 10 | 30 | Core of [one](../01-one.md) |

## What is checked

```run
hat = "bar cells=8 periods=0.1"
```

```claims
1 + 1 == 2
```
"""
LESSONS = {"01-one": SimpleNamespace(core_minutes=27)}


class NoRuns:
    """Claims that need none."""

    def scope(self, lesson, step, numbers, texts):
        return SimpleNamespace(outcomes={}, main="", paths={}, vocabulary=None)


def wrong(text: str, lessons=LESSONS) -> list[str]:
    """Of a page, the checks that fail."""
    found = list(class_plans.check_class_plan(class_plans.parse_class_plan(text, "morning"), lessons, NoRuns()))
    assert len(found) == 4
    return [str(check) for check in found if not check.holds]


def test_a_page_is_read_and_holds():
    found = class_plans.parse_class_plan(TEXT, "morning")
    rows = [(row.start, row.minutes, row.lesson) for row in found.sessions["Morning"]]
    assert rows == [(0, 10, ""), (10, 30, "01-one")]
    assert [claim.text for step in found.claims.steps for claim in step.claims] == ["1 + 1 == 2"]
    assert wrong(TEXT) == []


@pytest.mark.parametrize("old, new, said", [
    ("== 2", "== 3", "line 22, step \"What is checked\": 1 + 1 == 3: does not hold"),
    ("minutes = 40", "minutes = 90", "line 12, step \"Morning\": the minutes add up to 90: does not hold, found 40"),
    ("| 10 | 30", "| 15 | 30", "line 13, step \"Morning\": begins at 10: does not hold, found 15"),
    ("../01-one.md", "../02-two.md", "line 13, step \"Morning\": 02-two is a lesson: does not hold, there is none")])
def test_what_is_wrong_is_told_with_its_line(old, new, said):
    assert [said in check for check in wrong(TEXT.replace(old, new))] == [True]


@pytest.mark.parametrize("least, fits", [(30, True), (25, True), (31, False), (24, False)])
def test_a_core_gets_its_time_and_a_little_more(least, fits):
    found = wrong(TEXT, {"01-one": SimpleNamespace(core_minutes=least)})
    assert found == [] if fits else f"the core of 01-one has {least} to {least + 5} minutes: does not hold" in found[0]


@pytest.mark.parametrize("old, new, where, said", [
    ('title = "A class"\n', "", "minutes", "title is missing"),
    ("minutes = 40", "minutes = 1.5", "minutes", "give the whole minutes of a session"),
    ("minutes = 40", "minutes = 40\ngoals = []", "goals", "goals is not known in the head of a page for a class"),
    ("| from |", "| at |", "\nWords", "no timetable: give a table with the columns from, minutes, what"),
    ("| 0 | 10 | Talk |", "| 0 | some | Talk |", "| 0 |", "whole minutes"),
    ("```claims", "```teacher", "```teacher", "has no teacher block; it may have run, claims"),
    ("cells=8", "cels=8", "hat =", "did you mean cells?"),
    ("1 + 1", "one.status", "one.status", "neither a run nor part of a result")])
def test_a_mistake_is_told_with_its_line(old, new, where, said):
    text = TEXT.replace(old, new, 1)
    with pytest.raises(LessonError) as mistake:
        class_plans.parse_class_plan(text, "morning")
    assert said in mistake.value.sentence
    assert mistake.value.line == text[:text.index(where)].count("\n") + 1


def test_checks_find_pages_by_name_and_all_where_none_is_given(tmp_path, monkeypatch, capsys):
    (tmp_path / "classes").mkdir()
    (tmp_path / "classes" / "morning.md").write_text(TEXT.replace("[one](../01-one.md)", "one"), encoding="utf-8")
    use_folder(monkeypatch, tmp_path)
    monkeypatch.setattr(RunCache, "prepare", lambda *_: None)
    for names in ([], ["morning"]):
        assert main(["lesson", "check", *names, "--quiet"]) == 0
        assert capsys.readouterr().out == "1 page for a class, 3 checks, 0 failed\n"
    assert main(["lesson", "check", "evening"]) == 2
    assert capsys.readouterr().err.endswith("give one of , morning\n")


def test_there_are_pages_for_one_class_and_for_a_course_of_all_lessons():
    assert class_plans.class_plan_names() == ["ninety-minutes", "three-sessions"]
    one, course = map(class_plans.load_class_plan, class_plans.class_plan_names())
    assert one.minutes == course.minutes == 90 and (len(one.sessions), len(course.sessions)) == (1, 3)
    taken = [[row.lesson for rows in page.sessions.values() for row in rows if row.lesson] for page in (one, course)]
    assert len(taken[0]) == 3
    before = catalogue.load_lessons()
    for k, name in enumerate(taken[1]):  # each after what it needs
        assert set(before[name].prerequisites) <= set(taken[1][:k])
