"""A particle is traced by a click, earlier frames are looked back at, and plots show less on request."""

from __future__ import annotations

import re

from tests.browser.driving import (
    choose,
    click,
    click_a_particle,
    in_lane,
    number,
    plotted,
    press,
    readout,
    row,
    stage_box,
    time,
    to_the_ring,
    unfold,
    until,
)


def field(page):
    return row(page, "Trace particle").get_by_role("textbox")


def traced(page):
    """What the field says, and how many plots there are: one is the timeline."""
    return field(page).input_value(), len(plotted(page))


def a_click_traces_a_particle(page):
    """A plot of its own from the first frames on, until it is said that it is enough; by its number too."""
    until(lambda: time(page) > 0.3, "frames to look back at")
    unfold(page, "What is drawn")
    click_a_particle(page, *in_lane(page, "Truth", 0.34))
    title = page.get_by_text(re.compile(r"particle \d+, X = 0\.3\d* m"))
    title.wait_for()
    until(lambda: f"particle {traced(page)[0]}, " in title.inner_text(), "its number")
    until(lambda: len(plotted(page)) == 5 and min(plotted(page))[0] > 3, "its plot")
    first = page.evaluate("Math.min(...Object.values(window.__viserTestpoints.uplots).map(u => u.chart.data[0][0]))")
    assert first < 0.3  # the past is there too
    page.get_by_role("button", name="Trace no more").click()
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


def plots_show_the_last_periods(page):
    """Two of them, though the run is longer; all of it again on request."""
    speed = row(page, "Speed, typed").get_by_role("textbox")
    speed.fill("8")
    until(lambda: time(page) > 3, "more than two periods", 60)
    unfold(page, "What is drawn")
    choose(page, "Plots show", "last 2 periods")

    def lengths():
        return page.evaluate("Object.values(window.__viserTestpoints.uplots).map(u => u.chart.data[0])"
                             ".map(t => t[t.length - 1] - t[0])")

    until(lambda: all(1.5 < length < 2.01 for length in lengths()), "two periods")
    choose(page, "Plots show", "all")
    until(lambda: all(length > 2.5 for length in lengths()), "all of it")


def test_what_was_is_seen_again(page):
    """One visitor for all three."""
    a_click_traces_a_particle(page)
    looking_back_goes_back_and_play_goes_on_from_now(page)
    plots_show_the_last_periods(page)


def test_a_mirror_image_of_the_ring_is_traced(page):
    """In the estimate's half, which is a mirror image; the hole ends it."""
    to_the_ring(page)
    until(lambda: "of 25 µs" in readout(page), "the ring's run")
    unfold(page, "What is drawn")
    box = stage_box(page)  # the body stands at its left, as wide as the box is high
    middle = box["x"] + box["height"] / 2, box["y"] + 0.55 * box["height"]
    click_a_particle(page, middle[0] - 94 / 366 * box["height"], middle[1])  # in the middle of the wall
    page.get_by_text("particle ").first.wait_for()
    until(lambda: len(plotted(page)) == 5, "its plot")
    page.mouse.click(middle[0] - 20, middle[1])
    until(lambda: traced(page) == ("", 4), "nothing traced")
