"""A phone: the stage stays, the panel is a sheet with three stops, and fingers find what they press."""

import pytest

from tests.browser.conftest import visit
from tests.browser.driving import choose, stage_box, until

SIZE = {"width": 390, "height": 844}
LEAST = 44  # pixels, of what a finger presses
#: What can be pressed and is seen, and is lower or narrower than a finger needs.
SMALL = """least => [...document.querySelectorAll("button, [role=tab], [role=slider]:not(.mantine-Slider-thumb)")]
    .filter(e => e.checkVisibility({opacityProperty: true, visibilityProperty: true}))
    .filter(e => { const r = e.getBoundingClientRect(); return r.top >= 0 && r.bottom <= innerHeight && r.width > 1; })
    .filter(e => { const r = e.getBoundingClientRect(); return Math.min(r.width, r.height) < least - 1; })
    .map(e => [e.innerText || e.ariaLabel || e.className, e.getBoundingClientRect().width,
               e.getBoundingClientRect().height])"""


def sheet(page):
    """Where the sheet begins, in parts of the window from below."""
    top = page.locator(".mantine-Paper-root[style*='position: fixed']").first.bounding_box()["y"]
    return 100 * (SIZE["height"] - top) / SIZE["height"]


def stands_at(page, stop):
    until(lambda: abs(sheet(page) - stop) < 1.5, f"the sheet at {stop} %: {sheet(page):.1f}")


@pytest.mark.short
def test_the_sheet_has_three_stops_and_the_stage_stays(server, chromium):
    with visit(chromium, server[0], size=SIZE) as page:
        stands_at(page, 40)
        box = stage_box(page)
        assert box["y"] > 100 and box["y"] + box["height"] <= SIZE["height"] * 0.6
        grip = page.get_by_role("slider", name="height of the panel")
        grip.focus()
        for key, stop in (("ArrowUp", 85), ("ArrowDown", 40), ("Home", 16), ("End", 85), ("Enter", 16), ("Enter", 40)):
            page.keyboard.press(key)
            stands_at(page, stop)
            assert grip.get_attribute("aria-valuenow") == str(stop)
            box = stage_box(page)
            assert box["y"] >= 0 and SIZE["height"] * (1 - stop / 100) - box["y"] > 100, "some of the stage is seen"
        at = grip.bounding_box()
        x, y = at["x"] + at["width"] / 2, at["y"] + 15
        page.mouse.move(x, y)
        page.mouse.down()
        page.mouse.move(x, 300, steps=4)
        page.mouse.move(x, 160, steps=4)
        page.mouse.up()
        stands_at(page, 85)
        page.keyboard.press("ArrowDown")
        stands_at(page, 40)
        what_is_behind_a_button(page)


def what_is_behind_a_button(page):
    """The questions stand in the sheet; reset, speed and slow motion come when they are asked for."""
    assert page.locator(".lab-sparks-here #lab-sparks").count() == 1
    reset, more = page.get_by_role("button", name="Reset", exact=True), page.locator("#lab-more")
    assert not reset.is_visible() and "×" in more.inner_text()
    more.click()
    until(reset.is_visible, "reset")
    assert page.get_by_role("button", name="Slow motion", exact=True).is_visible()
    assert page.evaluate(SMALL, LEAST) == []
    choose(page, "Speed", "2")
    until(lambda: "2 ×" in more.inner_text(), "another speed")
    more.click()
    until(lambda: not reset.is_visible(), "the rest gone")
