"""A whole lesson by Tab, arrows, Enter and Space alone, and what a screen reader is told in each kind of its steps: one
visitor walks through it once."""

import itertools
import json
import re

import pytest

from app.lessons import catalogue
from app.lessons.lesson import CHOICE, EXPLAIN, INTERVAL, OBSERVE, PREDICT, RUN
from tests.browser.conftest import axe_finds, visit
from tests.browser.driving import again_until, tab_to, until

pytestmark = pytest.mark.slow

NAME = "03-order"  # choices and numbers, and runs that are soon there
MOST = 80  # presses of Tab from one thing to another; the page has some fifty stops


def press(page, name):
    tab_to(page, name)
    page.keyboard.press("Enter")


def heading(page, title):
    """Wait until the step's heading has the focus: from there on it is read."""
    until(lambda: page.evaluate("document.activeElement.tagName + document.activeElement.textContent") == f"H2{title}",
          f"the focus at {title}")


def answered(page, step):
    """Answer a question; returns what is read out then."""
    for _ in range(MOST):
        page.keyboard.press("Tab")
        kind = page.evaluate("document.activeElement.type || ''")
        if kind == ("radio" if step.question.kind == CHOICE else "text"):
            break
    if step.question.kind == CHOICE:
        page.keyboard.press("Space")
        page.keyboard.press("ArrowDown")
    else:
        page.keyboard.type("1e-3")
        if step.question.kind == INTERVAL:
            page.wait_for_timeout(400)  # the viewer sends what has been typed last, and forgets the box before
            page.keyboard.press("Tab")
            page.keyboard.type("1")
    aloud, button = page.locator("#lab-told"), "Record my prediction" if step.kind == PREDICT else "Check my answer"
    # A text counts a moment after its last letter: until then one is asked for an answer.
    again_until(lambda: press(page, button), lambda: aloud.text_content().startswith("Your answer: "),
                f"the answer to {step.title} read out")
    until(lambda: "checked" not in aloud.text_content(), "what is right read out", 60)
    if step.kind == PREDICT:  # there the button has gone with the question
        until(lambda: "lab-recorded" in page.evaluate("document.activeElement.className"), "the focus at what is said")
    return aloud.text_content()


@pytest.fixture(scope="module")
def walk(server, chromium, tmp_path_factory):
    """What was told in each step, and the file that was handed in."""
    lesson, told = catalogue.load_lesson(NAME), []
    with visit(chromium, server[0]) as page:
        page.get_by_role("tab", name="Explore").focus()
        page.keyboard.press("ArrowRight")
        until(page.locator(".lab-shelf").is_visible, "the shelf")
        tree = page.locator("body").aria_snapshot()
        press(page, lesson.title)
        until(page.locator(".lab-lesson-head").is_visible, "the lesson")
        for step in lesson.steps:
            # What is disabled gets no focus, and it is let go on a moment after the answer has been read out.
            until(page.get_by_role("button", name="Next", exact=True).is_enabled, "the way on")
            press(page, "Next")
            heading(page, step.title)
            if step.kind == RUN:
                press(page, "On the stage")
                until(page.locator(".lab-put.lab-did").count, "the run put on the stage")
            said = answered(page, step) if step.question else ""
            if step.question and step.question.kind != CHOICE:  # a box that is made anew is named a moment later
                until(page.get_by_role("textbox", name=re.compile("^(Answer|At most)")).count, "a name for the box")
            told.append({"step": step, "aloud": said, "tree": page.locator("body").aria_snapshot()})
        faults = axe_finds(page)
        until(page.get_by_role("button", name="Next", exact=True).is_enabled, "the end")
        press(page, "Next")
        heading(page, "The end")
        tab_to(page, "Hand in")
        with page.expect_download() as download:
            page.keyboard.press("Enter")
        path = tmp_path_factory.mktemp("aloud") / "answers.json"
        download.value.save_as(path)
    return {"shelf": tree, "told": told, "handed": json.loads(path.read_text(encoding="utf-8")), "axe": faults}


def test_a_lesson_is_done_by_keyboard_alone(walk):
    lesson = catalogue.load_lesson(NAME)
    assert walk["handed"]["answers"].keys() == lesson.questions.keys()
    assert walk["handed"]["step"] == len(lesson.steps) + 1 and walk["axe"] == []


def test_the_shelf_names_every_lesson(walk):
    for lesson in catalogue.load_lessons().values():
        assert re.search(rf'button ".*{re.escape(lesson.title)}.*{lesson.minutes} min', walk["shelf"]), lesson.title


@pytest.mark.parametrize("kind", [PREDICT, RUN, OBSERVE, EXPLAIN])
def test_every_kind_of_step_is_named(walk, kind):
    """Its place among the steps, its heading below the page's, what it asks with what is chosen, and the way on."""
    steps = [one for one in walk["told"] if one["step"].kind == kind]
    assert steps
    for one in steps:
        tree, step = one["tree"], one["step"]
        assert 'progressbar "progress"' in tree and re.search(r'heading ".*mpm-lab.*" \[level=1\]', tree)
        assert f'heading "{step.title}"' in tree and 'button "Back"' in tree and 'button "Next"' in tree
        levels = [int(level) for level in re.findall(r"heading .*\[level=(\d)\]", tree)]
        assert levels[0] == 1 and all(after <= before + 1 for before, after in itertools.pairwise(levels))
        if kind == RUN:
            assert re.search('button ".*On the stage', tree)
        if kind == EXPLAIN and "you said" in tree:
            assert 'columnheader "came out"' in tree and "rowheader" in tree
        if step.question and step.question.kind == CHOICE:
            assert 'radiogroup "Answer"' in tree
            assert len(re.findall(r'radio ".\) ', tree)) >= len(step.question.options)
            chosen = re.search(r"radio .*\[checked\].*", tree)
            assert chosen and ("[disabled]" in chosen[0]) == (kind == PREDICT)
        elif step.question:
            names = ("At least", "At most") if step.question.kind == INTERVAL else ("Answer",)
            assert all(f'textbox "{name}' in tree for name in names), tree


def test_what_comes_of_an_answer_is_read_out(walk):
    """Of a prediction that it is recorded; of an observation whether it is right."""
    for one in walk["told"]:
        if one["step"].kind == PREDICT:
            assert "It is recorded" in one["aloud"]
        elif one["step"].question:
            assert re.search("right|not so", one["aloud"])
