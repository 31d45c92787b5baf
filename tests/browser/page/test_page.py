"""The page as a visitor meets it: it moves, it answers every control, and it says in words what goes wrong."""

import re

import numpy as np
import pytest

from app.names_and_units import parse_size
from tests.browser import driving
from tests.browser.driving import click, enter, plotted, press, readout, row, stage, steps, tick, time, until


def the_bar_moves_and_is_coloured(page):
    """Frames follow each other, lanes carry the map's own colours, time runs and all four plots fill."""
    until(lambda: driving.coloured(stage(page)) > 0.05, "two driving.coloured lanes and a colour bar")
    first, before = stage(page), time(page)
    until(lambda: np.any(np.abs(stage(page) - first) > 30, axis=2).mean() > 0.005, "another picture")
    until(lambda: time(page) > before, "time running")
    counts = plotted(page)
    until(lambda: all(after[0] > then[0] for after, then in zip(plotted(page), counts, strict=True)), "plots growing")
    assert len(counts) == 4
    assert page.title() == "mpm-lab"


def nothing_of_the_viewer_shows(page):
    """No default branding, no share button, no developer's buttons."""
    text = page.locator("body").inner_text().lower()
    assert "viser" not in text and "share" not in text
    for icon in ("svg.tabler-icon-adjustments", "svg.tabler-icon-share", "svg.tabler-icon-cloud-check"):
        assert page.locator(icon).filter(visible=True).count() == 0


def chosen(page, label, unit):
    """The value where a slider has come to stand, once the text beside it says so: that may lag behind the keys."""
    ends = row(page, label).get_by_role("slider")

    def said():
        return parse_size(typed(page, label).input_value(), unit)

    until(lambda: said() == pytest.approx(10 ** float(ends.get_attribute("aria-valuenow")), rel=6e-3), "the text")
    return said()


def typed(page, label):
    """The text beside a slider."""
    return row(page, f"{label}, typed").get_by_role("textbox")


def pause_step_play_and_reset_do_so(page):
    """Pause stops time, Step takes one step, Play goes on, Reset begins at zero. There nothing has been measured, and
    the plots show nothing of the run before."""
    until(lambda: steps(page) > 100, "steps")
    click(page, "Pause")
    until(lambda: "paused" in readout(page), "paused")
    before = steps(page)
    page.keyboard.press(".")
    until(lambda: steps(page) == before + 1, "one step")
    click(page, "Play")
    until(lambda: steps(page) > before + 10, "more steps")
    click(page, "Pause")
    until(lambda: "paused" in readout(page), "paused again")
    click(page, "Reset")
    until(lambda: steps(page) == 0, "the beginning")
    until(lambda: all((points, last) == (2, 1) for points, last in plotted(page)), "empty plots")


@pytest.mark.short
def test_a_first_look(page):
    """One visitor for all three: a page of their own would cost each more than what is looked at."""
    the_bar_moves_and_is_coloured(page)
    nothing_of_the_viewer_shows(page)
    pause_step_play_and_reset_do_so(page)


@pytest.mark.short
def test_what_is_refused(page):
    """An amplitude that no exact bar has is refused, the present run goes on, and a good one clears the notice."""
    enter(page, "Amplitude A", "0.2")
    page.locator(".lab-refused").wait_for()
    assert "0.159" in page.locator(".lab-refused").inner_text()
    before = time(page)
    until(lambda: time(page) > before, "the run going on")
    press(page, "Amplitude A", "Home")
    page.locator(".lab-refused").wait_for(state="detached")


def test_auto_step_follows_the_scene_and_gives_way_to_the_slider(page):
    """The slider shows what it takes, also for another scene; who moves the slider has the say again."""
    tick(page, "Auto step")
    until(lambda: 0.4 < chosen(page, "CFL number", "") < 0.7, "the step of the motion ahead")
    before = chosen(page, "CFL number", "")
    enter(page, "Particles / cell", "1")
    until(lambda: chosen(page, "CFL number", "") != before, "another bound")
    press(page, "CFL number", "Home")
    until(lambda: not page.get_by_label("Auto step").is_checked(), "the box unticked")
    until(lambda: driving.step_size(page) == pytest.approx(0.01 / 40 / 2, rel=1e-2), "a step of one's own")


def test_lost_run_is_said_and_goes_on(page):
    """With one particle per cell: since when, why and where; it moves on."""
    enter(page, "Particles / cell", "1")
    # Read when it comes: a busy browser may be told next that the run went unstable.
    said = page.locator(".lab-notice.lab-lost").inner_text()
    found = re.match(r"The run is lost from t = (0\.\d+) s on: .+, most at particle \d+ \(X = [\d.]+\)\.$", said)
    until(lambda: time(page) > float(found[1]) + 0.1, "the lost run going on")
