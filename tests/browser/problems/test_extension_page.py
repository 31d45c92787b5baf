"""A fifth estimator, added from outside (``tests/outside.py``), on a page of its own."""

import re

import pytest

from tests.browser.conftest import serving, visit
from tests.browser.driving import choose, readout, to_the_ring, until
from tests.solvers.estimators.test_extension import ENVIRONMENT, FIVE


@pytest.mark.slow
def test_a_fifth_estimator_is_chosen_drawn_and_explained(chromium):
    """Its box is there beside the four; it has a line in the table, is on the stage, and its text is told."""
    with serving(ENVIRONMENT) as (address, _), visit(chromium, address) as page:
        boxes = {name: page.get_by_label(name, exact=True) for name in FIVE}
        assert all(box.is_visible() for box in boxes.values())
        boxes["zero"].click()
        until(lambda: re.search(r"zero\s+0 m\s+0\s+1\.00", readout(page)), "no error, index 0 and distance 1")
        choose(page, "On the stage", "zero")
        until(lambda: re.search(r"zero\s+unknown", readout(page)), "no worst region by what is on the stage")
        to_the_ring(page)
        until(lambda: not boxes["zero"].is_visible() and boxes["two-grid"].is_visible(), "four boxes for the ring")
        page.get_by_role("tab", name="About").click()
        page.get_by_text("The estimator zero").click()
        page.get_by_text("says that there is no error").filter(visible=True).wait_for()
