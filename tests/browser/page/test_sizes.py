"""Room: in every window all has a place of its own, and what is written stays with what it names."""

import os
import signal

import pytest

from tests.browser.conftest import visit
from tests.browser.driving import choose, click, coloured, readout, stage, stage_box, steps, to_the_ring, unfold, until

LARGE, LAPTOP, SMALL, UPRIGHT, PHONE = (1920, 1080), (1280, 720), (1024, 768), (800, 1100), (390, 844)
ENLARGED = (640, 360), (960, 540)  # a laptop's window and a large one, at 200 %
#: What may lie over nothing else: the head, what is said, the stage, the deck and the controls.
PARTS = ("#lab-head", "#lab-summary", "#lab-stage", "#lab-deck", "[data-dock-region=right]",
         ".mantine-Paper-root[style*='position: fixed']")


def resize(page, size):
    page.set_viewport_size({"width": size[0], "height": size[1]})


def boxes(page):
    """Head, sentence, stage, deck and panel, as (left, top, right, bottom)."""
    return page.evaluate("""parts => parts.map(s => document.querySelector(s))
        .filter(e => e && e.getBoundingClientRect().width > 0)
        .map(e => { const r = e.getBoundingClientRect(); return [r.left, r.top, r.right, r.bottom]; })""", PARTS)


def overlap(a, b):
    """How many pixels two boxes share in each direction."""
    return min(a[2], b[2]) - max(a[0], b[0]), min(a[3], b[3]) - max(a[1], b[1])


def fitted(page):
    """The stage's box is where the canvas is, and as large as there is room in one direction: 1.5 pixels of rounding,
    and a hundredth of the height to which the stage is drawn."""
    return page.evaluate("""() => {
        const box = e => e.getBoundingClientRect(), room = box(document.getElementById("lab-room"));
        const stage = box(document.getElementById("lab-stage"));
        const canvas = box(document.querySelector("[data-dock-root] > div:first-child"));
        const same = ["left", "top", "right", "bottom"].every(side => Math.abs(stage[side] - canvas[side]) < 1.5);
        const wide = stage.width / 1.03 > 0.985 * room.width, high = stage.height > 0.96 * room.height;
        return same && stage.bottom < room.bottom + 8 && (wide || high); }""")


def disorder(page, size):
    """Parts that are missing, lie over another or out of the window, and panels with more to the right than is seen."""
    places = boxes(page)
    found = [] if len(places) == 5 else [f"{len(places)} parts"]
    found += [a for a in places if a[0] < -1 or a[1] < -1 or a[2] > size[0] + 1 or a[3] > size[1] + 1]
    found += [(a, b) for k, a in enumerate(places) for b in places[:k] if min(overlap(a, b)) > 1]
    return found + page.evaluate("""() => {
        const clipped = (x, e) => x !== e && (getComputedStyle(x).overflow === "hidden" || clipped(x.parentElement, e));
        return [...document.querySelectorAll('.mantine-ScrollArea-viewport')]
            .filter(e => e.clientWidth && e.scrollWidth > e.clientWidth + 1).map(e => [e.clientWidth, e.scrollWidth,
                ...[...e.querySelectorAll("*")].filter(x => x.getBoundingClientRect().right
                    > e.getBoundingClientRect().right + 1 && !clipped(x.parentElement, e))
                    .map(x => x.outerHTML.slice(0, 200)).slice(-3)]);
    }""")


def everything_has_a_place_of_its_own(page, sizes):
    """In windows of these sizes; and nothing written lies over anything else written, of labels on the stage, the names
    beside it, the deck's and the boxes laid among them."""
    for size in sizes:
        resize(page, size)
        until(lambda: fitted(page), f"the stage fitted into {size}")
        none_in(page, size, written_over)
        if size not in ENLARGED:
            until(lambda: coloured(stage(page)) > 0.002, "a stage with colours")
            none_in(page, size, lambda page: disorder(page, size))  # noqa: B023


def none_in(page, size, wrong):
    """Wait until a look at the page finds nothing wrong; else say what is."""
    try:
        until(lambda: wrong(page) == [], f"all in order in {size}")
    except AssertionError as error:
        raise AssertionError(f"{error}: {wrong(page)}") from None


def written_over(page):
    """Pairs of texts that share more than two pixels in both directions."""
    return page.evaluate("""() => {
        const range = document.createRange();
        const heard = e => e && (getComputedStyle(e).clipPath !== "none" || heard(e.parentElement));  // and not seen
        const all = [...document.querySelectorAll(".lab-label, .lab-names > *, .lab-axis > span, #lab-clock, "
            + "[data-lab~=lab-at-quantity] + div input, [data-lab~=lab-at-estimator] + div input, "
            + "[data-lab~=lab-at-speed] + div label, [data-lab~=lab-at-speed] + div input, "
            + "#lab-summary > span, #lab-sparks > button, #lab-sparks > .lab-answer")]
            .filter(e => !heard(e) && e.checkVisibility({visibilityProperty: true, opacityProperty: true}))
            .filter(e => e.textContent.trim() || e.value).map(e => {
                if (!e.value) range.selectNodeContents(e);
                const r = e.value ? e.getBoundingClientRect() : range.getBoundingClientRect();
                const above = e.value ? parseFloat(getComputedStyle(e).paddingTop) : 0;  // it can be pressed there, too
                const below = e.matches(".lab-facts") ? e.getBoundingClientRect().bottom : r.bottom;  // more is hidden
                return [(e.textContent.trim() || e.value).slice(0, 40), r.left, r.top + above, r.right, below]; })
            .filter(r => r[3] > r[1]);
        return all.flatMap((a, k) => all.slice(0, k).filter(b => Math.min(a[3], b[3]) - Math.max(a[1], b[1]) > 2
            && Math.min(a[4], b[4]) - Math.max(a[2], b[2]) > 2).map(b => `${a[0]} / ${b[0]}`)); }""")


def cut_off(page):
    """Words that end in dots for want of room, or at the window's edge; facts below the headline may, for their end is
    a hint, and further words are under the pointer."""
    return page.evaluate("""() => {
        const heard = e => e && (getComputedStyle(e).clipPath !== "none" || heard(e.parentElement));  // and not seen
        const seen = e => e.checkVisibility({visibilityProperty: true, opacityProperty: true}) && e.clientWidth > 1
            && !heard(e);
        const boxed = [...document.querySelectorAll("#lab-sparks :is(b, small), .mantine-Text-root:has(> label), "
            + ".lab-judge *, .lab-method, #lab-head [role=radio], "
            + "div[data-lab*=lab-at-] + div input.mantine-Select-input")].filter(seen)
            .filter(e => e.scrollWidth > e.clientWidth + 1).map(e => e.textContent || e.value);
        const range = document.createRange();
        const beyond = [...document.querySelectorAll(".lab-label, .lab-axis > span, #lab-clock")].filter(seen)
            .filter(e => {
                range.selectNodeContents(e);
                const r = range.getBoundingClientRect();
                return r.width && (r.left < -1 || r.right > innerWidth + 1); }).map(e => e.textContent);
        return [...boxed, ...beyond]; }""")


#: What has the most to say: a run that is lost and says why, with an estimator that does not hold, and a pinned run.
STATES = {"a run gone bad": "bar;method=mpm;amplitude=0.1;estimators=companion,transport;speed=4",
          "a lost patch test": "bar;motion=patch;method=mpm;cells=20;ppc=2.5;modulus=1000;cfl=0.2",
          "a pinned run": "bar;method=mpm;estimators=recovered;error-of=sigma;pinned;method=bspline"}


@pytest.mark.parametrize("state", ["a run gone bad", "a lost patch test",
                                   pytest.param("a pinned run", marks=pytest.mark.slow)])
def test_words_in_every_state(server, chromium, state):
    """Whatever there is to be said has room in windows of all sizes."""
    with visit(chromium, server[0], f"#{STATES[state]}") as page:
        until(lambda: page.locator("#lab-stage .lab-label").count() > 5, "words on the stage")
        if state != "a pinned run":
            until(page.locator("body.lab-lost").count, "a lost run", 90)
            assert "run" in page.locator("#lab-summary").inner_text()
        for size in (LAPTOP, LARGE, SMALL, UPRIGHT, PHONE):
            resize(page, size)
            until(lambda size=size: fitted(page), f"the stage fitted into {size}")
            for wrong in (written_over, cut_off):
                none_in(page, size, wrong)


def the_open_tab_stays_open_when_the_window_changes(page):
    """The viewer makes its tabs anew for a narrow window, and for a wide one."""
    def opened(name):
        return page.get_by_role("tab", name=name, exact=True, selected=True).is_visible()

    resize(page, LAPTOP)
    for size, tab in ((PHONE, "Cost"), (LAPTOP, "Lessons"), (PHONE, "Explore"), (LAPTOP, "Explore")):
        page.get_by_role("tab", name=tab, exact=True).click()
        until(lambda tab=tab: opened(tab), f"{tab} opened")
        resize(page, size)
        until(lambda size=size: page.locator("[data-dock-region=right]").count() == (size != PHONE), "another layout")
        until(lambda tab=tab: opened(tab), f"{tab} open again")


def the_run_goes_on_when_the_window_changes(page):
    """The browser makes the page's widgets anew then, and says again which link it has: that is no wish."""
    until(lambda: steps(page) > 20, "a run under way")
    click(page, "Pause")
    until(lambda: "paused" in readout(page), "paused")
    at = steps(page)
    for size in (PHONE, LAPTOP):
        resize(page, size)
        until(lambda size=size: page.locator("[data-dock-region=right]").count() == (size != PHONE), "another layout")
    until(page.locator(".lab-readout").count, "the readout")
    assert "paused" in readout(page) and steps(page) == at


@pytest.mark.slow
def test_places(page):
    """One visitor for both shapes of stage: a page of their own would cost each more than what is looked at. So
    below. The bar has every size, the ring the highest, the widest and the narrowest."""
    unfold(page, "All numbers of this run")  # its table is the widest thing of the panel
    to_the_ring(page)
    everything_has_a_place_of_its_own(page, (LARGE, UPRIGHT, PHONE))
    resize(page, LAPTOP)
    choose(page, "Problem", "vibrating bar")
    everything_has_a_place_of_its_own(page, (LAPTOP, LARGE, SMALL, UPRIGHT, PHONE, *ENLARGED))


@pytest.mark.slow
def test_windows_that_change(page):
    the_run_goes_on_when_the_window_changes(page)
    the_open_tab_stays_open_when_the_window_changes(page)


@pytest.mark.slow
def test_the_stage_follows_a_window_without_the_server(server, chromium):
    """Its process stands still meanwhile: what is written stays where it was on the picture."""
    with visit(chromium, server[0]) as page:
        until(lambda: fitted(page) and page.locator("#lab-stage .lab-label").count() > 5, "labels on the stage")
        click(page, "Pause")

        def places():
            return page.evaluate("""() => {
                const box = document.querySelector("[data-dock-root] > div:first-child").getBoundingClientRect();
                return Object.fromEntries([...document.querySelectorAll("#lab-stage .lab-label:not(.lab-role-gutter)")]
                    .map(e => { const r = e.getBoundingClientRect();
                        const dx = {"lab-to-center": 0.5, "lab-to-right": 1}[[...e.classList].find(
                            c => ["lab-to-center", "lab-to-right"].includes(c))] || 0;
                        return [e.dataset.key, [(r.left + dx * r.width - box.left) / box.width, box.width]]; })); }""")

        until(lambda: "paused" in readout(page), "paused")
        until(lambda: places() == (page.wait_for_timeout(800), places())[1], "the last words of the moment")
        before = places()
        os.kill(server[1], signal.SIGSTOP)
        try:
            resize(page, (1100, 640))
            until(lambda: stage_box(page)["width"] < 0.95 * next(iter(before.values()))[1], "a smaller stage")
            until(lambda: fitted(page), "the stage fitted")
            assert before.keys() == places().keys()
            until(lambda: all(abs(before[key][0] - at[0]) < 2e-3 for key, at in places().items()), "within a pixel")
        finally:
            os.kill(server[1], signal.SIGCONT)
