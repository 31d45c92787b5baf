"""The Cost tab: runs become dots, a small sweep goes on behind a live stage, and what is clicked is loaded."""

from __future__ import annotations

import csv

import pytest

from tests.browser.driving import click, engine_processes, readout, row, shown, time, until
from tests.processes import PATIENCE, children, held


def job_processes(parent):
    """Ids of the processes that ``parent`` has started for a sweep or a search."""
    return children(parent, "study.jobs")


def begin(page, server):
    """A new visit, and what its Cost tab says before anything has run: the simulation stands still until then."""
    with held(engine_processes(server[1])):
        page.goto(f"{server[0]}/?fixedDpr=0.5")
        page.locator("#lab-ground").evaluate("ground => ground.remove()")  # it stays until there is a frame
        open_cost(page)
        shown(page, "Nothing measured yet.")


def dots(page):
    return page.locator(".lab-dot").count()


def open_cost(page):
    page.get_by_role("tab", name="Cost").click()


def value(page, label):
    """What stands in the control with this label."""
    return row(page, label).locator("input").last.input_value()


@pytest.mark.slow
def test_sweep_beside_the_live_stage_and_load(own_page, server):
    """The stage's own run is a dot; a sweep adds more while the stage pauses, or moves if its visitor wishes; then the
    stage goes on. A dot, a row and the file."""
    page = own_page  # which it leaves, or downloads from
    begin(page, server)
    until(lambda: dots(page) == 1, "the run on the stage as a dot")
    click(page, "Small sweep")
    until(page.get_by_role("button", name="Find the cheapest run").is_disabled, "no second job")
    # Three rows of kernels that are compiled for the first time, in a process of low priority: work, not waiting.
    until(lambda: dots(page) >= 4, "dots of the sweep", patience=4 * PATIENCE)
    with held(job_processes(server[1])):  # else it might be done before it is cancelled
        shown(page, "The stage is paused while your sweep takes times")
        between = time(page)
        page.wait_for_timeout(500)
        assert time(page) == between
        page.get_by_role("tab", name="Explore").click()
        click(page, "Play")
        until(lambda: time(page) > between, "the stage moving on")
        open_cost(page)
        shown(page, "Your stage runs beside it")
        page.get_by_role("tab", name="Explore").click()
        click(page, "Pause")
        until(lambda: "paused" in readout(page), "the stage paused by its visitor")
        open_cost(page)
        click(page, "Cancel")
        shown(page, "The sweep was cancelled")
    until(lambda: not job_processes(server[1]), "the process gone")
    page.locator(".lab-dot[data-run='3']").click()
    shown(page, "Run 3 is on the stage")
    until(lambda: "of 1.25 ms" in readout(page), "the step of 20 cells")
    page.get_by_role("tab", name="Explore").click()
    assert value(page, "Cells, h = 1/20") == "20" and value(page, "Method") == "MPM (hat functions)"
    open_cost(page)
    button = page.get_by_role("button", name="load run 2", exact=True)
    button.focus()
    page.keyboard.press("Enter")
    shown(page, "Run 2 is on the stage")
    with page.expect_download() as download:
        click(page, "Download CSV")
    with open(download.value.path(), newline="") as file:
        assert len(list(csv.DictReader(file))) == dots(page)


def test_search_is_refused_in_words_cancelled_and_left(own_page, server):
    """A tolerance that is none is said; a search says what it does; who leaves takes the process along."""
    page = own_page  # which it leaves, or downloads from
    open_cost(page)
    tolerance = row(page, "Tolerance / A").locator("input")
    tolerance.fill("a lot")
    click(page, "Find the cheapest run")
    shown(page, "give a number above 0")
    tolerance.fill("1e-5")
    click(page, "Find the cheapest run")
    shown(page, "on coarse grids")
    until(lambda: "paused" in readout(page), "the stage paused")
    tolerance.fill("1e-4")
    shown(page, "What it was to find has changed.")
    shown(page, "The search was cancelled")
    until(lambda: "paused" not in readout(page), "the stage going on")
    click(page, "Find the cheapest run")
    shown(page, "Search")
    click(page, "Cancel")
    shown(page, "The search was cancelled")
    click(page, "Small sweep")
    until(lambda: job_processes(server[1]), "a process")
    page.goto("about:blank")
    until(lambda: not job_processes(server[1]), "the process gone with its visitor")
    begin(page, server)
