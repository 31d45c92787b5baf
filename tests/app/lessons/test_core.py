"""A lesson's core and its minutes: they are computed, the core stands by itself, and who takes it skips the rest."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest

from app.cli import main
from app.lessons import catalogue, duration, grading
from app.lessons.lesson import (
    CHOICE,
    EXPLAIN,
    OBSERVE,
    PREDICT,
    RUN,
    TEXT,
    Lesson,
    LessonError,
    Question,
    Step,
    draw_numbers,
)
from app.lessons.lesson_parser import parse_lesson
from app.lessons.prediction_rounds_and_core import split_rounds
from app.lessons.student_progress import StudentProgress, parse_progress
from tests.app.lessons.test_lesson_format import TEXT as ROUND

DEEPER = """
## Predict: More of it?

```question
kind = "number"
expected = "fine.error.x.final"
```

## Run: Finer

```run
fine = "bar cells=32 periods=0.1"
```

## Explain: Less

"""
TWO = ROUND.replace("## Predict", "## Predict (core)") + DEEPER
WORDS = " ".join(["word"] * 180)  # a minute of reading
PLAYS = "bar periods=2 speed=0.1 stops"  # for 20 s


@pytest.fixture(scope="module")
def two():
    return parse_lesson(TWO, "two")


def test_a_round_is_of_the_core_as_its_first_step_says(two):
    assert [step.core for step in two.steps] == [True] * 4 + [False] * 3
    assert [len(one) for one in split_rounds(two.steps)] == [4, 3]
    assert two.optional_steps == two.steps[4:]
    assert two.steps_to_take(core=True) == two.steps[:4] and two.steps_to_take(core=False) == two.steps
    plain = parse_lesson(ROUND + DEEPER, "plain")
    assert plain.optional_steps == () and plain.steps_to_take(core=True) == plain.steps
    assert [step.key for step in two.steps] == [step.key for step in plain.steps]  # a mark is not part of the title


@pytest.mark.parametrize("old, new, where", [("status == ok", "fine.status == ok", "fine.status"),
                                             ('"first(grids', '"fine.error.x.final + first(grids', 'kind = "number"')])
def test_the_core_needs_no_run_of_a_deeper_step(old, new, where):
    text = TWO.replace(old, new, 1)
    with pytest.raises(LessonError, match="the core needs the run fine of the deeper step in line") as mistake:
        parse_lesson(text, "two")
    assert mistake.value.line == text[:text.index(where)].count("\n") + 1


def test_a_deeper_step_may_need_a_run_of_the_core():
    assert parse_lesson(TWO.replace("fine.error.x.final", "first(grids.error.x.final)"), "two").optional_steps


def test_who_takes_the_core_goes_past_what_is_deeper(two):
    """Forwards and backwards, from anywhere; the introduction and the end are there for all."""
    first = replace(two, steps=two.steps[4:] + two.steps[:4])  # the deeper round first
    end = len(two.steps) + 1
    assert [two.neighbour_step(at, 1, core=True) for at in (0, 3, 4, 6, end)] == [1, 4, end, end, end]
    assert [two.neighbour_step(at, -1, core=True) for at in (end, 6, 1, 0)] == [4, 4, 0, 0]
    assert [first.neighbour_step(0, 1, core=True), first.neighbour_step(4, -1, core=True)] == [4, 0]
    assert [two.neighbour_step(at, by, core=False) for at, by in ((0, 1), (4, 1), (end, -1), (1, -1))] == [1, 5, 7, 0]


def lesson(*steps: Step, intro: str = "") -> Lesson:
    return duration.with_minutes(Lesson("l", "L", (), (), intro=intro, steps=steps))


def step(kind: str = RUN, text: str = "", **more) -> Step:
    return Step(kind, "", f"{len(text)}", 1, text, **more)


@pytest.mark.parametrize("text, stage, seconds", [
    (WORDS, "", 60), (f"| {WORDS} |\n|:--|", "", 60), ("`norm of true / norm of pinned`", "", 1 / 3),
    (r"$\frac{h}{2}$", "", 1), (r"$$e \approx C\,h^2$$", "", 20), ("![a long text to read](figures/a.svg)", "", 30),
    ("- Press **Forward**.", "", 10 + 2 / 3), ("Take **5 minutes** to try.", "", 300 + 5 / 3),
    ("- Press **On the stage**.", PLAYS, 10 + 4 / 3 + 20 + 10), ("", PLAYS, 20 + 10), ("", "bar periods=2", 30),
    ("- Set **Cells** to `80`.", PLAYS, 10 + 4 / 3 + 2 * (20 + 10)),
    ("- Choose **Error of** `stress σ`.", PLAYS, 10 + 4 / 3 + 20 + 10)])
def test_what_a_step_takes(text, stage, seconds):
    """Beyond turning the page. A word is a third of a second."""
    found = step(text=text, stage=stage)
    assert duration.seconds_of_rounds((found,), lesson(found)) - duration.TURN_SECONDS == pytest.approx(seconds)


def test_a_run_that_is_only_offered_is_not_counted():
    found = step(EXPLAIN, stage=PLAYS)
    assert duration.seconds_of_rounds((found,), lesson(found)) == duration.TURN_SECONDS


def test_thinking_takes_longer_than_telling_and_what_is_compared_counts():
    asked = Question(CHOICE, 1, options=("one word", "two words"))
    predict, observe, explain = step(PREDICT, question=asked), step(OBSERVE, question=asked), step(EXPLAIN)

    def seconds(*steps):
        spent = duration.seconds_of_rounds(steps, lesson(*steps))
        return spent - len(steps) * duration.TURN_SECONDS - len(steps[:2]) * 4 / 3

    assert seconds(predict, predict) == pytest.approx(120) and seconds(observe, observe) == pytest.approx(60)
    assert seconds(predict, observe, explain) == pytest.approx(60 + 30 + 2 * 10)
    assert all(duration.PREDICTING[kind] >= duration.TELLING[kind] for kind in duration.PREDICTING)


def test_minutes_are_whole_and_told():
    deep = step(text=WORDS, core=False)
    found = lesson(step(text=f"{WORDS} {WORDS}"), deep, intro=WORDS)
    assert (found.core_minutes, found.minutes) == (3, 4)
    assert duration.minutes_text(found) == "3 min core, 4 min in all"
    assert duration.minutes_text(lesson(deep)) == "1 min core, 1 min in all"
    assert duration.minutes_text(lesson(step(text=WORDS))) == "1 min"


@pytest.mark.parametrize("name", catalogue.lesson_names())
def test_the_core_of_our_lessons_is_some_twenty_minutes_and_stands_by_itself(name):
    """It looks back upon nothing that is deeper by its title; and no text of a lesson says minutes of its own."""
    found = catalogue.load_lesson(name)
    assert 15 <= found.core_minutes <= 25 and found.core_minutes <= found.minutes
    core = "\n".join((found.intro, *(f"{step.title}\n{step.text}" for step in found.steps_to_take(core=True))))
    assert not any(step.title in core for step in found.optional_steps if len(step.title) > 20)
    assert not re.search(r"\b(last|first|second|third|fourth) (round|part) of this lesson|deeper", core)
    notes = "\n".join((found.notes, *(step.notes for step in found.steps)))
    assert not re.search(r"\b(\d+|ten|twenty) min(utes)?\b", notes)
    assert draw_numbers(found, "Ada") == draw_numbers(replace(found, steps=found.steps_to_take(core=True)),
                                                      "Ada")  # a student's numbers


def test_which_is_told_by_the_list(capsys):
    assert main(["lesson", "list"]) == 0
    lines = capsys.readouterr().out.splitlines()
    for line, found in zip(lines, catalogue.load_lessons().values(), strict=True):
        core = f"{found.core_minutes} min core, {found.minutes} min in all" if found.optional_steps else \
            f"{found.minutes} min"
        assert f"  {core}  " in line and line.endswith(f"  {found.title}")


def test_whether_the_core_is_taken_is_kept_and_an_older_file_still_reads(two):
    find = {"two": two}.get
    assert parse_progress(StudentProgress("two", two.fingerprint, core=True).text(), find).core is True
    old = StudentProgress("two", two.fingerprint, core=True).text().replace(', "core": true', "")
    assert '"core"' not in old and parse_progress(old, find).core is False
    assert parse_progress(old.replace('"step"', '"core": "yes", "step"'), find).core is False
    whole = parse_lesson(ROUND, "whole")  # where nothing is deeper there is nothing to skip
    assert parse_progress(StudentProgress("whole", "", core=True).text(), {"whole": whole}.get).core is False


class NoRuns:
    """Nothing is marked that needs a run."""


def test_of_the_core_alone_its_questions_count(two):
    """Answered or not; what was answered beyond them is neither marked nor in the table."""
    said = Step(OBSERVE, "", "said", 1, question=Question(TEXT, 1))
    asked = replace(two, steps=(said, replace(said, key="more", core=False), *two.steps[4:]))
    progress = StudentProgress("two", two.fingerprint, "Ada", core=True)
    for key in ("said", "more"):
        progress.record(key, "words", 1.0)
    core, every = (grading.grade_file("file", progress, asked, NoRuns(), core) for core in (True, False))
    assert (core.maximum, every.maximum) == (0, 1)
    assert list(core.answers) == ["said"] and list(every.answers) == ["said", "more"]
    head, row = grading.grades_csv([core]).splitlines()
    assert head.endswith('"core only","file","said","said: right"') and row.endswith('"yes","file","words",""')


def test_the_guide_says_what_is_deeper_or_leaves_it_out(monkeypatch, capsys):
    """Of lesson 6, which has two deeper rounds; the right answers are not run here."""
    monkeypatch.setattr("app.lessons.teacher_guide._right_answer_text", lambda *_: "42")
    found = catalogue.load_lesson("06-ring")
    title = found.optional_steps[0].title
    assert main(["lesson", "guide", "6", "--quiet"]) == 0
    text = capsys.readouterr().out
    assert title in text and text.count("*Deeper: this round is not part of the core and takes") == 2
    assert duration.minutes_text(found) in text and text.count("*This round takes") == 3
    assert main(["lesson", "guide", "6", "--quiet", "--core"]) == 0
    text = capsys.readouterr().out
    assert title not in text and "*Deeper" not in text
    assert f"the core, which takes {found.core_minutes} minutes" in text
    assert "mpm-lab serve --lesson 06-ring --core" in text and "mpm-lab lesson grade FILES --core" in text


def test_minutes_are_the_nearest_and_never_none():
    assert [duration.whole_minutes(seconds) for seconds in (5, 89, 91, 149, 151)] == [1, 1, 2, 2, 3]
