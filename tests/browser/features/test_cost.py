"""The Cost tab: a search goes on behind a paused stage, its runs become dots, and what is clicked is loaded."""

import csv

import pytest

from tests.browser.driving import click, downloaded, readout, row, shown, until
from tests.support.processes import children


def job_processes(parent):
    """Ids of the processes that ``parent`` has started for a sweep or a search."""
    return children(parent, "study.sweep_and_search_worker")


def dots(page):
    return page.locator(".lab-dot").count()


def open_cost(page):
    page.get_by_role("tab", name="Cost").click()


def headline(page):
    return page.locator("#lab-cost h2").inner_text()


def percent(field):
    return float(field.input_value().removesuffix("%"))


def move_the_line(page):
    """By keys and by the mouse: the cheapest run below it lights up, and the box has what the line says."""
    line, tolerance = page.get_by_role("slider", name="accuracy wanted"), row(page, "Tolerance").locator("input")
    line.focus()
    page.keyboard.press("Home")
    until(lambda: "No run so far" in headline(page), "nothing so accurate")
    page.keyboard.press("End")
    until(lambda: "pay" in headline(page), "a run for the least accuracy")
    assert page.locator(".lab-dot.lab-good").count() == 1
    price = line.get_attribute("aria-valuetext").split(": ")[1].split(", ")[0]
    assert price in headline(page)
    box, before = line.bounding_box(), percent(tolerance)
    page.mouse.move(box["x"] + 9, box["y"] + box["height"] / 2)
    page.mouse.down()
    page.mouse.move(box["x"] + 9, box["y"] + box["height"] / 2 + 40, steps=4)
    page.mouse.up()
    until(lambda: percent(tolerance) < before, "a smaller tolerance")
    until(lambda: float(line.inner_text().split()[0]) == percent(tolerance), "the box and the line alike")


def look_at_dots(page):
    """One stop for the keyboard, from which arrows lead to the dearer and the cheaper; each says its numbers."""
    stops = page.locator(".lab-dots button[tabindex='0']")
    assert stops.count() == 1
    stops.focus()
    page.keyboard.press("ArrowRight")
    tip = page.locator("#lab-cost .lab-run-tip")
    until(lambda: "cells" in tip.inner_text() and tip.is_visible(), "the numbers of the run")
    assert tip.inner_text().splitlines()[0] == page.evaluate(
        "document.activeElement.getAttribute('aria-label').split('; ')[0]")


def names_are_apart(page):
    """No name, number or tick that is shown lies on another or beyond the chart's box."""
    return page.evaluate("""() => {
        const box = element => element.getBoundingClientRect(), room = box(document.getElementById("lab-cost"));
        const names = "#lab-cost :is(.lab-name, .lab-cells, .lab-on-stage, .lab-across)";
        const shown = [...document.querySelectorAll(names)].filter(
            element => getComputedStyle(element).visibility === "visible" && box(element).width).map(box);
        const clear = (one, other) => one.left >= other.right - 1 || other.left >= one.right - 1
            || one.top >= other.bottom - 1 || other.top >= one.bottom - 1;
        return shown.length > 2 && shown.every((one, k) => one.left >= room.left && one.right <= room.right
            && one.bottom <= room.bottom && shown.slice(k + 1).every(other => clear(one, other)));
    }""")


@pytest.mark.short
def test_search_is_refused_in_words_cancelled_and_left(own_page, server):
    """A tolerance that is none is said; a search says what it does, and what it has run is looked at by line, dot and
    file; who leaves takes the process along."""
    page = own_page  # which it leaves, or downloads from
    open_cost(page)
    until(page.locator("#lab-cost").is_visible, "the chart")
    assert not page.locator("#lab-summary").is_visible()
    until(lambda: dots(page) == 24, "shipped runs")
    until(lambda: "Your run" in headline(page), "the answer for the run on the stage")
    assert page.locator(".lab-dot.lab-own").get_attribute("aria-label").split(": ")[1].startswith("uGIMP on 40 cells")
    until(page.get_by_role("button", name="Load the better").is_visible, "the answer in the panel")
    tolerance = row(page, "Tolerance").locator("input")
    tolerance.fill("a lot")
    click(page, "Find the cheapest run")
    shown(page, "give a number above 0")
    tolerance.fill("1e-5")
    click(page, "Find the cheapest run")
    shown(page, "of at least")
    until(lambda: "paused" in readout(page), "the stage paused")
    until(lambda: dots(page) > 2 and page.locator(".lab-dot.lab-judged").count() > 1, "what the search has run so far")
    assert "Your stage is paused" in page.locator("#lab-cost header").inner_text()
    tolerance.fill("1e-4")
    shown(page, "The goal of the search has changed.")
    shown(page, "The search was cancelled")
    until(lambda: "paused" not in readout(page), "the stage going on")
    move_the_line(page)
    look_at_dots(page)
    until(lambda: names_are_apart(page), "names that can be read")
    page.locator(".lab-dot.lab-judged").first.click()
    shown(page, "is on the stage")
    with open(downloaded(page, lambda: click(page, "Download CSV")).path(), newline="") as file:
        sources = [line["source"] for line in csv.DictReader(file)]
    assert sources.count("search") == page.locator(".lab-dot.lab-judged").count()
    click(page, "Measure here")
    until(lambda: job_processes(server[1]), "a process")
    page.goto("about:blank")
    until(lambda: not job_processes(server[1]), "the process gone with its visitor")
