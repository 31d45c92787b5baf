"""A talk: large text, one plot, keys and a presenter's remote; and keys on the page as it is."""

import pytest

from tests.browser.conftest import visit
from tests.browser.driving import click, pinned, scene, stage_box, until
from tests.browser.page.test_sizes import LAPTOP, LARGE, SMALL, UPRIGHT, cut_off, fitted, none_in, resize, written_over

#: Words that are seen, with how high their letters are on the screen in pixels; formulas have small indices.
SIZES = """() => {
    const found = [], walk = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    while (walk.nextNode()) {
        const text = walk.currentNode.textContent.trim(), element = walk.currentNode.parentElement;
        if (!text || element.closest("script, style, math, [hidden], dialog:not([open])")) continue;
        const range = document.createRange();
        range.selectNodeContents(walk.currentNode);
        const box = range.getBoundingClientRect(), style = getComputedStyle(element);
        if (box.width < 2 || box.height < 2 || style.visibility !== "visible" || box.bottom < 0
            || !element.checkVisibility({opacityProperty: true, visibilityProperty: true})) continue;
        let clipped = false;
        for (let e = element; e && e !== document.body; e = e.parentElement)
            clipped ||= getComputedStyle(e).clipPath !== "none";
        const high = parseFloat(style.fontSize) * (element.currentCSSZoom || 1);
        if (!clipped) found.push([text, high, box.left, box.right]);
    }
    return found.filter(([, size]) => size > 0);
}"""


def playing(page):
    return page.evaluate("document.body.classList.contains('lab-playing')")


def presented(page):
    return page.evaluate("document.body.classList.contains('lab-presented-view')")


def small(page, least):
    """Words that the last row cannot read, and words beyond the window's edges."""
    width = page.viewport_size["width"]
    return [said for said in page.evaluate(SIZES) if said[1] < least - 0.01 or said[2] < -1 or said[3] > width + 1]


@pytest.fixture
def presenter(server, chromium):
    """A page whose address asks for the presenter's view."""
    with visit(chromium, server[0], "&present") as page:
        yield page


@pytest.mark.slow
def test_a_talk(presenter):
    """Letters for the last row, one plot, no panel; keys and a remote drive it, and it ends."""
    page = presenter
    until(lambda: presented(page), "the presenter's view")
    for size, least, headline in ((UPRIGHT, 16, 21), (SMALL, 16, 27), (LAPTOP, 16, 30), (LARGE, 19, 46)):
        resize(page, size)
        until(lambda size=size: fitted(page), f"the stage in {size}")
        none_in(page, size, lambda page: written_over(page) + cut_off(page))  # what has no room is left out
        until(lambda least=least: small(page, least) == [], f"letters of {least} pixels: {small(page, least)}")
        assert page.locator("#lab-summary").evaluate("e => parseFloat(getComputedStyle(e).fontSize)") >= headline
        plot, drawn, said = (page.locator(".lab-axis").first.bounding_box(), stage_box(page),
                             page.locator("#lab-summary").bounding_box())
        assert plot["width"] > 0.2 * size[0] and plot["height"] > 0.12 * size[1]
        assert plot["x"] + plot["width"] <= size[0] and plot["y"] + plot["height"] <= size[1]
        assert min(plot["y"], drawn["y"]) >= said["y"] + said["height"]
        assert drawn["x"] + drawn["width"] <= plot["x"] or drawn["y"] + drawn["height"] <= plot["y"]
    resize(page, LAPTOP)
    shown = scene(page)
    assert not page.locator(".lab-methods").is_visible()
    keys_drive_it(page, shown)
    page.keyboard.press("Escape")
    until(lambda: not presented(page) and page.locator(".lab-methods").is_visible(), "the page as it was")
    click(page, "Present")
    until(lambda: presented(page), "the presenter's view again")
    click(page, "End")
    until(lambda: not presented(page), "its end")


def keys_drive_it(page, shown):
    was = playing(page)
    page.keyboard.press("Space")
    until(lambda: playing(page) != was, "Space")
    page.keyboard.press("m")
    until(lambda: scene(page)["method"] != shown["method"], "the next method")
    page.keyboard.press("q")
    code = page.locator(".lab-code svg")
    until(lambda: code.count() and code.bounding_box()["height"] >= 0.79 * LAPTOP[1], "a code as high as the window")
    assert page.get_by_text("Only this computer can open this address").is_visible()
    page.keyboard.press("Escape")
    until(lambda: not code.count(), "the code gone")
    assert presented(page)
    page.keyboard.press("b")
    until(page.locator("#lab-black").is_visible, "black")
    page.keyboard.press("m")  # any key ends it
    until(lambda: not page.locator("#lab-black").is_visible(), "no black")
    page.keyboard.press("s")
    until(page.locator("#lab-summary", has_text="1 of 6:").is_visible, "slow motion")
    for key, phase in (("PageDown", 2), ("ArrowRight", 3), ("PageUp", 2)):
        page.keyboard.press(key)
        until(page.locator("#lab-summary", has_text=f"{phase} of 6:").is_visible, f"{key}: phase {phase}")
    page.keyboard.press("s")
    page.keyboard.press("2")
    until(lambda: not page.locator(".lab-axis").first.is_visible(), "the stage alone")
    page.keyboard.press("1")
    until(page.locator(".lab-axis").first.is_visible, "the plot")


def test_keys_on_the_page(page):
    """Buttons have keys, a dialogue lists them, and whoever types means letters."""
    page.keyboard.press("?")
    listed = page.get_by_role("dialog", name="Keys")
    until(listed.is_visible, "the list")
    assert "play or pause" in listed.inner_text()
    page.keyboard.press("p")  # of no effect below a dialogue
    page.keyboard.press("Escape")
    until(lambda: not listed.is_visible(), "no list")
    assert not pinned(page)
    was = playing(page)
    page.keyboard.press("Space")
    until(lambda: playing(page) != was, "Space")
    judge, ask = page.get_by_label("On the stage", exact=True), page.locator(".lab-ask")
    before = judge.input_value()
    ask.click()
    page.locator(".lab-judge[data-judge=recovered]").click()
    until(lambda: judge.input_value() == "recovered", "another judge")
    ask.click()
    page.keyboard.press("e")
    until(lambda: judge.input_value() == before, "the next judge")
    page.keyboard.press("m")
    until(lambda: page.get_by_label("Magnify error", exact=True).input_value() == "× 10", "ten times as large")
    page.get_by_label("Amplitude A, typed", exact=True).focus()
    page.keyboard.press("p")
    page.keyboard.press("Escape")
    page.evaluate("document.activeElement.blur()")
    assert not pinned(page)
    page.keyboard.press("p")
    until(lambda: pinned(page), "pinned")
    page.keyboard.press("p")
    until(lambda: not pinned(page), "no longer pinned")
    page.keyboard.press("l")
    until(page.get_by_role("tab", name="Lessons", exact=True, selected=True).is_visible, "lessons")
    page.get_by_role("tab", name="Explore", exact=True).click()
