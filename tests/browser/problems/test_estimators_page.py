"""Estimators on the page: one, several or none, against the truth or without it, and what they say of themselves."""

from __future__ import annotations

import re

import numpy as np
import pytest

from app.page.visit.session import FIRST_SCENE
from solvers.problems import PROBLEMS
from tests.browser.driving import (
    choose,
    click,
    coloured,
    drawn,
    lane,
    number,
    readout,
    row,
    stage,
    tick,
    time,
    to_the_ring,
    unfold,
    until,
)

LINE = r"\s+[\d.]+ \S?m\s+[\d.e-]+\s+[\d.e-]+"  # norm, index and distance in the table, after the estimator's name
OFFERED = PROBLEMS[FIRST_SCENE.problem].estimators


def halves(page):
    """How much of the upper and of the lower lane is coloured."""
    picture = stage(page)
    return coloured(picture[lane(page, "Estimate")]), coloured(picture[lane(page, "Truth")])


def the_table_names_index_distance_and_worst_region(page):
    """The truth and the estimator have a line each, and the worst region by each of them."""
    until(lambda: re.search("transport" + LINE, readout(page)), "norm, index and distance")
    until(lambda: len(re.findall(r"X = 0\.\d\d–\d\.\d\d m", readout(page))) == 2, "two regions")
    to_the_ring(page)
    until(lambda: len(re.findall(r"(inner|middle|outer) third, \d+–\d+°", readout(page))) == 2, "regions of the ring")


def the_difference_takes_the_upper_lane(page):
    """Compared, the upper lane changes and the lower, the truth, keeps its meaning; paused, it is there at once."""
    until(lambda: time(page) > 0.3, "a run under way")
    click(page, "Pause")
    until(lambda: "paused" in readout(page), "paused")
    until(lambda: min(halves(page)) > 0.25, "two coloured lanes")
    unfold(page, "What is drawn")
    upper = lane(page, "Estimate")
    before = stage(page)[upper]
    choose(page, "Compare", "estimate − truth | truth")
    page.mouse.move(640, 600)
    until(lambda: np.any(np.abs(stage(page)[upper] - before) > 30, axis=2).mean() > 0.1, "another upper lane")
    until(lambda: min(halves(page)) > 0.25, "two coloured lanes again")


@pytest.mark.parametrize("problem", [pytest.param("vibrating bar", marks=pytest.mark.slow), "expanding ring"])
def test_without_an_exact_solution(page, problem):
    """The estimate stands alone: no truth, no index, and in words why."""
    if problem != "vibrating bar":
        to_the_ring(page)
    unfold(page, "Method details")
    choose(page, "Body force", "two-tone")
    until(lambda: "no exact solution is built in" in readout(page), "the truth missing in words")
    estimates = [1] * (len(FIRST_SCENE.estimators) if problem == "vibrating bar" else 1)
    until(lambda: drawn(page)[1:] == [0, *estimates], "the estimates drawn, the truth not")
    page.get_by_text("empty: no exact solution is built in").wait_for(state="attached")  # among the numbers, folded
    name = "transport" if problem == "vibrating bar" else "companion"
    assert re.search(name + r"\s+[\d.]+ \S?m\s+–\s+–", readout(page)), readout(page)
    if problem == "vibrating bar":
        until(lambda: (lanes := halves(page))[0] > 0.25 and lanes[1] < 0.05, "a grey lane below")
        unfold(page, "What is drawn")
        choose(page, "Compare", "estimate − truth | truth")
        until(lambda: max(halves(page)) < 0.05, "no difference either")


def no_estimator_and_back(page):
    """With none ticked the page says so; ticked again, the estimate is back."""
    until(lambda: re.search("transport" + LINE, readout(page)), "an estimate")
    for name in FIRST_SCENE.estimators:
        tick(page, name)
    until(lambda: "no estimator is chosen" in readout(page), "none chosen")
    assert page.get_by_label("On the stage", exact=True).input_value() == "none"
    tick(page, "transport")
    until(lambda: re.search("transport" + LINE, readout(page)), "the estimate back")


def test_several_at_once(page):
    """Every estimator ticked has a line of its own in table and plot, and any of them can be on the stage."""
    unfold(page, "Method details")
    tick(page, "Linearity preserving")  # without it two-grid does not hold at this amplitude
    others = [name for name in OFFERED if name not in FIRST_SCENE.estimators]
    for name in others:
        tick(page, name)
    for name in OFFERED:
        until(lambda: re.search(name + LINE, readout(page)), f"the line of {name}")  # noqa: B023
    until(lambda: drawn(page)[1:] == [1] * (len(OFFERED) + 1), "a curve each, and the truth's")
    for name in (*FIRST_SCENE.estimators[1:], *others):
        choose(page, "On the stage", name)
        until(lambda: re.search(rf"true\s+{name}\s+X = ", readout(page)), f"{name} on the stage")  # noqa: B023
    tick(page, others[-1])
    until(lambda: drawn(page)[1:] == [1] * len(OFFERED), "one curve less")
    assert page.get_by_label("On the stage", exact=True).input_value() != others[-1]


def not_valid_is_said_instead_of_a_number(page):
    """An estimator that does not hold has a sentence in the table, no curve and no colours; the truth stays."""
    until(lambda: re.search("companion" + LINE, readout(page)), "the companion running")
    tick(page, "transport")
    until(lambda: re.search("transport" + LINE, readout(page)), "transport beside it")
    row(page, "Amplitude A").get_by_role("slider").focus()
    for _ in range(90):
        page.keyboard.press("ArrowRight")
    until(lambda: "companion: not valid here: " in readout(page), "the sentence")
    assert not re.search("companion" + LINE, readout(page)) and number(page, r"true\s+([\d.]+)") >= 0
    until(lambda: drawn(page)[1:] == [1, 1], "the truth and the other estimate drawn")


def explanations_are_set_as_mathematics(page):
    """Each estimator's explanation opens in the About tab, and its fractions and sums have the height of such."""
    page.get_by_role("tab", name="About").click()
    for name in ("transport", "recovered", "companion", "two-grid"):
        title = page.get_by_text(f"The estimator {name}")
        title.click()
        text = page.locator(".lab-explanation").filter(visible=True)
        text.wait_for()
        text.get_by_text("Misses").wait_for()
        assert text.locator("math[display=block]").first.bounding_box()["height"] > 15
        title.click()
        text.wait_for(state="hidden")


def test_the_bars_estimators(page):
    """One visitor for all three: a page of their own would cost each more than what is looked at."""
    no_estimator_and_back(page)
    the_difference_takes_the_upper_lane(page)
    explanations_are_set_as_mathematics(page)


def test_the_rings_estimators(page):
    the_table_names_index_distance_and_worst_region(page)
    not_valid_is_said_instead_of_a_number(page)
