"""One step in slow motion, as a visitor sees it."""

import re

import numpy as np
import pytest

from tests.browser.driving import click, coloured, row, shown, stage, steps, to_the_ring, unfold, until

TITLES = ("A particle and its nodes", "Mass and momentum go to the nodes", "Forces at the nodes",
          "New velocities of the nodes", "Velocities come back, the particles move", "Stress last")


def begin(page):
    click(page, "Slow motion")
    unfold(page, "One step in slow motion")
    shown(page, f"phase 1 of 6: {TITLES[0]}")


def table(page):
    return page.locator(".lab-slow").inner_text()


@pytest.mark.slow
def test_a_visitor_walks_through_a_step_and_back(page):
    """Each phase says what it is, in the panel and above the stage; then comes the next step, and Play ends it."""
    until(lambda: steps(page) > 20, "a run under way")
    begin(page)
    first = int(re.search(r"Step (\d+)", table(page))[1])
    until(lambda: steps(page) == first, "the same step among the numbers")  # which come a little later
    until(lambda: coloured(stage(page)) < 0.01, "no error colours")
    picture = stage(page)
    for phase, title in enumerate(TITLES, 1):
        shown(page, f"Step {first}, phase {phase} of 6: {title}")
        until(page.locator("#lab-summary", has_text=f"{phase} of 6: {title}").is_visible, "the sentence")
        if phase > 1:
            before = picture
            until(lambda before=before: np.mean(np.abs(stage(page) - before).max(axis=2) > 30) > 1e-3, "its picture")
        picture = stage(page)
        if phase < len(TITLES):
            click(page, "Forward")
    click(page, "Back")
    shown(page, f"Step {first}, phase 5 of 6")
    particle = page.get_by_label("Particle", exact=True)
    chosen = int(particle.input_value())
    particle.fill(str(chosen + 3))
    until(lambda: f"Particle {chosen + 3}:" in table(page), "the same step around another particle")
    shown(page, f"Step {first}, phase 5 of 6")
    click(page, "Forward")
    shown(page, f"Step {first}, phase 6 of 6")  # of clicks within a twentieth of a second the viewer sends the last
    click(page, "Forward")
    shown(page, f"Step {first + 1}, phase 1 of 6")
    weights = [float(weight) for weight in re.findall(r"^\S+\t(0\.\d+)\t", table(page), re.MULTILINE)]
    assert len(weights) > 1 and abs(sum(weights) - 1) < 1e-4 * len(weights)
    click(page, "Play")
    until(lambda: page.locator(".lab-slow").count() == 0 and coloured(stage(page)) > 0.01, "the ordinary stage")
    page.get_by_role("button", name="Slow motion", exact=True).wait_for()
    until(lambda: steps(page) > first + 1, "a run that goes on")


@pytest.mark.slow
def test_the_ring_is_walked_through_by_itself(page):
    to_the_ring(page)
    until(lambda: steps(page) > 5, "a ring under way")
    begin(page)
    row(page, "Seconds a phase").get_by_role("slider").focus()
    page.keyboard.press("Home")
    click(page, "Walk")
    until(lambda: re.search("phase [3-6] of 6", table(page)), "a walk without clicks")
    click(page, "Hold")
    page.get_by_role("button", name="Walk", exact=True).wait_for()
