"""Doing what a lesson's text says, and nothing else: acts are found in it by their words, readings by what is bold."""

import re
from contextlib import suppress

from app.lessons.lesson import NUMBER, OBSERVE, PREDICT, draw_numbers, fill_numbers
from app.names_and_units import parse_size
from tests.browser.driving import FOLDERS, again_until, click, enter, row, scene, time, unfold, until

#: An act on a line of its own, or a reading: "Read **norm** of **true**".
SAID = re.compile(r"^\s*[-*] (Press|Set|Choose|Tick|Untick|Open) \*\*(.+?)\*\*(?: to)?(?: `(.+?)`)?"
                  r"|\*\*(norm|index|distance|share|RMS)\*\* of \*\*([\w -]+)\*\*", re.MULTILINE)
PART = re.compile(r"(norm|index|distance) of ([\w-]+)")
RECKONED = re.compile(r"`([^`]*(?:norm|index|distance) of [^`]*)`")
ON_COST = ("Tolerance", "Find the cheapest run")  # all else stands below the lesson's text, or on the stage
COLUMNS = {"norm": 1, "index": 2, "distance": 3}
SOON = 8.0  # seconds in which a change of scene is on the stage
LONG = 120.0  # seconds in which a lesson's run comes to its end


def tab(page, name):
    page.get_by_role("tab", name=name, exact=True).click()


def act(page, verb, name, value):
    """One act: by the button that the lesson has for it, else on the tab where its widget is."""
    to = f"{verb} {name}{' to' * (verb == 'Set')} {value}" if value else f"{verb} {name}"
    plain = verb == "Press" and name in ("On the stage", "Who made this error?")
    offered = page.locator(".lab-lesson").get_by_role("button", name=name if plain else to, exact=True)
    if offered.count():
        offered.first.click()
        page.wait_for_timeout(600)
        return
    if page.get_by_role("tab", name=name, exact=True).count():
        tab(page, name)
        return
    if name in ON_COST:
        tab(page, "Cost")
    if verb == "Press":
        named = page.get_by_role("button", name=name, exact=True).or_(page.get_by_text(name, exact=True))
        named.locator("visible=true").first.click()
    elif verb == "Open":
        unfold(page, next(folder for folder in FOLDERS if name.startswith(folder)))
    elif verb == "Choose":
        page.get_by_label(name, exact=True).first.click()
        page.get_by_role("option", name=value, exact=True).click()
    elif verb == "Set":
        _set(page, name, value)
    else:
        row(page, re.compile(f"^{re.escape(name)}$")).get_by_role("checkbox").click()
    page.wait_for_timeout(1200)  # text that is typed counts a moment later
    tab(page, "Lessons")


def _set(page, name, value):
    """A number beside a slider, or a text."""
    if page.get_by_role("slider", name=name, exact=True).count():
        return enter(page, name, value)
    page.get_by_role("textbox", name=name, exact=True).fill(value)


def reading(page, column, name):
    """A number of the readout, as it stands there; a share or an RMS of the error budget."""
    if column == "share":
        return page.locator(".lab-causes tr", has_text=name).first.locator("td").last.inner_text()
    if column == "RMS":
        return page.locator(".lab-outcome p", has_text=name).locator("b").inner_text()
    rows = page.locator(".lab-estimates tr", has_text=name)
    return rows.first.locator("td").nth(COLUMNS[column]).inner_text()


def reckoned(page, text):
    """What a text has reckoned from readings, or None where it has nothing."""
    found = RECKONED.search(text)
    if not found:
        return None
    unit = page.locator(".lab-estimates .lab-head td").first.inner_text().rpartition(" ")[2]
    values = {"x": "m", "v": "m/s", "σ": "Pa", "a": "m/s²"}

    def read(part):
        said = reading(page, *part.group(1, 2))
        return str(parse_size(said, values[unit] if part[1] == "norm" else ""))

    return f"{eval(PART.sub(read, found[1])):.4g}"


def answer(page, step, text):
    """Answer a question: a choice by its first option, a number by ``text``."""
    asked = step.question
    if asked.options:
        first = page.get_by_role("radiogroup", name="Answer").get_by_role("radio").first
        again_until(first.click, first.is_checked, "the first answer chosen")
    elif asked.kind == "interval":
        page.get_by_label(re.compile("^At least")).fill("1e-9")
        page.get_by_label(re.compile("^At most")).fill("1")
    elif asked.kind != "drag":
        page.get_by_role("textbox", name=re.compile("^Answer")).fill(text)
    page.wait_for_timeout(400)
    click(page, "Record my prediction" if step.kind == PREDICT else "Check my answer")
    until(page.locator(".lab-recorded").count, "the answer taken")


def do(page, text, stops):
    """Do what a text says, in its order; what it had one read, as it stood there then."""
    found = []
    for verb, name, value, column, of in SAID.findall(text):
        if verb:
            before = scene(page), time(page)
            act(page, verb, name, value)
            put = (verb, name) == ("Press", "On the stage")
            if put or (verb != "Press" and stops):
                with suppress(AssertionError):  # what was read of the run before would be another run's
                    until(lambda was=before: scene(page) != was[0] or time(page) < was[1], "another run",
                          LONG if put or name == "Method" or (verb == "Set" and name not in ON_COST) else SOON)
            continue
        if stops:
            until(lambda: "at its end" in page.locator(".lab-readout").inner_text(), "the end of the run", LONG)
            page.wait_for_timeout(1500)  # numbers follow the picture
        found.append(reading(page, column, of))
    return found


def go_on(page):
    """To the next step. Text that comes above the button may move it under the pointer, and the click is lost; one
    that comes late falls upon a button that is there no more."""
    head = page.locator(".lab-lesson-head")
    before = head.inner_text()
    again_until(lambda: head.inner_text() != before or click(page, "Next"), lambda: head.inner_text() != before,
                f"the step after {before}")


def follow(page, lesson):
    """Go through a lesson whose introduction is shown; the sentences of what was read and found not right."""
    numbers, wrong, read, stops = draw_numbers(lesson, ""), [], [], False
    go_on(page)
    for number, step in enumerate(lesson.steps, 1):
        where = f"step {number} of {len(lesson.steps)}"
        until(lambda where=where: where in page.locator(".lab-lesson-head").inner_text(), where)
        if step.stage:
            stops = "stops" in step.stage.partition(" pinned")[0].split()
        found = do(page, fill_numbers(step.text, numbers), stops) if step.kind != PREDICT else []
        read = found if step.stage or "Read **" in step.text else read  # else what one "did read" before
        if step.question:
            counts = step.kind == OBSERVE and step.question.kind == NUMBER and read
            answer(page, step, reckoned(page, fill_numbers(step.text, numbers)) or read[-1] if counts else "1")
            if counts:
                said = page.locator(".lab-recorded")
                until(lambda said=said: "checked" not in said.inner_text(), "the mark", LONG)
                if "right" not in said.inner_text():
                    wrong.append(f"{where}: read {read}: {said.inner_text()}")
                read = []
        go_on(page)
    return wrong
