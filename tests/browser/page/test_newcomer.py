"""A newcomer's first minute: the opening and its story, three sparks by keyboard alone, and a run that is lost. Every
number that the page answers with is that of the same run without a page."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from app.page.story import OPENING
from app.words import per_cent
from solvers.running.run import run
from tests.browser.conftest import visit
from tests.browser.driving import scene, until
from tests.browser.page.test_first_picture import summary

LONG = 60.0  # seconds of patience for what takes a period


def norms(of, quantity, periods=1.0):
    """The mean true error of a run over so many periods, and the run."""
    result = run(replace(of, periods=periods, t_end=None), prices=False)
    return float(np.mean(result.series[f"error_{quantity}"])), result


def sparks(page):
    """What stands under the headline."""
    return page.locator("#lab-sparks").inner_text()


def tab_to(page, name):
    """Go on by Tab alone until a button of this name has the focus, if it has not got it, and see that it shows."""
    for _ in range(40):
        if page.evaluate("document.activeElement.textContent").startswith(name):
            assert page.evaluate("getComputedStyle(document.activeElement).outlineStyle") == "solid"
            return
        page.keyboard.press("Tab")
    raise AssertionError(f"no way to {name}")


def test_three_sparks_by_keyboard_alone(server, chromium):
    """From the first picture on: the story is left by a key, and each answer is checked against the solver."""
    with visit(chromium, server[0], "#") as page:
        until(lambda: "exact stress" in summary(page), "the first beat", LONG)
        assert scene(page)["method"] == "mpm" and page.locator("body.lab-story-told").count()
        page.keyboard.press("Escape")
        until(lambda: "Try one" in sparks(page), "the sparks", LONG)
        until(lambda: summary(page).startswith("At t = "), "the quarter of a period", LONG)
        both = [run(one, prices=False) for one in (OPENING.scene, OPENING.pinned)]
        wrong, estimate = (both[0].series[f"{name}_sigma"][-1] for name in ("error", "recovered/estimate"))
        share, found = per_cent(wrong / OPENING.scene.size_of("sigma")), per_cent(estimate / wrong)
        said = f"At t = 0.25 s the stress is {share} wrong; recovered finds {found} of it. "
        until(lambda: summary(page).startswith(said), said)

        tab_to(page, "Halve the cells")
        page.keyboard.press("Enter")
        until(lambda: "The answer" in sparks(page), "an answer", LONG)
        before = replace(OPENING.scene, estimators=())  # they change nothing of it
        wrong, fine = norms(before, "sigma")[0], norms(replace(before, cells=80), "sigma")[0]
        rose = float(re.search(r"It rose to (\S+) times as much", sparks(page))[1])
        assert rose == pytest.approx(fine / wrong, rel=0.01)

        tab_to(page, "Next: Smooth the crossing")  # which hat functions do already: uGIMP instead
        page.keyboard.press("Enter")
        until(lambda: "errs" in sparks(page), "another answer", LONG)
        smooth, result = norms(replace(before, method="ugimp"), "sigma")
        assert float(re.search(r"errs (\S+) times as much", sparks(page))[1]) == pytest.approx(smooth / wrong, rel=0.01)
        assert f"{result.series['crossings'][-1]:,.0f} crossings" in sparks(page)

        tab_to(page, "Next: Break it")
        page.keyboard.press("Enter")
        until(lambda: "What now?" in sparks(page), "a lost run", LONG)
        broken = norms(replace(before, method="mpm", amplitude=0.1), "x", 1.5)[1]
        assert f"lost from t = {broken.broken_at:.4g} s on" in summary(page) or "unstable" in summary(page)

        tab_to(page, "See the moment it broke")
        page.keyboard.press("Enter")
        until(lambda: re.match(r"\S+ periods back|At t = ", summary(page)), "the moment before", LONG)
        if shown := re.match(r"At t = (\S+) s", summary(page)):  # which of the frames before it a busy page has kept
            assert float(shown[1]) <= broken.broken_at + 0.05  # it may be said with one decimal
        tab_to(page, "Switch on two remedies")
        page.keyboard.press("Enter")
        until(lambda: scene(page)["remedies"] == ["null-space-filter", "coupled-deformation"], "the remedies")
        until(lambda: "So far the displacement is " in summary(page), "a run that holds", LONG)
        assert "lost" not in summary(page)


def test_the_story_is_told_once_and_again_when_asked(server, chromium):
    """To who has not seen it and follows no link; by a button in About, or by its address."""
    with visit(chromium, server[0], "#") as page:
        until(lambda: "exact stress" in summary(page), "the first beat", LONG)
        page.get_by_role("button", name="Skip the story").click()
        until(lambda: "Try one" in sparks(page), "the sparks")
        page.evaluate("history.replaceState(null, '', location.pathname + location.search)")
        page.reload()
        until(lambda: "Try one" in sparks(page), "the same scene, and no story", LONG)
        assert not page.locator("body.lab-story-told").count()
        page.get_by_role("tab", name="About").click()
        page.get_by_role("button", name="Replay the story").click()
        # Its first beat is over in seconds, which a busy browser may not see.
        until(page.locator("body.lab-story-told").count, "the story again", LONG)


def test_a_link_tells_no_story(page):
    """Whoever follows one sees its scene, as all visitors of these tests do."""
    assert not page.locator("body.lab-story-told").count() and "Halve the cells" in sparks(page)
