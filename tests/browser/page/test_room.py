"""Room: the stage is the largest thing in every window, nothing lies over anything else, and a projector is served."""

from __future__ import annotations

import pytest
from axe_playwright_python.sync_playwright import Axe

from tests.browser.driving import click, coloured, readout, stage, stage_box, steps, to_the_ring, unfold, until

LARGE, LAPTOP, UPRIGHT, PHONE = (1920, 1080), (1280, 720), (800, 1100), (390, 844)


def resize(page, size):
    page.set_viewport_size({"width": size[0], "height": size[1]})


def boxes(page):
    """Stage, sentence and panels that are to be seen, as (left, top, right, bottom)."""
    return page.evaluate("""() => ["[data-dock-root] > div:first-child", "#lab-summary", "[data-dock-region=left]",
        "[data-dock-region=right]", ".mantine-Paper-root[style*='position: fixed']"]
        .map(s => document.querySelector(s)).filter(e => e && e.getBoundingClientRect().width > 0)
        .map(e => { const r = e.getBoundingClientRect(); return [r.left, r.top, r.right, r.bottom]; })""")


def overlap(a, b):
    """How many pixels two boxes share in each direction."""
    return min(a[2], b[2]) - max(a[0], b[0]), min(a[3], b[3]) - max(a[1], b[1])


def everything_has_a_place_of_its_own(page):
    """The stage has three fifths of the width or all of it, and 400 pixels where the window has as many. Names of
    controls stand in one line, and no panel has more to its right than can be seen."""
    to_the_ring(page)  # its labels are the longest
    for size in (LARGE, LAPTOP, UPRIGHT, PHONE):
        resize(page, size)
        until(lambda size=size: stage_box(page)["width"] >= 0.6 * size[0], "a broad stage")
        until(lambda: coloured(stage(page)) > 0.002, "a stage with colours")
        assert stage_box(page)["height"] >= min(0.38 * size[1], 400)
        places = boxes(page)
        assert len(places) == (3 if size == PHONE else 4)
        for k, a in enumerate(places):
            assert a[0] >= -1 and a[1] >= -1 and a[2] <= size[0] + 1 and a[3] <= size[1] + 1
            assert not any(min(overlap(a, b)) > 1 for b in places[:k])
        until(lambda: labels_that_wrap(page) == [], "labels in one line")
        assert page.evaluate("""() => [...document.querySelectorAll('.mantine-ScrollArea-viewport')]
            .filter(e => e.clientWidth && e.scrollWidth > e.clientWidth + 1).length""") == 0


def the_word_beside_a_control_that_waits_takes_no_room(page):
    """Beside the name, in the place of the plain words: nothing moves, and it stays in the name's column."""
    unfold(page, "Method details", "Effects: compute")
    for size in (LAPTOP, PHONE):
        resize(page, size)
        until(lambda: labels_that_wrap(page) == [], "labels in one line")
        assert page.evaluate("""() => [...document.querySelectorAll('.mantine-Flex-root label')]
            .filter(e => e.offsetParent && e.parentElement.parentElement.offsetWidth > 1)
            .filter(e => {
                const row = e.closest('.mantine-Flex-root'), column = e.parentElement.parentElement;
                const high = row.offsetHeight;
                e.dataset.waits = 'compiling … 12 s';
                const bad = row.offsetHeight !== high
                    || e.getBoundingClientRect().right > column.getBoundingClientRect().right + 1;
                delete e.dataset.waits;
                return bad; }).map(e => e.innerText)""") == []


def labels_that_wrap(page):
    return page.evaluate("""() => [...document.querySelectorAll('label, .mantine-Button-label')]
        .filter(e => e.offsetParent && e.innerText.trim())
        .filter(e => e.matches('.mantine-Button-label')
                     || !e.closest(':is([data-lab~=lab-typed], [data-lab~=lab-bare]) + div'))
        .filter(e => { const range = document.createRange(); range.selectNodeContents(e);
                       return new Set([...range.getClientRects()].map(r => Math.round(r.top / 8))).size > 1; })
        .map(e => e.innerText)""")


def a_phone_finds_the_measurements(page):
    """Folded below the controls, they open."""
    resize(page, PHONE)
    page.get_by_role("button", name="Expand panel Measurements").click()
    until(page.get_by_text("periods/s").first.is_visible, "the readout")


def the_open_tab_stays_open_when_the_window_changes(page):
    """The viewer makes its tabs anew for a narrow window, and for a wide one."""
    def opened(name):
        return page.get_by_role("tab", name=name, exact=True, selected=True).is_visible()

    resize(page, LAPTOP)
    for size, tab in ((PHONE, "Cost"), (LAPTOP, "Lessons"), (PHONE, "Explore"), (LAPTOP, "Explore")):
        page.get_by_role("tab", name=tab, exact=True).click()
        until(lambda tab=tab: opened(tab), f"{tab} opened")
        resize(page, size)
        until(lambda size=size: page.locator("[data-dock-region=left]").count() == (size != PHONE), "another layout")
        until(lambda tab=tab: opened(tab), f"{tab} open again")


def the_run_goes_on_when_the_window_changes(page):
    """The browser makes the page's widgets anew then, and says again which link it has: that is no wish."""
    until(lambda: steps(page) > 20, "a run under way")
    click(page, "Pause")
    until(lambda: "paused" in readout(page), "paused")
    at = steps(page)
    for size in (PHONE, LAPTOP):
        resize(page, size)
        until(lambda size=size: page.locator("[data-dock-region=left]").count() == (size != PHONE), "another layout")
    until(page.locator(".lab-readout").is_visible, "the readout")
    assert "paused" in readout(page) and steps(page) == at


@pytest.mark.slow
def test_a_folded_panel_gives_its_room_to_the_stage(own_page):
    before = stage_box(own_page)["width"]
    own_page.get_by_role("button", name="Collapse panel area").first.click()
    until(lambda: stage_box(own_page)["width"] > before + 150, "a broader stage")


def axe_finds_nothing_serious(page):
    """In the page as it comes, with all folders open, and in the tab of costs."""
    unfold(page, "Method details", "Effects: compute")
    until(lambda: serious(page) == [], "names for all in Explore")
    for tab in ("Lessons", "Cost", "About"):
        page.get_by_role("tab", name=tab).click()
        until(lambda: serious(page) == [], f"names for all in {tab}")


def serious(page):
    found = Axe().run(page, options={"resultTypes": ["violations"]}).response["violations"]
    return [(violation["id"], [node["html"][:160] for node in violation["nodes"]]) for violation in found
            if violation["impact"] in ("serious", "critical")]


def test_places(page):
    """One visitor for both: a page of their own would cost each more than what is looked at. So below."""
    everything_has_a_place_of_its_own(page)
    the_word_beside_a_control_that_waits_takes_no_room(page)


def test_windows_that_change(page):
    the_run_goes_on_when_the_window_changes(page)
    the_open_tab_stays_open_when_the_window_changes(page)
    a_phone_finds_the_measurements(page)


def test_those_who_do_not_see(page):
    axe_finds_nothing_serious(page)
