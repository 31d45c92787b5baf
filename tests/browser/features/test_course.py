"""Lessons in a course's own system, in a real browser: SCORM 1.2 by a system that takes it to the letter."""

import io
import re
import zipfile
from pathlib import Path

import pytest

from app.export.lesson_export import make_scorm_package
from app.export.recording import record_scene
from app.lessons.lesson import draw_numbers
from app.lessons.lesson_parser import parse_lesson
from tests.app.lessons.test_lesson_format import TEXT
from tests.browser import courses
from tests.browser.driving import until

SYSTEM = Path(__file__).with_name("scorm12.js").read_text(encoding="utf-8")
HEAD = '+++\ntitle = "Öl & <words>"\ngoals = ["see"]\n+++\n\nBegin.\n'
ASKED = "\n## Observe: {}\n\n```question\n{}\n```\n"
KINDS = {"Drag": 'kind = "drag"\ncontrol = "cells"\nexpected = "20"', "Between": 'kind = "interval"\nexpected = "1e-7"',
         "Number": 'kind = "number"\nexpected = "-2.5e-9"\nunit = "m"', "First words": 'kind = "text"',
         "Second words": 'kind = "text"', "Third words": 'kind = "text"'}
DEEPER = ASKED.format("In words", KINDS["First words"]) + "\n## Explain: The end of it\n"
LESSONS = [parse_lesson(TEXT.replace("## Predict", "## Predict (core)") + DEEPER, "97-runs"),
           parse_lesson(HEAD + "".join(ASKED.format(*one) for one in KINDS.items()), "98-kinds"),
           parse_lesson(HEAD + "\n## Explain: Only read\n\nNothing is asked.\n", "99-read")]
FILES = [f"{lesson.name}.html" for lesson in LESSONS]
LONG = "Ω" * 500


@pytest.fixture(scope="module")
def packed():
    with pytest.MonkeyPatch.context() as patch:  # a process of their own would take seconds to start
        patch.setattr("app.export.html_file.record_scenes",
                      lambda wanted, *others: [record_scene(one) for one in wanted])
        return make_scorm_package(LESSONS, 1, lambda part, what: None, {})


@pytest.fixture(scope="module")
def system(chromium, packed):
    """The system's page."""
    with courses.course(chromium, packed, SYSTEM) as page:
        yield page


@pytest.fixture
def begin(system):
    """Begins a visit with this record, and opens a file; returns its frame."""
    def begun(file, **record):
        system.evaluate("record => { system.begin(record); system.refuses = ''; }",
                        {name.replace("__", "."): value for name, value in record.items()})
        return courses.opened(system, file)

    yield begun
    courses.closed(system)


def again(system, file):
    """Closes the lesson and comes back with what the system has kept; returns the frame and the record."""
    courses.closed(system)
    record = system.evaluate("system.record")
    # A text is tried in its own letters first, which many systems take.
    assert [fault for fault in system.evaluate("system.faults") if fault[-1].isascii()] == []
    assert system.evaluate("system.state") == "ended"
    calls = [call[0] for call in system.evaluate("system.log")]
    assert (calls[0], calls[-1]) == ("LMSInitialize", "LMSFinish")
    assert calls.count("LMSInitialize") == calls.count("LMSFinish") == 1
    system.evaluate("system.begin(system.record)")
    return courses.opened(system, file), record


@pytest.mark.parametrize("number", range(3))
def test_a_lesson_is_scored_completed_and_resumed(system, begin, number):
    """Begun and ended once a visit; answers are told in the forms of the standard."""
    lesson, file = LESSONS[number], FILES[number]
    frame = begin(file)
    half = len(lesson.steps) // 2 + 1
    courses.walked(frame, half)
    frame, record = again(system, file)
    assert record["core.lesson_status"] == "incomplete" and record["core.lesson_location"] == str(half)
    assert record["core.entry"] == "resume" and re.fullmatch(r"0000:00:\d\d\.00", record["core.total_time"])
    assert f"Step {half} of" in frame.locator("#where").inner_text()
    courses.walked(frame)
    frame, record = again(system, file)
    assert record["core.lesson_status"] == "completed"
    asked = [step for step in lesson.steps if step.question]
    marked = [step for step in asked if step.question.kind != "text"]
    assert (record["core.score.raw"], record["core.score.max"]) == (("100", "100") if marked else ("", ""))
    told = {one["id"]: (one["type"], one["student_response"], one["result"]) for one in record["interactions"]}
    assert list(told) == [step.key for step in asked]
    assert frame.locator("#where").inner_text() == "The end"
    assert "still open" not in frame.locator("#lesson").inner_text()
    if file == FILES[1]:
        assert told == {
            "drag": ("numeric", "20", "correct"), "between": ("fill-in", "0.0000001 to 0.0000001", "correct"),
            "number": ("numeric", "-0.0000000025", "correct"), **dict.fromkeys(
                ("first-words", "second-words", "third-words"), ("fill-in", "in words", "neutral"))}


def test_a_wide_interval_and_a_wrong_answer_lower_the_score_until_it_is_right(system, begin):
    """A factor of ten between an interval's ends costs a half, as where answers are graded."""
    frame = begin(FILES[1])
    courses.walked(frame, 2)
    for box, end in zip(frame.get_by_role("textbox").all(), ("3e-8", "3e-7"), strict=True):
        box.fill(end)
    frame.locator("button", has_text="my ").click()
    assert system.evaluate("system.record['core.score.raw']") == "50"  # one and a half of three
    frame.get_by_role("button", name="Next →").click()
    for value, raw in (("7", "50"), ("-2.5e-9", "83.33")):
        write(frame, value)
        assert system.evaluate("system.record['core.score.raw']") == raw
    results = [one["result"] for one in system.evaluate("system.record.interactions")]
    assert results[-2:] == ["wrong", "correct"]


def test_the_core_alone_is_a_lesson_completed(system, begin):
    """And stays so where one goes deeper, begins anew or has passed before."""
    frame = begin(FILES[0])
    frame.get_by_label("Core only").check()
    courses.walked(frame)
    frame, record = again(system, FILES[0])
    assert (record["core.lesson_status"], record["core.score.raw"]) == ("completed", "100")
    assert [one["id"] for one in record["interactions"]] == ["what-happens", "and"]
    frame.get_by_role("button", name="Go deeper").click()
    _, record = again(system, FILES[0])
    assert (record["core.lesson_status"], record["core.score.raw"]) == ("completed", "100")
    courses.closed(system)
    courses.walked(begin(FILES[0], core__lesson_status="passed", core__score__raw="80"), 2)
    frame, record = again(system, FILES[0])
    assert (record["core.lesson_status"], record["core.score.raw"]) == ("passed", "80")
    system.once("dialog", lambda dialog: dialog.accept())
    courses.walked(frame)
    frame.get_by_role("button", name="Begin anew").click()
    _, record = again(system, FILES[0])
    assert (record["core.lesson_status"], record["core.score.raw"]) == ("passed", "100")


def test_a_name_of_the_system_draws_the_numbers(system, begin):
    name = "李, 小龍"
    frame = begin(FILES[0], core__student_name=name)
    numbers = draw_numbers(LESSONS[0], name)
    assert frame.get_by_label("Your name").input_value() == name and frame.get_by_label("Your name").is_disabled()
    assert f"Begin with A = {numbers['A']}." in frame.locator("#lesson").inner_text()
    variant = LESSONS[0].variants.index(numbers)
    courses.walked(frame, 4, variant)
    courses.closed(system)
    system.evaluate("name => system.begin({...system.record, 'core.student_name': name})", "Somebody, Else")
    frame = courses.opened(system, FILES[0])  # a name that has changed since leaves the numbers of the answers
    assert "Step 4 of" in frame.locator("#where").inner_text()
    frame.get_by_role("button", name="← Back").click()
    assert f"amplitude={numbers['A']}" not in frame.locator("#lesson").inner_text()
    courses.walked(frame, 4, variant)
    assert system.evaluate("system.record['core.score.raw']") == "100"


def write(frame, *answers):
    for text in answers:
        frame.get_by_role("textbox").fill(text)
        frame.locator("button", has_text="my ").click()


def test_long_texts_in_any_letters_come_back(system, begin):
    frame = begin(FILES[1])
    courses.walked(frame, 4)
    written = "So & so -\n\"quoted\" \\ ünï 𝒙 &-" + "δ" * 300
    write(frame, LONG, written)
    frame, record = again(system, FILES[1])
    assert len(record["suspend_data"]) < 4096 and record["suspend_data"].isascii()
    assert frame.get_by_role("textbox").input_value() == written
    assert record["interactions"][-1]["student_response"].startswith("So & so - \"quoted\" \\ ?n? ? &-???")


def test_what_the_system_has_no_room_for_is_told(system, begin):
    frame = begin(FILES[1])
    courses.walked(frame, 4)
    for _ in range(3):
        write(frame, LONG, LONG.lower())
        frame.get_by_role("button", name="Next →").click()
    said = frame.locator("#course")
    assert "saves only 4096 characters" in said.inner_text() and '"Third words"' in said.inner_text()
    frame, record = again(system, FILES[1])
    assert len(record["suspend_data"]) <= 4096 and record["core.lesson_status"] == "completed"
    # Two of three last wordings of 500 letters have room, which take 8 characters for 3 letters.
    assert frame.locator(".compared").inner_text().count(LONG.lower()) == 2
    assert "1 question is still open" in frame.locator("#lesson").inner_text()


def test_a_system_that_keeps_nothing_is_told_to_the_student(system, begin):
    frame = begin(FILES[1])
    said = frame.locator("#course")
    for what in ("commit", "suspend_data"):
        system.evaluate("what => { system.refuses = what; }", what)
        frame.get_by_role("button", name="Next →").click()
        assert "did not save your last answers" in said.inner_text()
        system.evaluate("system.refuses = ''")
        frame.get_by_role("button", name="← Back").click()
        assert said.inner_text() == ""


def test_another_lesson_begins_anew_and_says_so(system, begin):
    frame = begin(FILES[0], suspend_data='["0123456789abcdef","",0,[0,2,1,3]]', core__lesson_location="3")
    assert frame.locator("#where").inner_text() == "Introduction"
    assert "changed since your last visit" in frame.locator("#course").inner_text()
    courses.closed(system)
    frame = begin(FILES[0], suspend_data="rubbish", core__lesson_location="x")
    assert frame.locator("#where").inner_text() == "Introduction"


def test_looking_again_changes_nothing(system, begin):
    frame = begin(FILES[1], core__lesson_mode="review", core__lesson_status="completed")
    courses.walked(frame)
    assert "new answers are not saved" in frame.locator("#course").inner_text()
    courses.closed(system)
    assert not [call for call in system.evaluate("system.log") if call[0] == "LMSSetValue"]
    assert system.evaluate("system.state") == "ended"


def framed(file, levels):
    """The address of a file in so many frames, of another origin every second one."""
    inner = f"{courses.COURSE}/package/{file}"
    for level in range(levels):
        inner = f"{(courses.ELSEWHERE, courses.COURSE)[level % 2]}/frame?{inner}"
    return inner


@pytest.mark.parametrize("levels, found", [(6, True), (7, False)])
def test_the_system_is_found_above_frames_of_others(system, levels, found):
    system.evaluate("system.begin({})")
    system.evaluate("address => { document.getElementById('lesson').src = address; }", framed(FILES[2], levels))
    inner = courses.lesson(system)
    for _ in range(levels):
        inner = inner.frame_locator("iframe")
    inner.locator("#where").wait_for()
    until(lambda: ("outside a course" in inner.locator("#course").inner_text()) is not found, "whether it is there")
    assert system.evaluate("system.state") == ("open" if found else "new")
    system.evaluate(courses.CLOSE)
    until(lambda: not inner.locator("#where").count(), "the lesson closed")


def test_the_system_is_found_where_it_has_opened_a_window(system):
    system.evaluate("system.begin({})")
    with system.expect_popup() as opened:
        system.evaluate("file => { window.open('/package/' + file); }", FILES[2])
    opened.value.locator("#where").wait_for()
    assert system.evaluate("system.state") == "open" and opened.value.locator("#course").inner_text() == ""
    opened.value.close(run_before_unload=True)
    until(lambda: system.evaluate("system.state") == "ended", "the window closed")


LATE = "() => { window.late = window.API; delete window.API; }"
COMES = "() => { window.API = window.late; }"


def test_a_system_that_comes_late_gets_what_was_answered_before(system, begin):
    """And a visit goes on where the last one ended, with the answers of both."""
    system.evaluate(LATE)
    frame = begin(FILES[1], core__student_name="Ada")
    courses.walked(frame, 4)
    write(frame, "before")
    assert system.evaluate("system.state") == "new"
    system.evaluate(COMES)
    until(lambda: system.evaluate("system.record['core.score.raw']") == "100", "what was answered is known")
    assert (frame.get_by_role("textbox").input_value(), frame.locator("#course").inner_text()) == ("before", "")
    frame, record = again(system, FILES[1])
    assert [one["id"] for one in record["interactions"]] == ["drag", "between", "number", "first-words"]
    courses.closed(system)
    system.evaluate(LATE)
    system.evaluate("localStorage.clear(); system.begin(system.record)")
    frame = courses.opened(system, FILES[1])
    courses.walked(frame, 2)
    system.evaluate(COMES)
    until(lambda: "Step 4 of" in frame.locator("#where").inner_text(), "it goes on")
    courses.walked(frame)
    frame, record = again(system, FILES[1])
    assert record["core.lesson_status"] == "completed" and record["core.score.raw"] == "100"
    assert [one["id"] for one in record["interactions"]][4:] == ["first-words", "second-words", "third-words"]


def test_a_system_in_the_lessons_own_window_is_found_late(chromium, packed, tmp_path):
    zipfile.ZipFile(io.BytesIO(packed)).extractall(tmp_path)
    page = chromium.new_page()
    page.goto((tmp_path / FILES[1]).as_uri())
    courses.walked(page, 2)
    assert "outside a course" in page.locator("#course").inner_text()
    page.evaluate(f"{{{SYSTEM}; system.begin({{}}); }}")
    until(lambda: page.evaluate("window.system.record['core.score.raw']") == "33.33", "what was answered is known")
    assert page.locator("#course").inner_text() == "" and "Step 2 of" in page.locator("#where").inner_text()
    page.close()


def test_without_a_system_it_plays_and_says_so(chromium, packed, tmp_path):
    zipfile.ZipFile(io.BytesIO(packed)).extractall(tmp_path)
    context = chromium.new_context(offline=True)
    page = context.new_page()
    page.goto((tmp_path / FILES[1]).as_uri())
    assert page.locator("#course").inner_text() == "Opened outside a course: your answers are not reported."
    courses.walked(page)
    page.reload()
    assert page.locator("#where").inner_text() == "The end"
    context.close()
