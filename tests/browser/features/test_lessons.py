"""Lessons and links in the real page: played from start to hand-in, kept over a reload, marked again by the command."""

import csv
import json

import pytest

from app.cli import main
from app.lessons import catalogue
from app.lessons.lesson import OBSERVE, PREDICT, TEXT
from app.lessons.student_progress import StudentProgress
from tests.browser.conftest import PHONE, serving, visit
from tests.browser.driving import again_until, click, downloaded, scene, shown, unfold, until
from tests.browser.following import answer, follow, go_on

NAME = "05-who-is-to-blame"  # one question of each kind that a browser may get wrong: choices, numbers and free text
SHORT = "02-what-is-an-error"  # without free text, in a third of the time
STAGED = 3  # steps at first that are put on the stage, too: each starts its run, which no answer waits for
HOSTILE = "<img src=x onerror=\"document.title='stolen'\">"


@pytest.fixture(scope="module")
def class_room():
    """A server that opens everyone on the lesson."""
    with serving(arguments=("--lesson", NAME)) as one:
        yield one


@pytest.fixture(params=[SHORT, pytest.param(NAME, marks=pytest.mark.slow)])
def lesson_page(request):
    """The address of a server that opens everyone on a lesson, and the lesson."""
    with serving(arguments=("--lesson", request.param)) as one:
        yield one[0], catalogue.load_lesson(request.param)


def address(page):
    return page.evaluate("location.href")  # the driver's own notion lags behind


def at_step(page, number, lesson):
    where = f"step {number} of {len(lesson.steps)}"
    until(lambda: where in page.locator(".lab-lesson-head").inner_text(), where)


def put_on_stage(page):
    """Press the step's button; the curtain before the stage has it, too."""
    page.locator(".lab-lesson").get_by_role("button", name="On the stage", exact=True).click()


def play(page, lesson, first, last):
    """Go through the steps from the one numbered ``first`` on, which is shown."""
    for number in range(first, last + 1):
        step = lesson.steps[number - 1]
        at_step(page, number, lesson)
        if step.stage and number <= first + STAGED:
            put_on_stage(page)
        if step.question:
            following = page.get_by_role("button", name="Next", exact=True)
            if step.kind in (PREDICT, OBSERVE):
                assert following.is_disabled()
            answer(page, step, HOSTILE if step.question.kind == TEXT else "1e-3")
            until(following.is_enabled, "the way on")
        for unfinished, where in (("checked", ".lab-recorded"), ("being worked out", ".lab-compared")):
            until(lambda: not any(unfinished in said for said in page.locator(where).all_inner_texts()),  # noqa: B023
                  "what is being worked out", 60)  # the viewer warns of what comes for a step that is left
        go_on(page)


def test_a_lesson_from_start_to_hand_in(lesson_page, chromium, tmp_path, capfd):
    address, lesson = lesson_page
    half = len(lesson.steps) // 2
    with visit(chromium, address) as page:
        until(page.locator(".lab-lesson-head").is_visible, "the lesson")
        page.get_by_label("Your name").fill("Ada <b>")
        page.wait_for_timeout(400)
        go_on(page)
        play(page, lesson, 1, half)
        at_step(page, half + 1, lesson)
        page.reload()
        until(page.locator(".lab-lesson-head").is_visible, "the lesson again")
        play(page, lesson, half + 1, len(lesson.steps))
        shown(page, "The end")
        until(lambda: "being worked out" not in page.locator(".lab-compared").last.inner_text(), "all marks", 60)
        signs = page.locator(".lab-compared").last.locator("tr td:last-child").all_inner_texts()
        asked = any(step.question.kind == TEXT for step in lesson.questions.values())
        assert (HOSTILE in page.locator(".lab-compared").last.inner_text()) == asked
        assert page.title() == "mpm-lab" and page.locator("img[src=x]").count() == 0
        file = downloaded(page, lambda: click(page, "Hand in"))
        file.save_as(tmp_path / "ada.json")
        assert file.suggested_filename == f"{lesson.name}-Ada-b.json"
    saved = json.loads((tmp_path / "ada.json").read_text(encoding="utf-8"))
    assert saved["name"] == "Ada <b>" and saved["answers"].keys() == lesson.questions.keys()
    assert main(["lesson", "grade", str(tmp_path / "ada.json")]) == 0
    [row] = csv.DictReader(capfd.readouterr().out.splitlines())
    marks = [row[f"{key}: right"] for key in lesson.questions]
    predicted = [mark for mark, step in zip(marks, lesson.questions.values(), strict=True) if step.kind == PREDICT]
    said = [{"✓": "yes", "✗": "no"}.get(sign.strip(), "") for sign in signs]
    assert said == marks and {"yes", "no"} >= set(predicted)


@pytest.mark.slow
def test_the_core_is_taken_alone(class_room, chromium):
    """From a deeper step one goes past all that is deeper; it outlives a reload."""
    lesson = catalogue.load_lesson(NAME)
    deeper = lesson.steps.index(lesson.optional_steps[0]) + 1
    begun = StudentProgress(NAME, lesson.fingerprint, step=deeper).text()
    keep = f"localStorage['mpm-lab/{NAME}'] ||= {json.dumps(begun)};"
    with visit(chromium, class_room[0], script=keep) as page:
        head, count = page.locator(".lab-lesson-head"), len(lesson.steps_to_take(core=True))

        def at(said):
            until(lambda: head.is_visible() and said in head.inner_text(), said)

        at(f"step {deeper} of {len(lesson.steps)}")
        assert page.locator(".lab-kind-deeper").inner_text() == "deeper"
        assert page.locator(".lab-segments .lab-deep").count() == len(lesson.optional_steps)
        click(page, "Core only: skip what is deeper")
        at(f"step {deeper} of {count} of the core")
        until(lambda: page.locator(".lab-kind-deeper").count() == 0, "a step of the core")
        click(page, "Back")
        at(f"step {deeper - 1} of {count} of the core")
        page.reload()
        at(f"step {deeper - 1} of {count} of the core")


def test_a_link_that_means_nothing_is_refused_in_words(server, chromium):
    with visit(chromium, server[0], query="#bar;cells=2;amplitude=9") as page:
        until(lambda: "The link cannot be followed: " in page.locator(".lab-notice").inner_text(), "the refusal")
        assert scene(page)["cells"] == 40


@pytest.mark.slow
def test_a_lessons_controls_stand_below_its_text(server, chromium):
    """Those that it needs; and what its text says to do is a button that does it."""
    lesson = catalogue.load_lesson("04-grid-crossing")
    first = next(k for k, step in enumerate(lesson.steps, 1) if "Set **Cells**" in step.text)
    with visit(chromium, server[0], f"#lesson={lesson.name}") as page:
        until(page.locator(".lab-lesson-head").is_visible, "the lesson")
        until(page.get_by_text("Cells", exact=True).is_visible, "its controls")
        assert "cells" in lesson.controls and "modulus" not in lesson.controls
        assert not page.get_by_text("Modulus E", exact=True).is_visible()
        go_on(page)
        play(page, lesson, 1, first - 1)
        at_step(page, first, lesson)
        again_until(lambda: put_on_stage(page), lambda: scene(page)["cells"] == 20, "the step's run")
        again_until(lambda: click(page, "Set Cells to 80"), lambda: scene(page)["cells"] == 80, "what the text says")
        until(lambda: page.get_by_label("Cells, typed").input_value() == "80", "the control that follows")
        page.get_by_role("tab", name="Explore").click()
        until(page.get_by_text("A lesson is open").is_visible, "where the controls are")
        page.get_by_role("tab", name="Lessons").click()
        click(page, "Close the lesson")
        page.get_by_role("tab", name="Explore").click()
        until(page.get_by_text("Modulus E", exact=True).is_visible, "all controls")


@pytest.mark.slow
def test_lessons_are_opened_by_a_finger_with_how_far_one_has_come(class_room, chromium):
    """On a phone, from a list of buttons; chosen answers are said by radio buttons, and the next lesson is offered."""
    lesson = catalogue.load_lesson(NAME)
    with visit(chromium, class_room[0], size=PHONE, touch=True) as page:
        until(page.locator(".lab-lesson-head").is_visible, "the lesson")
        page.get_by_role("button", name="Next", exact=True).tap()
        at_step(page, 1, lesson)
        shut = page.get_by_role("button", name="Close the lesson")
        again_until(lambda: shut.is_visible() and shut.tap(), page.locator(".lab-shelf").is_visible, "the list")
        come = page.locator(f".lab-open[data-lesson='{NAME}'][data-steps] .lab-come")
        until(lambda: come.inner_text() == f"1 of {len(lesson.steps)}", "how far one has come")
        assert page.get_by_role("button", name=f"Continue: {lesson.title}").is_visible()
        other, head = page.locator(".lab-open[data-steps]").nth(1), page.locator(".lab-lesson-head")
        title = catalogue.load_lesson(catalogue.lesson_names()[1]).title
        again_until(lambda: other.is_visible() and other.tap(),
                    lambda: head.is_visible() and title in head.inner_text(), "another")


def test_a_link_can_be_copied_and_shown_as_a_code(own_page):
    page = own_page
    page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    unfold(page, "Your own data")
    click(page, "Copy link")
    assert page.evaluate("navigator.clipboard.readText()") == address(page)
    click(page, "QR code")
    until(page.locator(".lab-code svg").is_visible, "the code")
    shown(page, "mpm-lab run --scene")


@pytest.mark.slow
@pytest.mark.parametrize("name", catalogue.lesson_names())
def test_a_lesson_done_as_it_is_written(name, server, chromium):
    """By a machine that reads nothing but its text: what it reads on the page is what the lesson expects."""
    with visit(chromium, server[0], query=f"#lesson={name}") as page:
        until(page.locator(".lab-lesson-head").is_visible, "the lesson")
        assert follow(page, catalogue.load_lesson(name)) == []
        assert "the end" in page.locator(".lab-lesson-head").inner_text()
