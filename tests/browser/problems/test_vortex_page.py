"""The vortex on the page: estimate on the left of the ring, truth on the right, the methods, domains, what breaks."""

from __future__ import annotations

import numpy as np
import pytest

from tests.browser.driving import choose, coloured, readout, row, scene, stage, stage_box, tick, time, unfold, until


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


@pytest.mark.slow
def test_methods_and_domains(vortex):
    row(vortex, "Cells, h = ").locator("input.mantine-NumberInput-input").fill("24")
    until(lambda: scene(vortex)["cells"] == 24, "a coarse vortex")
    for code, method in (("cpgimp-v", "cpGIMP with the spatial stretch V"), ("ugimp", "uGIMP")):
        choose(vortex, "Method", method)
        until(lambda code=code: scene(vortex)["method"] == code and time(vortex) > 1e-3, f"{method} running")
    vortex.get_by_role("button", name="Pause", exact=True).click()
    until(lambda: "paused" in readout(vortex), "paused")
    unfold(vortex, "What is drawn")
    before = stage(vortex)
    tick(vortex, "Show domains")
    until(lambda: np.any(np.abs(stage(vortex) - before) > 30, axis=2).mean() > 0.005, "outlines")
