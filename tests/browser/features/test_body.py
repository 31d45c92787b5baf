"""A body from a file in a real browser: opened from the menu, run again by a slider, looked through
by keys, refused where it is no body."""

import json
import re

import pytest

from app.cli import main
from solvers.bodies.body_file import library_text
from tests.browser.driving import click, scene, until
from tests.browser.features.test_own_file import DROP, notice
from tests.browser.page.test_axe import nothing_serious
from tests.support.session_listener import PATIENCE

pytestmark = pytest.mark.slow
VALUE = r"([−\d.]+) m, ± ([\d.]+) m\."


def verdict(page):
    return page.locator("#lab-summary").inner_text().replace("\N{NO-BREAK SPACE}", " ")


def finished(page):
    """The value and the bar in the verdict of a run that has ended."""
    until(lambda: re.search(VALUE, verdict(page)) and "so far" not in verdict(page), "the whole run", PATIENCE)
    return tuple(float(text.replace("−", "-")) for text in re.search(VALUE, verdict(page)).groups())


def clock(page):
    return page.locator("#lab-clock").inner_text()


def open_block(page):
    page.locator("#lab-head [aria-haspopup=menu]").click()
    page.get_by_role("menuitem", name="Thrown block").click()


def test_the_verdict_says_what_the_command_line_says_and_a_slider_runs_the_body_again(page, tmp_path):
    """To the digits that are shown: two of the bar."""
    file, out = tmp_path / "block.toml", tmp_path / "block.json"
    file.write_text(library_text("thrown_block"), encoding="utf-8")
    assert main(["run", str(file), "--json", str(out), "--quiet"]) == 0
    goal = json.loads(out.read_text())["goals"]["corner"]
    problem = scene(page)["problem"]
    open_block(page)
    value, bar = finished(page)
    assert value == pytest.approx(goal["value"], abs=5.1e-5)
    assert bar == pytest.approx(goal["bar"], abs=5.1e-5)
    cells = page.get_by_label("Cells per metre").locator("visible=true").first
    cells.focus()
    page.keyboard.press("End")  # four times as many
    until(lambda: re.search(VALUE, verdict(page)) and finished(page) != (value, bar), "the finer run", PATIENCE)
    finer, finer_bar = finished(page)
    assert finer_bar < bar
    assert abs(finer - value) < bar + finer_bar
    click(page, "Back to our run")
    until(lambda: "wrong" in verdict(page) and scene(page)["problem"] == problem, "our run", PATIENCE)


def test_a_file_that_is_no_body_is_refused_and_the_body_stays(page):
    open_block(page)
    before = finished(page)
    until(lambda: page.locator("body.lab-playing").count() == 0, "its last frame", PATIENCE)
    nothing_serious(page, "a body on the stage")
    end = clock(page)
    page.keyboard.press("ArrowLeft")
    until(lambda: clock(page) not in ("", end), "the frame before")
    page.locator(".lab-axis").hover(position={"x": 200, "y": 20})
    until(lambda: "x = " in page.locator(".lab-axis .lab-read:visible").inner_text(), "the value under the pointer")
    bad = library_text("thrown_block").replace("poissons_ratio = 0.3", "poissons_ratio = 0.6")
    page.evaluate(DROP, ["bad.toml", bad])
    until(lambda: "bad.toml" in notice(page), "the refusal", PATIENCE)
    assert "give a number from 0 to 0.49" in notice(page)
    assert finished(page) == before
