"""The patch test on the page: its controls come and go, and the page says what happens, or that nothing does."""

from __future__ import annotations

import re

import pytest

from tests.browser.conftest import PHONE, visit
from tests.browser.driving import choose, number, row, scene, unfold, until
from tests.browser.page.test_first_picture import summary

PASSED = "nothing happens, as it should"


def fill(page, label, value):
    row(page, label).locator("input.mantine-NumberInput-input").fill(value)


def test_the_patch_test_comes_and_goes(page):
    assert not page.get_by_text("Stretch F").count()
    unfold(page, "Motion and material")
    choose(page, "Motion", "patch test")
    until(lambda: scene(page)["motion"] == "patch", "the patch test")
    page.get_by_text("Stretch F").first.wait_for()
    assert not page.get_by_text("Amplitude A").count()
    assert scene(page)["estimators"] == ["companion"] and scene(page)["body_force"] == "none"
    until(lambda: PASSED in summary(page), "that nothing happens")
    choose(page, "Method", "MPM (hat functions)")
    fill(page, "Particles / cell", "2.5")
    until(lambda: scene(page)["ppc"] == 2.5, "particles that do not fit")
    until(lambda: re.search(r"run is lost", summary(page), re.I), "that the stress is lost")
    assert number(page, r"companion\s+\S+ \S*Pa\s+(\S+)") == pytest.approx(1, abs=.01)
    fill(page, "Stretch F", "1")
    page.get_by_text("nothing could go wrong").first.wait_for()  # refused in words; the run before it goes on
    fill(page, "Stretch F", "1.1")
    until(lambda: scene(page)["stretch"] == 1.1, "another stretch")
    unfold(page, "Motion and material")
    choose(page, "Motion", "vibration")
    until(lambda: scene(page)["motion"] == "vibrate", "the vibrating bar")
    assert (scene(page)["ppc"], scene(page)["body_force"], scene(page)["stretch"]) == (2, "material", 1.02)
    page.get_by_text("Amplitude A").first.wait_for()


@pytest.mark.slow
def test_a_link_opens_it_on_a_phone(server, chromium):
    """All particles stay on the stage while the bar moves through it, and nothing is wider than the screen."""
    link = "#bar;motion=patch;method=mpm;ppc=2.5;cells=20;modulus=1000;cfl=0.2;estimators=companion;error-of=sigma"
    with visit(chromium, server[0], f"{link};speed=1", size=PHONE) as phone:
        until(lambda: scene(phone)["motion"] == "patch", "the link's scene")
        assert scene(phone)["ppc"] == 2.5
        until(lambda: "lost" in summary(phone), "what is seen, in words")
        assert phone.evaluate("document.documentElement.scrollWidth") <= PHONE["width"]
