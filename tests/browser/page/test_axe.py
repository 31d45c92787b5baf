"""What axe, the checker of accessibility, finds wrong with the page in every state: nothing."""

from __future__ import annotations

from contextlib import suppress

import pytest

from tests.browser.conftest import SIZE, axe_finds, visit
from tests.browser.driving import click, unfold, until
from tests.browser.page.test_room import STATES


def serious(page):
    return [(violation["id"], [node["html"][:160] for node in violation["nodes"]]) for violation in axe_finds(page)]


def nothing_serious(page, where):
    """Wait until axe finds nothing there; it looks through the whole page, which takes a second, and so no more often
    than need be."""
    try:
        until(lambda: serious(page) == [], where)
    except AssertionError:
        raise AssertionError(f"names for all in {where}: {serious(page)}") from None


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_axe_finds_nothing(server, chromium, scheme):
    """In the page as it comes, with folders open, and in every tab."""
    with visit(chromium, server[0], "#", color_scheme=scheme) as page:
        page.locator("body.lab-to-see").wait_for(timeout=60_000)
        until(lambda: page.locator("body.lab-dark").count() == (scheme == "dark"), scheme)
        unfold(page, "Method details", "Effects: compute")
        nothing_serious(page, "Explore")
        for tab in ("Lessons", "Cost", "About"):
            page.get_by_role("tab", name=tab).click()
            nothing_serious(page, tab)


def in_a_lesson(page):
    click(page, "Next")
    until(page.get_by_role("radiogroup", name="Answer").is_visible, "a question")


def a_refusal(page):
    page.get_by_label("Amplitude A, typed", exact=True).fill("0.3")
    page.get_by_label("Amplitude A, typed", exact=True).press("Enter")
    page.locator("[data-answer]").wait_for()


def keys_listed(page):
    page.keyboard.press("?")
    until(page.get_by_role("dialog", name="Keys").is_visible, "the list of keys")


def an_answer(page):
    page.keyboard.press("1")
    until(page.locator(".lab-answer").is_visible, "an answer", 60)


def nobody_judging(page):
    until(page.get_by_role("button", name="Switch on companion").is_visible, "somebody offered")


#: Links, and what is done there, to come into each state of the page that axe sees.
AXED = {"lost": (STATES["a run gone bad"], lambda page: until(page.locator("body.lab-lost").count, "a lost run", 90)),
        "a pinned run and an answer": ("bar;estimators=recovered", an_answer),
        "nobody judging": ("bar;estimators=", nobody_judging),
        "refused": ("bar;estimators=recovered", a_refusal),
        "ring": ("ring;estimators=companion,transport", None),
        "vortex": ("vortex;estimators=transport", None),
        "slow motion": ("bar;estimators=recovered", lambda page: click(page, "Slow motion")),
        "a lesson": ("lesson=04-grid-crossing", in_a_lesson),
        "keys": ("bar;estimators=recovered", keys_listed),
        "presented": ("bar;estimators=recovered", lambda page: click(page, "Present")),
        "a code": ("bar;estimators=recovered", lambda page: click(page, "QR code"))}


@pytest.mark.slow  # what any state has, the tabs above have in small
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_axe_finds_nothing_in_any_state(server, chromium, scheme):
    """One page, which is loaded anew for each."""
    page = chromium.new_page(viewport=SIZE, color_scheme=scheme)
    found = {}
    try:
        for state, (link, act) in AXED.items():
            page.goto("about:blank")
            page.goto(f"{server[0]}/?fixedDpr=0.5#{link}")
            page.locator("body.lab-to-see").wait_for(timeout=60_000)
            until(lambda: page.locator("#lab-stage .lab-label").count() > 3, "a stage")
            if act:
                act(page)
            with suppress(AssertionError):
                nothing_serious(page, state)
            found[state] = serious(page)
    finally:
        page.close()
    assert found == {state: [] for state in AXED}


def test_signs_are_seen_in_the_browsers_own_colours(server, chromium):
    """Forced colours take away the grounds by which signs are drawn: these keep one, and what is chosen has a rim."""
    with visit(chromium, server[0], forced_colors="active") as page:
        grounds = page.evaluate("""() => {
            const ground = (e, part) => getComputedStyle(e, part).backgroundColor;
            return [...document.querySelectorAll("[data-lab~=lab-at-run] + div button")]
                .map(button => [ground(button), ground(button, "::before")]); }""")
        chosen = page.locator(".lab-method.lab-chosen").evaluate("e => getComputedStyle(e).outlineStyle")
    assert [sign for ground, sign in grounds if ground != "rgb(0, 0, 0)"] == ["rgb(0, 0, 0)"] * 4
    assert chosen == "solid"
