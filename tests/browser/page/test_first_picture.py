"""What a visitor sees first: nothing half made, then a picture. What its sentence says is in
``tests/app/page/test_summary.py`` and, against the solver, in ``test_newcomer.py``."""

from __future__ import annotations

from contextlib import contextmanager

from tests.browser.driving import PATIENCE, coloured, stage, until
from tests.processes import STARVED

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


@contextmanager
def newcomer(chromium):
    """A visitor before the page is there, with the patience of all others. A page that stayed would go on drawing."""
    page = chromium.new_page(viewport={"width": 1280, "height": 720})
    page.set_default_timeout(1e3 * STARVED * PATIENCE)
    try:
        yield page
    finally:
        page.close()


def summary(page):
    """The sentence, without what keeps "0.25–0.30" and "25 mm" in one line."""
    return page.locator("#lab-summary[role=status]").inner_text().replace("\N{WORD JOINER}", "") \
        .replace("\N{NO-BREAK SPACE}", " ").replace("\n", " ")


def test_nothing_half_made_is_ever_seen(server, chromium):
    """From the first picture on the ground covers the viewer's own panel, until there is a stage; then it is away."""
    with newcomer(chromium) as page:
        page.add_init_script(LOOK)
        page.goto(f"{server[0]}/?fixedDpr=1", wait_until="commit")
        page.locator("#lab-ground").wait_for()
        assert page.title() == "mpm-lab"
        page.locator("#lab-ground").wait_for(state="hidden")
        until(lambda: coloured(stage(page)) > 0.05, "two coloured lanes and a colour bar")
        assert page.evaluate("[window.covered > 0, window.bare]") == [True, 0]
