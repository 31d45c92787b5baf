"""What axe, the checker of accessibility, finds wrong with the page in every state: nothing."""

import pytest

from tests.browser.conftest import PHONE, axe_finds, visit
from tests.browser.driving import click, row, summary, to_the_ring, unfold, until
from tests.browser.page.test_present import presented, small


def serious(page):
    return [(violation["id"], [node["html"][:160] for node in violation["nodes"]]) for violation in axe_finds(page)]


def nothing_serious(page, where):
    """Wait until axe finds nothing there; it looks through the whole page, which takes a second, and so no more often
    than need be."""
    try:
        until(lambda: serious(page) == [], where)
        until(lambda: small(page, 12) == [], where)
    except AssertionError:
        raise AssertionError(f"names for all in {where}: {serious(page)}, {small(page, 12)}") from None


@pytest.mark.parametrize("scheme", [pytest.param("light", marks=pytest.mark.short),
                                    pytest.param("dark", marks=pytest.mark.slow)])
def test_axe_finds_nothing(server, chromium, scheme):
    """In the page as it comes, in its tour, at rest, with folders open, in every tab, as slides, with a body of the
    plane and on a phone; nor is anything too small to be read."""
    with visit(chromium, server[0], "#", color_scheme=scheme) as page:
        page.locator("body.lab-to-see").wait_for(timeout=60_000)
        until(lambda: page.locator("body.lab-dark").count() == (scheme == "dark"), scheme)
        assert page.locator("body.lab-story-told").count()
        nothing_serious(page, "the tour")
        page.keyboard.press("Escape")
        until(lambda: not page.locator("body.lab-story-told").count(), "the page after it")
        nothing_serious(page, "the end of the tour")
        page.keyboard.press("Space")
        row(page, "Amplitude A").get_by_role("slider").focus()
        until(page.locator(".lab-speaks .lab-read").is_visible, "a row that speaks")
        nothing_serious(page, "the page at rest")
        unfold(page, "Method details", "What is computed")
        nothing_serious(page, "Explore")
        for tab in ("Lessons", "Cost", "About"):
            page.get_by_role("tab", name=tab).click()
            nothing_serious(page, tab)
        page.get_by_role("tab", name="Explore").click()
        click(page, "Present")
        until(lambda: presented(page), "the presenter's view")
        nothing_serious(page, "slides")
        page.keyboard.press("Escape")
        until(lambda: not presented(page), "the page as it was")
        to_the_ring(page)
        until(lambda: "wrong" in summary(page), "the ring")
        nothing_serious(page, "the ring")
        page.set_viewport_size(PHONE)
        until(lambda: page.locator("[data-dock-region=right]").count() == 0, "the sheet")
        nothing_serious(page, "a phone")


@pytest.mark.slow
def test_signs_are_seen_in_the_browsers_own_colours(server, chromium):
    """Forced colours take away the grounds by which signs are drawn: these keep one, and what is chosen has a rim."""
    with visit(chromium, server[0], forced_colors="active") as page:
        grounds = page.evaluate("""() => {
            const ground = (e, part) => getComputedStyle(e, part).backgroundColor;
            return [...document.querySelectorAll("[data-lab~=lab-at-run] + div button")]
                .map(button => [ground(button), ground(button, "::before")]); }""")
        chosen = page.locator(".lab-method[aria-checked=true]").evaluate("e => getComputedStyle(e).outlineStyle")
    assert [sign for ground, sign in grounds if ground != "rgb(0, 0, 0)"] == ["rgb(0, 0, 0)"] * 4
    assert chosen == "solid"
