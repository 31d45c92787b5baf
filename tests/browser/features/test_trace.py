"""A particle is traced by a click, and earlier frames are looked back at."""

import re

import pytest

from tests.browser import driving
from tests.browser.driving import click, number, plotted, press, readout, row, time, unfold, until


def field(page):
    return row(page, "Trace particle").get_by_role("textbox")


def traced(page):
    """What the field says, and how many plots there are: one is the timeline."""
    return field(page).input_value(), len(plotted(page))


def a_click_traces_a_particle(page):
    """A plot of its own from the first frames on, until it is said that it is enough; by its number too."""
    until(lambda: time(page) > 0.3, "frames to look back at")
    unfold(page, "Look")
    driving.click_a_particle(page, *driving.in_lane(page, "truth", 0.34))
    title = page.get_by_text(re.compile(r"particle \d+, X = 0\.3\d* m"))
    title.wait_for()
    until(lambda: f"particle {traced(page)[0]}, " in title.inner_text(), "its number")
    until(lambda: len(plotted(page)) == 5 and min(plotted(page))[0] > 3, "its plot")
    first = page.evaluate("Math.min(...Object.values(window.__viserTestpoints.uplots).map(u => u.chart.data[0][0]))")
    assert first < 0.3  # the past is there too
    page.get_by_role("button", name="Stop tracing").click()
    until(lambda: traced(page) == ("", 4), "nothing traced")
    field(page).fill("17")
    page.get_by_text("particle 17, X = 0.1094 m").wait_for()
    field(page).fill("160")
    page.get_by_text("'160' is not the number of one; give one from 0 to 159, or nothing").wait_for()
    field(page).fill("")
    until(lambda: traced(page) == ("", 4), "nothing traced")


def looking_back_goes_back_and_play_goes_on_from_now(page):
    until(lambda: time(page) > 0.5, "frames to look back at")
    slider = row(page, "Look back").locator("[role=slider]")  # hidden while it is out of use
    click(page, "Pause")
    until(lambda: "paused" in readout(page), "paused")
    until(lambda: float(slider.get_attribute("aria-valuemin")) < -3, "frames that are kept")
    now = time(page)
    press(page, "Look back", "ArrowLeft", 3)
    until(lambda: "periods back" in readout(page), "an earlier frame")
    until(lambda: slider.get_attribute("aria-valuenow") == "-3", "three frames back")
    until(lambda: abs(now - number(page, r"shown\s+(\S+) periods back") - time(page)) < 0.006, "its time")  # 2 decimals
    assert time(page) < now and "paused" in readout(page)
    click(page, "Play")
    until(lambda: time(page) > now and "periods back" not in readout(page), "on from now")
    until(lambda: slider.get_attribute("aria-disabled") == "true", "the slider out of use")
    until(lambda: slider.get_attribute("aria-valuenow") == "0", "the slider at now")


@pytest.mark.short
def test_what_was_is_seen_again(page):
    """One visitor for both."""
    a_click_traces_a_particle(page)
    looking_back_goes_back_and_play_goes_on_from_now(page)
