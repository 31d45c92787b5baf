"""Estimators on the page: several at once, and what they say of themselves. What is not estimated, not valid or has no
truth is in ``tests/app/frame/test_view.py``, without a browser."""

import re

import pytest

from solvers.problems import PROBLEMS
from tests.browser.conftest import FIRST_SCENE
from tests.browser.driving import choose, drawn, readout, tick, unfold, until

LINE = r"\s+[\d.]+ \S?m\s+[\d.e-]+\s+[\d.e-]+"  # norm, index and distance in the table, after the estimator's name
OFFERED = PROBLEMS[FIRST_SCENE.problem].estimators


@pytest.mark.slow
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
