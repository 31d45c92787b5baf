"""A newcomer's first minute: nothing half made, then a picture; the opening and its tour, three sparks by keyboard
alone, and a run that is lost. Numbers: ``tests/app/page/test_opening_tour.py``, ``test_suggestions.py``."""

import re
from contextlib import closing

import pytest

from tests.browser.conftest import SIZE, visit
from tests.browser.driving import PATIENCE, coloured, scene, stage, summary, tab_to, until
from tests.support.processes import STARVED

LONG = 60.0  # seconds of patience for what takes a period
#: Looks at every frame that the browser paints: is the middle of the window covered, or is there a stage to see?
LOOK = """
window.covered = window.bare = 0;
const look = () => {
  if (document.querySelector('#root > *')) {
    const ground = document.getElementById('lab-ground');
    const top = document.elementFromPoint(innerWidth / 2, innerHeight / 2);
    if (ground && ground.contains(top)) window.covered++;
    else if (!document.querySelector('.lab-says')) window.bare++;
  }
  requestAnimationFrame(look);
};
look();
"""


@pytest.mark.slow
def test_nothing_half_made_is_ever_seen(server, chromium):
    """From the first picture on the ground covers the viewer's own panel, until there is a stage; then it is away."""
    with closing(chromium.new_page(viewport=SIZE)) as page:  # before the page is there
        page.set_default_timeout(1e3 * STARVED * PATIENCE)
        page.add_init_script(LOOK)
        page.goto(f"{server[0]}/?fixedDpr=1", wait_until="commit")
        page.locator("#lab-ground").wait_for()
        assert page.title() == "mpm-lab"
        page.locator("#lab-ground").wait_for(state="hidden")
        until(lambda: coloured(stage(page)) > 0.05, "two coloured lanes and a colour bar")
        assert page.evaluate("[window.covered > 0, window.bare]") == [True, 0]


def sparks(page):
    """What stands under the headline."""
    return page.locator("#lab-sparks").inner_text()


@pytest.mark.slow
def test_three_sparks_by_keyboard_alone(server, chromium):
    """From the first picture on: the story is left by a key, and each answer leads on."""
    with visit(chromium, server[0], "#") as page:
        until(lambda: "Material Point Method" in summary(page), "the first step", LONG)
        assert page.locator("body.lab-story-told").count()
        page.keyboard.press("Escape")
        until(lambda: "Try one" in sparks(page), "the sparks", LONG)
        until(lambda: "wrong; recovered finds" in summary(page), "how wrong it is, and whether it is known", LONG)
        assert scene(page)["method"] == "mpm"

        for button, seen, words in (
                ("Halve the cells", "The answer", "It rose to"),
                ("Next: Smooth the crossing", "crossings", "crossings"),  # what hat functions do: uGIMP instead
                ("Next: Break it", "What now?", "What now?")):
            tab_to(page, button)
            page.keyboard.press("Enter")
            until(lambda seen=seen: seen in sparks(page), seen, LONG)
            assert words in sparks(page)
        assert "lost from t = " in summary(page) or "unstable" in summary(page)

        tab_to(page, "See the moment it broke")
        page.keyboard.press("Enter")
        until(lambda: re.match(r"\S+ periods back|At t = ", summary(page)), "the moment before", LONG)
        tab_to(page, "Switch on two remedies")
        page.keyboard.press("Enter")
        until(lambda: scene(page)["remedies"] == ["null-space-filter", "coupled-deformation"], "the remedies")
        until(lambda: "So far the displacement is " in summary(page), "a run that holds", LONG)
        assert "lost" not in summary(page)


def test_the_story_is_told_once_and_again_when_asked(server, chromium):
    """To who has not seen it and follows no link; by a button in About, or by its address."""
    with visit(chromium, server[0], "#") as page:
        until(lambda: "Material Point Method" in summary(page), "the first step", LONG)
        page.get_by_role("button", name="Skip", exact=True).click()
        until(lambda: "Try one" in sparks(page), "the sparks")
        assert "Material Point Method" in page.locator("#lab-first-words").inner_text()
        page.locator("#lab-first-words button").click()
        assert not page.locator("#lab-first-words").count()
        page.evaluate("history.replaceState(null, '', location.pathname + location.search)")
        page.reload()
        until(lambda: "Try one" in sparks(page), "the same scene, and no story", LONG)
        assert not page.locator("body.lab-story-told").count()
        page.get_by_role("tab", name="About").click()
        page.get_by_role("button", name="Replay the introduction").click()
        # Its first step is over in seconds, which a busy browser may not see.
        until(page.locator("body.lab-story-told").count, "the story again", LONG)


def test_a_link_tells_no_story(page):
    """Whoever follows one sees its scene, as all visitors of these tests do."""
    assert not page.locator("body.lab-story-told").count() and "Halve the cells" in sparks(page)
