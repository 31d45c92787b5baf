"""Ring and vortex on the page: estimate on one half, truth on the other, and the probe."""

import numpy as np
import pytest

from tests.browser.driving import choose, coloured, number, readout, scene, stage, stage_box, time, to_the_ring, until


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


def test_the_ring_moves_and_is_probed(page):
    to_the_ring(page)
    until(lambda: "of 25 µs" in readout(page) and time(page) > 1e-4, "the ring running")
    both_halves_move_and_are_coloured(page)
    the_probe_reads_a_region(page)


@pytest.mark.slow
def test_the_vortex_moves_and_its_numbers_are_said(page):
    """Angular momentum is among them."""
    choose(page, "Problem", "generalized vortex")
    page.locator("label[data-words='h = 62.5 mm']").wait_for()
    until(lambda: "layout" in scene(page) and time(page) > 1e-3, "the vortex running")
    both_halves_move_and_are_coloured(page)
    assert "turning" in readout(page) and "energy" in readout(page)
