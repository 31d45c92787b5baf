"""The patch test on the page: its controls come and go, and the page says what happens, or that nothing does."""

import re

import pytest

from tests.browser.driving import choose, enter, scene, summary, unfold, until

PASSED = "nothing happens, as expected"


@pytest.mark.slow
def test_the_patch_test_comes_and_goes(page):
    assert not page.get_by_text("Stretch F").count()
    unfold(page, "Physics and method")
    choose(page, "Motion", "patch test")
    until(lambda: scene(page)["motion"] == "patch", "the patch test")
    page.get_by_text("Stretch F").first.wait_for()
    assert not page.get_by_text("Amplitude A").count()
    assert scene(page)["estimators"] == ["companion"] and scene(page)["body_force"] == "none"
    until(lambda: PASSED in summary(page), "that nothing happens")
    choose(page, "Method", "MPM (hat functions)")
    enter(page, "Particles / cell", "2.5")
    until(lambda: scene(page)["ppc"] == 2.5, "particles that do not fit")
    until(lambda: re.search(r"run is lost", summary(page), re.I), "that the stress is lost")
    enter(page, "Stretch F", "1")
    page.get_by_text("the test could not fail").first.wait_for()  # refused in words; the run before it goes on
    enter(page, "Stretch F", "1.1")
    until(lambda: scene(page)["stretch"] == 1.1, "another stretch")
    unfold(page, "Physics and method")
    choose(page, "Motion", "vibration")
    until(lambda: scene(page)["motion"] == "vibrate", "the vibrating bar")
    assert (scene(page)["ppc"], scene(page)["body_force"], scene(page)["stretch"]) == (2, "material", 1.02)
    page.get_by_text("Amplitude A").first.wait_for()
