"""Two runs side by side: one is pinned, the other is changed, and both go on."""

import re

import numpy as np
import pytest

from tests.browser.driving import choose, pinned, readout, stage, steps, time, until
from tests.support.session_listener import PATIENCE

LINE = r"pinned\s+([\d.]+ \S?m)\s+[\d.]+\s+[\d.]+"


@pytest.mark.short
def test_a_run_is_pinned_compared_and_let_go(page):
    """Its lanes come beside those of the run that is changed, and the words say what differs; both move; in the end
    the stage is as it was."""
    until(lambda: steps(page) > 20, "a run under way")
    page.keyboard.press("p")
    until(lambda: "pinned: the same so far" in readout(page), "two runs")
    choose(page, "Method", "MPM (hat functions)")
    until(lambda: "pinned: uGIMP" in readout(page), "what differs", PATIENCE)
    until(lambda: re.search(LINE, readout(page)), "a pinned run's line", PATIENCE)
    now, norm, picture = time(page), re.search(LINE, readout(page))[1], stage(page)[412:540]
    until(lambda: time(page) != now and re.search(LINE, readout(page))[1] != norm, "both going on")
    until(lambda: np.any(np.abs(stage(page)[412:540] - picture) > 30, axis=2).any(), "the pinned lanes drawn anew")
    until(page.locator(".lab-heading", has_text="grey: pinned").count, "whose the grey lines are")
    page.keyboard.press("p")
    until(lambda: "pinned" not in readout(page), "one run")
    page.keyboard.press("p")
    until(lambda: pinned(page), "another one")
    choose(page, "Problem", "expanding ring")
    until(lambda: not pinned(page), "none of another problem")
