"""The vortex on the page: estimate on the left of the ring, truth on the right, and its numbers."""

from __future__ import annotations

import numpy as np
import pytest

from tests.browser.driving import choose, coloured, readout, scene, stage, stage_box, time, until


@pytest.fixture
def vortex(page):
    """The page with the vortex running."""
    choose(page, "Problem", "generalized vortex")
    page.get_by_text("Cells, h = 3/48").wait_for()
    until(lambda: "layout" in scene(page) and time(page) > 1e-3, "the vortex running")
    return page


def test_both_halves_are_coloured_and_numbers_are_said(vortex):
    """Left and right of the middle carry the map's colours; angular momentum is among the numbers."""
    def halves():
        box = stage_box(vortex)
        picture = stage(vortex)[int(box["y"]) + 40:int(box["y"] + box["height"]), :int(box["height"])]
        middle = picture.shape[1] // 2
        return coloured(picture[:, :middle]), coloured(picture[:, middle:])

    until(lambda: min(halves()) > 0.02, "two coloured halves")
    assert "turning" in readout(vortex) and "energy" in readout(vortex)
    first = stage(vortex)
    until(lambda: np.any(np.abs(stage(vortex) - first) > 30, axis=2).mean() > 0.005, "another picture")
