"""What the page says of a verdict that is of positions alone, of what nobody looked at, and of errors that are none."""

from __future__ import annotations

import json
from dataclasses import replace
from types import SimpleNamespace

from app.page.panels.readout import ROUNDED, judged, readout
from app.page.stage.worst import WorstRegions
from app.page.visit.history import History
from app.page.visit.notice import doubt
from solvers.problems.bar.scene import BarScene
from solvers.running.goals import ENERGY
from solvers.running.run import build
from solvers.study.coverage import track_record
from tests.app.frame.test_view import report_of

BAR = BarScene(cells=12, ppc=2, estimators=("companion",))
NAMED = "positions hold, but the velocity is off by up to 18 times its own size, from t = 0.5 s on"


def watched(scene: BarScene) -> tuple[History, SimpleNamespace]:
    """A history of some hundred steps, and a session that has it."""
    solver, history = build(scene), History(scene, scene.particles)
    history.add(solver.measure())
    history.add(solver.advance(300))
    return history, SimpleNamespace(pinned=None, history=history, speed=1.0, ended=False)


def test_a_run_that_is_ok_for_positions_alone_says_so_in_its_readout():
    """The headline is of the quantity that one looks at, and nothing covers the stage for the others."""
    history, session = watched(BAR)
    for reason in (None, NAMED):
        report = replace(report_of(BAR), reason=reason)
        html = readout(session, history, report, "x", None, None, WorstRegions()).html
        assert (NAMED in html) == (reason is not None)
    assert doubt(history, ("companion",)) is None


def test_what_nobody_looked_at_is_a_line_of_the_readout():
    history, session = watched(BAR)
    report = replace(report_of(BAR), step=300, time=300 * BAR.time_step)
    said = readout(session, history, replace(report, not_checked="velocity & stress"), "x", None, None, WorstRegions())
    assert "velocity &amp; stress" in said.html
    assert "unseen" not in readout(session, history, report, "x", None, None, WorstRegions()).html


def test_numbers_of_the_body_have_a_bar_by_who_is_on_the_stage():
    """And how often such bars held; without an estimator, or back in time, no bar and no number."""
    history, session = watched(BAR)
    energy = {"value": 0.0062, "unit": "J", "true_error": None, "estimated_error": {"companion": -1e-5},
              "rounding": 0.0, "bar": {"companion": 2e-5}}
    report = replace(report_of(BAR), step=300, time=300 * BAR.time_step, goals={ENERGY: energy})
    held, of = track_record.held(BAR, ENERGY, "companion")
    html = readout(session, history, report, "x", "companion", None, WorstRegions()).html
    assert "kinetic energy" in html and f"6.2 mJ ± 20 µJ; such bars held in {held} of {of} runs like this" in html
    html = readout(session, history, report, "x", None, None, WorstRegions()).html
    assert "6.2 mJ" in html and "±" not in html.partition("6.2 mJ")[2].partition("</td>")[0]
    assert "6.2 mJ" not in readout(session, history, report, "x", None, None, WorstRegions(), ago=0.1).html


def test_an_error_that_is_nothing_but_rounding_has_no_index_on_the_page():
    patch = BarScene(motion="patch", cells=12, ppc=2, estimators=("companion",))
    for scene, rounded in ((patch, True), (BAR, False)):
        history, session = watched(scene)
        report = replace(report_of(scene), step=300, time=300 * scene.time_step)
        html = readout(session, history, report, "v", "companion", None, WorstRegions()).html
        card = json.loads(judged(report, history.series, "v", "companion"))["judges"]["companion"]
        assert (ROUNDED in html) == rounded
        assert ("index" not in card and card["says"] == "Nothing but rounding") == rounded
