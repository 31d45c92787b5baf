"""Who judges a run: what the cards and the readout say, also of a verdict that is of positions alone, of what nobody
looked at, and of errors that are none; and that a name clicked is on the stage."""

from __future__ import annotations

import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from app.names_and_units import NOTHING, per_cent
from app.page.panels.readout_tables import ROUNDED, estimator_cards_json, live_readout
from app.page.stage.worst_region import WorstRegions
from app.page.visit.history import NormHistory
from app.page.visit.status_message import doubt_notice
from app.problems.views import VIEWS
from solvers.problems import PROBLEMS
from solvers.problems.bar.scene import BarScene
from solvers.running.quantities_of_interest import ENERGY
from solvers.running.run import build
from solvers.study.coverage.track_record_and_bets import RunSoFar, accurate_run_counts, bars_held
from tests.app.frame.test_view import report_of
from tests.support.processes import wait_until
from tests.support.raw_client import RawClient
from tests.support.unsolved_bar import unsolved

BAR = BarScene(cells=16, ppc=2, estimators=("companion",))
NAMED = "positions are ok, but the velocity is off by up to 18 times its own size, from t = 0.5 s on"


def test_cards_say_what_the_run_has():
    """The numbers are the run's; who does not hold, or was not asked, has a sentence or nothing."""
    scene = BarScene(cells=16, ppc=2, periods=1, estimators=("transport", "recovered"))
    solver, history = build(scene), NormHistory(scene, 20)
    history.add(solver.advance(200))
    report = replace(report_of(scene), time=solver.time, not_valid={"recovered": "not valid here: why"})
    cards = json.loads(estimator_cards_json(report, history.series, "x", "transport"))
    assert (cards["problem"], cards["stage"]) == ("bar", "transport")
    assert set(cards["judges"]) == {"transport", "recovered"}
    estimate, true = (history.series[name][-1] for name in ("transport/estimate_x", "error_x"))
    assert cards["judges"]["transport"]["finds"] == per_cent(estimate / true)
    held, of = accurate_run_counts(RunSoFar(scene, "ok", report.time), "transport")
    trust = cards["judges"]["transport"]["trust"]
    assert trust == f"within 10\N{NO-BREAK SPACE}% of the truth in {held} of {of} such runs"
    assert cards["judges"]["recovered"] == {"says": "Not valid here: why"}
    unknown = json.loads(estimator_cards_json(report_of(unsolved(scene)), {}, "x", None))
    assert unknown["judges"]["transport"]["finds"] == NOTHING


@pytest.mark.parametrize("problem", PROBLEMS)
def test_a_price_is_a_share_of_the_time_of_an_estimator_that_there_is(problem):
    prices = VIEWS[problem].prices
    assert set(prices) == set(PROBLEMS[problem].estimators) and all(0 < price < 0.5 for price in prices.values())


def tell(visitor, count, **detail):
    """What the page's scripts say when something of its own html is clicked."""
    visitor.set(visitor.find("kept by the browser"), json.dumps({"count": count, **detail}))


def test_a_click_puts_a_judge_on_the_stage_and_takes_a_method(here):
    """One that does not run is switched on first; names that there are not mean nothing."""
    with RawClient(here[1]) as visitor:
        stage, box = (visitor.find(label) for label in ("On the stage", "transport"))
        assert not visitor.widgets[box]["value"]
        for count, nothing in enumerate(("nobody", 7, None, ["companion"])):
            tell(visitor, count, judge=nothing, method=nothing)
        tell(visitor, 10, judge="transport")
        wait_until(lambda: visitor.widgets[stage]["value"] == "transport" and visitor.widgets[box]["value"],
                   "transport")
        tell(visitor, 11, method="bspline")
        wait_until(lambda: any("data-method='bspline' aria-checked='true'" in html for html in visitor.html.values()),
                   "another method")


def watched(scene: BarScene) -> tuple[NormHistory, SimpleNamespace]:
    """A history of some hundred steps, and a session that has it."""
    solver, history = build(scene), NormHistory(scene, scene.particles)
    history.add(solver.measure())
    history.add(solver.advance(300))
    return history, SimpleNamespace(pinned=None, history=history, speed=1.0, is_over=False)


def test_a_run_that_is_ok_for_positions_alone_says_so_in_its_readout():
    """The headline is of the quantity that one looks at, and nothing covers the stage for the others."""
    history, session = watched(BAR)
    for reason in (None, NAMED):
        report = replace(report_of(BAR), reason=reason)
        html = live_readout(session, history, report, "x", None, None, WorstRegions()).html
        assert (NAMED in html) == (reason is not None)
    assert doubt_notice(history, ("companion",)) is None


def test_what_nobody_looked_at_is_a_line_of_the_readout():
    history, session = watched(BAR)
    report = replace(report_of(BAR), step=300, time=300 * BAR.time_step)
    said = live_readout(session, history, replace(report, not_checked="velocity & stress"), "x", None, None,
                        WorstRegions())
    assert "velocity &amp; stress" in said.html
    assert "unseen" not in live_readout(session, history, report, "x", None, None, WorstRegions()).html


def test_numbers_of_the_body_have_a_bar_by_who_is_on_the_stage():
    """And how often such bars held; without an estimator, or back in time, no bar and no number."""
    history, session = watched(BAR)
    energy = {"value": 0.0062, "unit": "J", "true_error": None, "estimated_error": {"companion": -1e-5},
              "rounding": 0.0, "bar": {"companion": 2e-5}}
    report = replace(report_of(BAR), step=300, time=300 * BAR.time_step, goals={ENERGY: energy})
    held, of = bars_held(RunSoFar(BAR, "ok", report.time), ENERGY, "companion")
    html = live_readout(session, history, report, "x", "companion", None, WorstRegions()).html
    assert "kinetic energy" in html and f"6.2 mJ ± 20 µJ; such bars held in {held} of {of} runs like this" in html
    for changes, said in (({"status": "lost"}, "only runs that end as ok were counted"),
                          ({"time": 4 * BAR.period}, "0.1 to 3 periods, and this one has 4")):
        other = live_readout(session, history, replace(report, **changes), "x", "companion", None, WorstRegions())
        assert "± 20 µJ; how often" in other.html and said in other.html and "held" not in other.html
    html = live_readout(session, history, report, "x", None, None, WorstRegions()).html
    assert "6.2 mJ" in html and "±" not in html.partition("6.2 mJ")[2].partition("</td>")[0]
    assert "6.2 mJ" not in live_readout(session, history, report, "x", None, None, WorstRegions(), ago=0.1).html


def test_an_error_that_is_nothing_but_rounding_has_no_index_on_the_page():
    patch = BarScene(motion="patch", cells=12, ppc=2, estimators=("companion",))
    for scene, rounded in ((patch, True), (BAR, False)):
        history, session = watched(scene)
        report = replace(report_of(scene), step=300, time=300 * scene.time_step)
        html = live_readout(session, history, report, "v", "companion", None, WorstRegions()).html
        card = json.loads(estimator_cards_json(report, history.series, "v", "companion"))["judges"]["companion"]
        assert (ROUNDED in html) == rounded
        assert ("finds" not in card and card.get("says") == "Nothing but rounding") == rounded


@pytest.mark.parametrize("scene, said", [
    (BarScene(modulus=64.0), "1.2 of 1.25 periods/s"), (BarScene(modulus=0.25), "0.075 of 1.25 periods/s")])
def test_the_speed_is_read_in_periods(scene, said):
    """0.3 simulated seconds a second are 1.2 periods of 1/4 s, or 0.075 of 4 s, and only that is too slow."""
    history = SimpleNamespace(series={}, step_to_bound_ratio=np.nan)
    session = SimpleNamespace(history=history, speed=1.25, pinned=None, is_over=False)
    report = replace(report_of(scene), real_speed=0.3, playing=True)
    html = live_readout(session, session.history, report, "x", "transport", None, WorstRegions()).html
    assert f"<td>speed</td>\n<td>{said}" in html
    assert ("CAPPED" in html) == (scene.modulus < 1)
