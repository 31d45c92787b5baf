"""Ring and vortex on the page: estimate on one half, truth on the other, domains, the probe, and what cannot be."""

from __future__ import annotations

import numpy as np
import pytest

from tests.browser.driving import (
    choose,
    coloured,
    number,
    press,
    readout,
    row,
    scene,
    stage,
    stage_box,
    time,
    to_the_ring,
    until,
)


@pytest.fixture
def ring(page):
    """The page with the ring running."""
    to_the_ring(page)
    until(lambda: "of 25 µs" in readout(page) and number(page, r"time\s+(\S+) s") > 1e-4, "the ring running")
    return page


def drag(page, start, end):
    page.mouse.move(*start)
    page.mouse.down()
    page.mouse.move(*end, steps=6)
    page.mouse.up()


def both_halves_move_and_are_coloured(page):
    """Left and right of the middle carry the map's colours, and the picture changes."""
    def halves():
        box = stage_box(page)  # the body is as wide as high, the plot right of it
        picture = stage(page)[int(box["y"]) + 40:int(box["y"] + box["height"]), :int(box["height"])]
        middle = picture.shape[1] // 2
        return coloured(picture[:, :middle]), coloured(picture[:, middle:])

    until(lambda: min(halves()) > 0.02, "two coloured halves")
    first = stage(page)
    until(lambda: np.any(np.abs(stage(page) - first) > 30, axis=2).mean() > 0.005, "another picture")


def the_probe_reads_a_region(ring):
    """A rectangle dragged over the ring reads the particles in it and their errors; an empty one puts it away."""
    drag(ring, (180, 260), (440, 530))
    until(lambda: "true mean" in readout(ring), "errors in the region")
    assert number(ring, r"region\s+(\d+) particles") > 10
    drag(ring, (500, 470), (540, 500))
    until(lambda: "drag a rectangle" in readout(ring), "no region")


def resonance_is_warned_of_and_inversion_refused(ring):
    """From 0.115 on the page warns and runs on; from 0.386 it refuses, and goes back to what was when the hand has come
    to rest; back below, both are gone."""
    slider = row(ring, "Amplitude A").get_by_role("slider")
    before = slider.get_attribute("aria-valuenow")
    press(ring, "Amplitude A", "End")
    ring.locator(".lab-refused").wait_for()
    assert "0.386" in ring.locator(".lab-refused").inner_text()
    until(lambda: slider.get_attribute("aria-valuenow") == before, "the amplitude before")
    press(ring, "Amplitude A", "ArrowRight", 25)
    ring.locator(".lab-refused").wait_for()
    until(lambda: "parametric resonance" in ring.locator(".lab-refused").inner_text(), "the warning")
    press(ring, "Amplitude A", "ArrowLeft", 120)
    ring.locator(".lab-refused").wait_for(state="detached")


def the_bar_comes_back(ring):
    """The bar comes back with its own controls."""
    choose(ring, "Problem", "vibrating bar")
    ring.get_by_text("Cells, h = 1/40").wait_for()
    until(lambda: number(ring, r"time\s+(\S+) s") > 0.05, "the bar running")
    assert ring.get_by_text("Show domains").count() == 0


def test_a_visit_to_the_ring(ring):
    """One visitor for all: a page of their own would cost each more than what is looked at."""
    for part in (both_halves_move_and_are_coloured, the_probe_reads_a_region,
                 resonance_is_warned_of_and_inversion_refused, the_bar_comes_back):
        part(ring)


def test_the_vortex_moves_and_its_numbers_are_said(page):
    """Angular momentum is among them."""
    choose(page, "Problem", "generalized vortex")
    page.get_by_text("Cells, h = 3/48").wait_for()
    until(lambda: "layout" in scene(page) and time(page) > 1e-3, "the vortex running")
    both_halves_move_and_are_coloured(page)
    assert "turning" in readout(page) and "energy" in readout(page)
