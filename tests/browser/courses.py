"""A package of lessons in a course's own system, which is a page with a frame; and a student who answers rightly."""

from __future__ import annotations

import io
import json
import math
import zipfile
from contextlib import closing, contextmanager

from tests.browser.conftest import SIZE, no_errors
from tests.browser.driving import until

COURSE, ELSEWHERE = "https://course.test", "https://elsewhere.test"
FRAME = "<!doctype html><title>frame</title><iframe src='{}' style='width:100%;height:100vh;border:0'></iframe>"
SYSTEM = "<!doctype html><title>course</title><script>{}</script>" \
         "<iframe id='lesson' style='width:100%;height:95vh;border:0'></iframe>"
OPEN = "file => { document.getElementById('lesson').src = '/package/' + file; }"
CLOSE = "() => { document.getElementById('lesson').src = 'about:blank'; }"


@contextmanager
def course(chromium, package: bytes, system: str, size=SIZE):
    """The page of a system, a script, that has unpacked the package. Any error in the console fails the test."""
    files = zipfile.ZipFile(io.BytesIO(package))
    context = chromium.new_context(viewport=size, accept_downloads=True, reduced_motion="reduce")
    page = context.new_page()

    def answer(route):
        path = route.request.url.partition("://")[2].partition("/")[2]
        if path.startswith("package/"):
            route.fulfill(body=files.read(path.removeprefix("package/")), content_type="text/html; charset=utf-8")
        elif path.startswith("frame?"):  # a frame around another, of whatever origin
            route.fulfill(body=FRAME.format(path.removeprefix("frame?")), content_type="text/html")
        else:
            route.fulfill(body=SYSTEM.format(system), content_type="text/html; charset=utf-8")

    context.route("**/*", answer)
    with no_errors(page), closing(context):
        page.goto(COURSE)
        yield page


def lesson(page):
    """The lesson's frame."""
    return page.frame_locator("#lesson")


def opened(page, file: str):
    """Open a lesson of the package; returns its frame."""
    page.evaluate(OPEN, file)
    until(lesson(page).locator("#where").is_visible, file)
    return lesson(page)


def closed(page):
    """Close the lesson, as one does who leaves it."""
    page.evaluate(CLOSE)
    until(lambda: not lesson(page).locator("#where").count(), "the lesson closed")


def steps(frame):
    """The steps as the page has them, with what is right in their questions."""
    return json.loads(frame.locator("#data").text_content())["lesson"]["steps"]


def answer(frame, question: dict, variant: int = 0) -> None:
    """Give the right answer to the question that is shown."""
    rules = question["rules"]
    rule = rules[variant if len(rules) > 1 else 0]
    if question["kind"] == "choice":
        frame.get_by_role("radio").nth(rule["options"][0] - 1).check()
    elif question["kind"] == "text":
        frame.get_by_role("textbox").fill("in words")
    elif question["kind"] == "interval":
        for box in frame.get_by_role("textbox").all():  # as narrow as can be, which costs nothing
            box.fill(repr(rule["value"]))
    elif question["kind"] == "number":
        frame.get_by_role("textbox").fill(repr(rule["value"]))
    else:
        value = rule["value"]
        at = math.log10(value) if question["drag"]["powers"] else value
        frame.locator(".answer").get_by_role("slider").fill(f"{at:.2f}")
    frame.locator("button", has_text="my ").click()


def walked(frame, until_step: int | None = None, variant: int = 0) -> None:
    """Go through the lesson from where it is, answering all that is asked, to a step or the end."""
    all_steps = steps(frame)
    while not (where := frame.locator("#where").inner_text()).startswith("The end"):
        number = 0 if where == "Introduction" else int(where.split()[1])
        if number == until_step:
            return
        if number and (question := all_steps[number - 1]["question"]):
            answer(frame, question, variant)
        frame.get_by_role("button", name="Next →").click()
