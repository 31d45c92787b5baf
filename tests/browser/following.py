"""Doing what a lesson's text says, and nothing else: acts are found in it by their words, readings by what is bold."""

from __future__ import annotations

import re

from app.lessons.lesson import NUMBER, OBSERVE, PREDICT
from app.lessons.variants import drawn, filled
from tests.browser.driving import row, until

ACT = re.compile(r"^\s*[-*] (Press|Set|Choose|Tick|Untick|Open) \*\*(.+?)\*\*(?: to)?(?: `(.+?)`)?", re.MULTILINE)
READ = re.compile(r"\*\*(norm|index|distance)\*\* of \*\*([\w-]+)\*\*")
COLUMNS = {"norm": 1, "index": 2, "distance": 3}
LONG = 120.0  # seconds in which a lesson's run comes to its end


def tab(page, name):
    page.get_by_role("tab", name=name, exact=True).click()


def act(page, verb, name, value):
    """One act, on the tab where its widget is."""
    if (verb, name) == ("Press", "On the stage"):
        page.get_by_role("button", name=name, exact=True).click()
        return
    tab(page, "Explore")
    if verb == "Press":
        page.get_by_role("button", name=name, exact=True).or_(page.get_by_text(name, exact=True)).first.click()
    elif verb == "Open":
        page.get_by_text(name, exact=True).first.click()
    elif verb == "Choose":
        page.get_by_label(name, exact=True).first.click()
        page.get_by_role("option", name=value, exact=True).click()
    elif verb == "Set":
        _set(page, name, value)
    else:
        row(page, re.compile(f"^{re.escape(name)}$")).get_by_role("checkbox").set_checked(verb == "Tick", force=True)
    page.wait_for_timeout(1200)  # text that is typed counts a moment later
    tab(page, "Lessons")


def _set(page, name, value):
    """A number in the box beside a slider, or as the text of a size."""
    typed = page.get_by_label(f"{name}, typed", exact=True)
    if typed.count():
        typed.fill(value)
    else:
        row(page, re.compile(f"^{re.escape(name)}(,|$)")).locator("input.mantine-NumberInput-input").fill(value)


def reading(page, column, name):
    """A number of the readout, as it stands there."""
    rows = page.locator(".lab-estimates tr", has_text=name)
    return rows.first.locator("td").nth(COLUMNS[column]).inner_text()


def answer(page, step, text):
    """Answer a question: a choice by its first option, a number by ``text``."""
    asked = step.question
    if asked.options:
        page.get_by_label("Answer", exact=True).first.click()
        page.get_by_role("option").nth(1).click()
    elif asked.kind == "interval":
        page.get_by_label(re.compile("^At least")).fill("0")
        page.get_by_label(re.compile("^At most")).fill("1")
    elif asked.kind != "drag":
        page.get_by_role("textbox", name=re.compile("^Answer")).fill(text)
    page.wait_for_timeout(400)
    page.get_by_role("button", name="Record my prediction" if step.kind == PREDICT else "Check my answer").click()
    until(page.locator(".lab-recorded").count, "the answer taken")


def follow(page, lesson, on_step=lambda number: None):
    """Go through a lesson whose introduction is shown; the sentences of what was read and found not right."""
    numbers, wrong, told = drawn(lesson, ""), [], ""
    page.get_by_role("button", name="Next", exact=True).click()
    for number, step in enumerate(lesson.steps, 1):
        where = f"step {number} of {len(lesson.steps)}"
        until(lambda where=where: where in page.locator(".lab-lesson-head").inner_text(), where)
        text = filled(step.text, numbers)
        told = text if step.runs or step.stage else f"{told}\n{text}"
        for verb, name, value in ACT.findall(text):
            act(page, verb, name, value)
        if "stops" in step.stage.partition(" pinned")[0].split() and "On the stage" in text:
            until(lambda: "at its end" in page.locator(".lab-readout").inner_text(), "the end of the run", LONG)
        if step.question:
            found = READ.findall(told)
            wanted = step.kind == OBSERVE and step.question.kind == NUMBER and found
            read = reading(page, *found[-1]) if wanted else "1"
            answer(page, step, read)
            if wanted:
                said = page.locator(".lab-recorded")
                until(lambda said=said: "checked" not in said.inner_text(), "the mark", LONG)
                if "right" not in said.inner_text():
                    wrong.append(f"{where}: {found[-1]} reads {read}: {said.inner_text()}")
        on_step(number)
        page.get_by_role("button", name="Next", exact=True).click()
    return wrong
