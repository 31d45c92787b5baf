"""Who made this error? A press below the judges, the chart, a suspect taken away: every share is that of the same run
without a page. What all of it says is in tests/app/page/features/test_budget_fold.py."""

from dataclasses import replace

import pytest

from app import shareable_state
from app.frame.budget_chart_data import format_percent
from solvers.scene.error_causes import CAUSES
from tests.browser.conftest import visit
from tests.browser.driving import scene, until
from tests.browser.page.test_axe import nothing_serious

LONG = 90.0  # seconds of patience for what is compiled, and takes a period
HATS = "bar;method=mpm;cells=20;ppc=2;estimators=recovered;periods=1;stops;speed=0.5;error-of=v"


def legend(page):
    """Of each cause its shares, of one run or of two."""
    return page.locator(".lab-causes tr[data-cause]").evaluate_all(
        "rows => Object.fromEntries(rows.map(row => "
        "[row.dataset.cause, [...row.cells].slice(1).map(cell => cell.textContent)]))")


@pytest.mark.slow
def test_who_made_it_and_what_is_left_without_it(server, chromium, simulate):
    with visit(chromium, server[0], f"#{HATS}") as page:
        line = page.locator(".lab-error-causes")
        until(lambda: "crossings" in line.inner_text() and "%" in line.inner_text(), "the line", LONG)
        line.focus()
        page.keyboard.press("Enter")
        chart = page.locator(".lab-made svg")
        until(chart.count, "the chart", LONG)
        until(lambda: 0 < (chart.bounding_box() or {"y": 0})["y"] < 720, "the chart in the window")
        whole = replace(shareable_state.parse_state(HATS).scene,
                        effects=(*shareable_state.parse_state(HATS).scene.effects, "budget"))
        shares = simulate(whole).budget["v"]
        expected = {cause: [format_percent(shares[cause])] for cause in CAUSES}
        until(lambda: legend(page) == expected, f"{expected}", LONG)
        assert "crossings" in chart.get_attribute("aria-label")

        page.get_by_role("button", name="Take it away and run again").click()
        until(lambda: scene(page)["take_away"] == "crossings" and chart.count() == 2, "both charts", LONG)
        until(page.locator(".lab-outcome p").count, "what is left", LONG)
        nothing_serious(page, "the fold")
        page.get_by_role("button", name="Put it back").click()
        until(lambda: scene(page)["take_away"] == "nothing", "the scene as it is")
        until(lambda: chart.count() == 1 and not page.locator(".lab-outcome").count(), "one chart", LONG)
