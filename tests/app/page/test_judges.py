"""Who judges a run: what the cards say, and that a name clicked is on the stage."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest

from app.frame.captions import UNKNOWN
from app.page.panels.readout import judged, place
from app.page.visit.history import History
from app.problems.views import VIEWS
from solvers.problems import PROBLEMS
from solvers.problems.bar.scene import BarScene
from solvers.running.run import build
from solvers.study.coverage import track_record
from tests.app.frame.test_view import report_of
from tests.processes import until
from tests.raw import Raw


def test_an_index_has_a_place_on_the_gauge():
    assert [place(index) for index in (0.1, 1.0, 10.0, 1e-9, 1e9, 0.0)] == [0.0, 0.5, 1.0, 0.0, 1.0, 0.0]
    assert place(float("nan")) is None
    assert place(1.1) > 0.5 > place(0.9)


def test_cards_say_what_the_run_has():
    """The numbers are the run's; who does not hold, or was not asked, has a sentence or nothing."""
    scene = BarScene(cells=10, ppc=2, periods=1, estimators=("transport", "recovered"))
    solver, history = build(scene), History(scene, 20)
    history.add(solver.advance(200))
    report = replace(report_of(scene), time=solver.time, not_valid={"recovered": "not valid here: why"})
    cards = json.loads(judged(report, history.series, "x", "transport"))
    assert (cards["problem"], cards["stage"], cards["known"]) == ("bar", "transport", True)
    assert set(cards["judges"]) == {"transport", "recovered"}
    index = history.series["transport/index_x"][-1]
    assert float(cards["judges"]["transport"]["index"]) == pytest.approx(index, abs=0.0051)
    held, of = track_record.right(scene, "transport")
    trust = cards["judges"]["transport"]["trust"]
    assert trust == f"right within 10\N{NO-BREAK SPACE}% in {held} of {of} runs like this"
    assert cards["judges"]["recovered"] == {"says": "Not valid here: why"}
    unknown = json.loads(judged(report_of(replace(scene, body_force="two-tone")), {}, "x", None))
    assert (unknown["true"], unknown["known"]) == (UNKNOWN, False)


@pytest.mark.parametrize("problem", PROBLEMS)
def test_a_price_is_a_share_of_the_time_of_an_estimator_that_there_is(problem):
    prices = VIEWS[problem].prices
    assert set(prices) == set(PROBLEMS[problem].estimators) and all(0 < price < 0.5 for price in prices.values())


def tell(visitor, count, **detail):
    """What the page's scripts say when something of its own html is clicked."""
    visitor.set(visitor.find("kept by the browser"), json.dumps({"count": count, **detail}))


def test_a_click_puts_a_judge_on_the_stage_and_takes_a_method(here):
    """One that does not run is switched on first; names that there are not mean nothing."""
    with Raw(here[1]) as visitor:
        stage, box, method = (visitor.find(label) for label in ("On the stage", "companion", "Method"))
        assert not visitor.widgets[box]["value"]
        for count, nothing in enumerate(("nobody", 7, None, ["companion"])):
            tell(visitor, count, judge=nothing, method=nothing)
        tell(visitor, 10, judge="companion")
        until(lambda: visitor.widgets[stage]["value"] == "companion" and visitor.widgets[box]["value"], "the companion")
        tell(visitor, 11, method="bspline")
        until(lambda: visitor.widgets[method]["value"] == "B-spline", "another method")
        until(lambda: any("lab-chosen' data-method='bspline'" in html for html in visitor.html.values()), "its picture")
