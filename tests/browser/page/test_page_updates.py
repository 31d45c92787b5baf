"""What the browser has to do while a run plays: the picture moves, the page around it stands."""

import pytest

from tests.browser.conftest import HOME, serving
from tests.browser.driving import steps, until

#: Changes of the page by what they are of: an element's own name, or its kind.
CHANGES = """() => {
    const changes = window.changes = {}, name = node => {
        const e = node.nodeType === 1 ? node : node.parentElement;
        return e?.id && !/^mantine|-.{4}-/.test(e.id) ? "#" + e.id : e?.dataset.lab || [...e?.classList || [""]][0]; };
    window.frames = 0;
    const count = () => { window.frames++; requestAnimationFrame(count); };
    count();
    new MutationObserver(all => {
        for (const what of new Set(all.map(one => `${name(one.target)} ${one.type} ${one.attributeName || ""}`)))
            changes[what] = (changes[what] || 0) + 1;
    }).observe(document.documentElement, {subtree: true, childList: true, attributes: true, characterData: true}); }"""


@pytest.mark.slow
def test_no_part_of_the_page_changes_with_every_frame(server, chromium):
    """What is drawn moves; words, widgets and curves follow a few times a second, and the clock is the quickest."""
    with serving(frames=30) as (address, _):
        page = chromium.new_page(viewport={"width": 900, "height": 640})
        try:
            page.goto(f"{address}/?fixedDpr=0.25{HOME}")
            until(page.locator(".lab-readout", has_text="periods").count, "the first numbers")
            until(lambda: steps(page) > 100, "a run under way")
            page.wait_for_timeout(3000)  # for what settles after the first picture
            page.evaluate(CHANGES)
            until(lambda: page.evaluate("window.changes['#lab-clock childList '] > 15"), "the clock going on")
            changes, frames = page.evaluate("[window.changes, window.frames]")
        finally:
            page.close()
    clock = changes["#lab-clock childList "]
    assert frames > clock, "the browser draws more often than the clock goes on"
    assert {what: times for what, times in changes.items() if times > clock + 3} == {}
