"""What a visitor sees first: nothing half made, then a picture that speaks for itself."""

from __future__ import annotations

import re
from contextlib import contextmanager

import numpy as np
import pytest

from app.colours import colour_table
from app.page.summary import SAY_SECONDS
from app.words import size_in
from tests.browser.conftest import serving
from tests.browser.driving import PATIENCE, click, coloured, readout, row, stage, time, until
from tests.processes import STARVED
from tests.raw import Raw

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


@pytest.mark.slow
def test_a_refusal_is_not_covered(chromium):
    """Who finds every place taken reads so."""
    with serving(arguments=("--max-sessions", "1")) as (address, _), Raw(address) as first, newcomer(chromium) as page:
        until(lambda: first.frames, "somebody in the only place")
        page.goto(address)
        page.get_by_text("Every place on this server is taken.").wait_for()
        page.locator("#lab-ground").wait_for(state="hidden")


def test_sentence_says_what_the_numbers_say(page):
    """Recovered against the truth, transport beside it; of a moment the sentence has the table's norms, their ratio and
    its worst region."""
    until(lambda: re.match(r"So far the displacement is 0\.\d+ % wrong; recovered (finds (9\d|100) % of it|"
                           r"says 1\.\d\d times as much)\. \S+ .m of 25 mm at most\. Worst at X = 0\.\d\d–\d\.\d\d m\. "
                           r"(\d+|No) particles? crossed a cell boundary in the last 0.2 s\.$", summary(page)),
          "the sentence")
    click(page, "Pause")
    until(lambda: summary(page).startswith("At t = ") and "paused" in readout(page), "the pause said")
    read = ""  # the sentence stands for a while before it is replaced by that of the very last frame
    while read != (read := summary(page) + readout(page)):
        page.wait_for_timeout(1.5e3 * SAY_SECONDS)
    true, estimated = (size_in(re.search(rf"{name}\s+([\d.]+ \S?m)", readout(page))[1], "m")
                       for name in ("true", "recovered"))
    said = summary(page)
    assert float(re.search(r"is (\S+) % wrong", said)[1]) == pytest.approx(100 * true / 0.025, rel=0.05)
    found = re.search(r"recovered finds (\S+) % of it", said), re.search(r"recovered says (\S+) times as much", said)
    index = float(found[0][1]) / 100 if found[0] else float(found[1][1])
    assert index == pytest.approx(estimated / true, rel=0.02)
    region = re.search(r"Worst at (X = \S+ m)", said)[1]
    assert re.search(rf"true\s+{region}", readout(page))


@pytest.mark.parametrize("size", [(1280, 720), pytest.param((1920, 1080), marks=pytest.mark.slow)])
def test_sentence_covers_nothing(page, size):
    """It stands between the panels, above the colour bar and its title."""
    page.set_viewport_size({"width": size[0], "height": size[1]})
    colours = {tuple(c) for c in colour_table().tolist()}

    def first_coloured():
        picture = stage(page)[:, 60:-60:4]
        rows = [y for y in range(len(picture)) if np.mean([tuple(c) in colours for c in picture[y].tolist()]) > 0.5]
        return min(rows, default=0)

    until(lambda: first_coloured() > 0, "the colour bar")
    until(lambda: summary(page), "the sentence")
    box = page.locator("#lab-summary").bounding_box()
    title = 24  # pixels, of the colour bar's title
    until(lambda: box["y"] > 0 and box["y"] + box["height"] < first_coloured() - title, "room for the sentence")
    panel = page.locator("[data-dock-region=right]").bounding_box()
    assert box["x"] >= 0 and box["x"] + box["width"] <= panel["x"]


def test_colours_use_the_map(page):
    """The largest error of a period has a colour of the upper quarter: the scale's top leaves no more unused."""
    index = {tuple(c): k for k, c in enumerate(colour_table().tolist())}

    def brightest():
        lanes = stage(page)[258:391].reshape(-1, 3)[::5].tolist()
        return max((index[tuple(c)] for c in lanes if tuple(c) in index), default=0)

    until(lambda: time(page) > 1, "a period")
    row(page, "Speed").get_by_role("slider").focus()
    for _ in range(60):
        page.keyboard.press("ArrowLeft")  # slowly: the largest error lasts for a moment only
    until(lambda: brightest() >= 0.75 * 255 - 1, "a colour of the upper quarter", 60)
