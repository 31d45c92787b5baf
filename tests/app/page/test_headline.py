"""The sentence that says what is seen: from the numbers of a frame, whatever is on the stage and whatever is not."""

import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from app.frame.error_view_captions import NONE_CHOSEN, UNKNOWN, frame_error_view
from app.frame.headline import HeadlineWithFacts, InstantErrors, lane_facts
from app.frame.stage import NOTHING
from app.names_and_units import per_cent
from app.page.headline_panel import SAY_SECONDS, WAITING, HeadlinePanel, compare_errors, frame_headline
from app.page.stage.worst_region import WorstRegions
from app.problems.views import VIEWS
from solvers.solver.soundness import LOST, UNSTABLE
from tests.app.frame.test_view import BAR, arrays_of, report_of
from tests.support.unsolved_bar import unsolved

ERROR = np.full(20, 0.001)
ERROR[6] = 0.004  # the worst place, X = 0.325


def told(scene=BAR, drawn="transport", crossed=(), ago=0.0, comparison="", estimated=ERROR / 2, left=np.nan, **changes):
    """What is said of a frame of the bar whose estimate is half the error; ``crossed`` steps ago."""
    report, arrays = replace(report_of(scene), time=0.35, **changes), arrays_of(estimated, ERROR)
    arrays.steps_since_crossing[:len(crossed)] = crossed
    return frame_headline(report, arrays, frame_error_view(report, arrays, "x", drawn, False), "x", drawn, ago,
                          comparison, left)


def said(*given, **changes):
    return str(told(*given, **changes))


def test_how_wrong_comes_first_then_whether_it_is_known():
    """Of one instant, whether the run plays or not: the norm of the error over the amplitude, and its estimated share;
    a comparison takes the place of the sizes."""
    assert said() == ("At t = 0.35 s the displacement is 5.3 % wrong; transport finds 50 % of it. 1.3 mm of 25 mm at "
                      "most. No particle has changed its cell yet.")
    assert "; transport finds 130 % of it. " in said(estimated=1.3 * ERROR)
    assert "; transport finds 100 % of it. " in said(estimated=1.004 * ERROR)
    assert "of it. Subtracting the estimate leaves 0.3 %. 1.3 mm" in said(left=0.003)
    assert said(comparison="twice as wrong").endswith("of it. Twice as wrong. No particle has changed its cell yet.")


def test_a_lane_tells_the_same_numbers_and_the_time_of_the_run():
    """Of a run that is lost, or wrong by more than the quantity, only that; what is unknown is not told."""
    def facts(true, estimated, lost=False, seconds=0.0):
        return "".join(text for _, text in lane_facts(InstantErrors(true, estimated), 2.0, "companion", lost, seconds))

    assert facts(0.128, 0.1165, seconds=0.0015) == "6.4 % wrong · companion finds 91 % · 1.5 ms"
    assert facts(0.1, 0.2) == "5 % wrong · companion estimates 2.00 times as much" \
        and facts(0.1, 0.102) == "5 % wrong · companion finds 102 %"
    assert facts(np.nan, 0.1) == "companion estimates 5 %"
    assert facts(0.1, np.nan) == "5 % wrong"
    assert facts(2.1, 0.1, seconds=1.0) == "over 100 % wrong" and facts(0.1, 0.1, lost=True) == "run is lost"


def test_no_place_of_a_run_is_marked_in_another_one(monkeypatch):
    """Also by a thread that draws while another one looks at the first frame of a new scene, which takes time."""
    other = replace(BAR, amplitude=0.5 * BAR.amplitude)
    worst, drawn = WorstRegions(), []

    def found(scene):
        report, arrays = replace(report_of(scene), time=0.35), arrays_of(ERROR / 2, ERROR)
        worst.find(report, arrays, frame_error_view(report, arrays, "x", "transport", False), "x")

    found(BAR)
    assert worst.annotations(BAR).worst[1] is not None and worst.annotations(other) == NOTHING
    view, usual = VIEWS["bar"], VIEWS["bar"].regions
    monkeypatch.setitem(VIEWS, "bar", replace(view, regions=lambda at_rest: [
        drawn.extend((worst.annotations(other), worst.by_truth)), usual(at_rest)][1]))
    found(other)
    assert drawn == [NOTHING,
                     None] and worst.annotations(BAR) == NOTHING and worst.annotations(other).worst[1] is not None


def test_where_it_is_worst_is_looked_for_in_each_of_the_two():
    """The estimate is worst at one end, the truth at the other; the brackets have each its own."""
    estimated, report = np.full(20, 0.001), replace(report_of(BAR), time=0.35)
    estimated[17] = 0.002
    arrays = arrays_of(estimated, ERROR)
    view, worst = frame_error_view(report, arrays, "x", "transport", False), WorstRegions()
    worst.find(report, arrays, view, "x")
    assert worst.by_estimate.particles[17] and not worst.by_estimate.particles[6]
    assert worst.by_truth.particles[6] and not worst.by_truth.particles[17]
    drawn = worst.annotations(BAR).worst
    assert [np.flatnonzero(one.particles).tolist() for one in drawn] == [
        np.flatnonzero(one.particles).tolist() for one in (worst.by_estimate, worst.by_truth)]


def test_the_eye_gets_the_same_in_spans():
    """The number is marked, what is true and what is estimated, and that a run is lost."""
    assert {text: kind for kind, text in told().spans if kind} == {
        "5.3 %": "number", "wrong": "truth", "transport": "estimate", "50 %": "figure"}
    assert told(status=LOST, since=0.2).spans[0] == ("bad", "The run is lost from t = 0.2 s on")
    assert said(status=UNSTABLE, playing=False) == \
        "The run went unstable and has stopped at t = 0.35 s. This is its last picture."
    assert " ".join(["".join(text for _, text in told().spans), *told().fact_sentences]) == said()


def test_particles_that_have_changed_their_cell_are_counted_from_the_start():
    assert "1 particle has changed its cell." in said(crossed=[3])
    assert " 2 particles have changed their cell." in said(crossed=[0, 10_000])
    assert "Nearly every particle has changed its cell." in said(crossed=[1] * 19)
    assert "cell" not in said(replace(BAR, effects=("truth", "estimate")))


@pytest.mark.parametrize(("begins", "scene", "changes"), [
    ("At t = 0.35 s the displacement is 5.3 % wrong; transport finds 50 % of it. ", BAR, {"playing": False}),
    ("0.25 periods back the displacement is 5.3 % wrong; transport", BAR, {"playing": False, "ago": 0.25}),
    ("The run is lost from t = 0.2 s on: the displacement is 5.3 % wrong; transport finds 50 % ", BAR,
     {"status": LOST, "since": 0.2}),
    (f"At t = 0.35 s transport estimates that the displacement is 2.6 % wrong. 660 µm of 25 mm at most. "
     f"{UNKNOWN[:1].upper()}{UNKNOWN[1:]}. No", unsolved(BAR), {}),
    (f"At t = 0.35 s the displacement is 5.3 % wrong; {NONE_CHOSEN}. 1.3 mm of 25 mm at most. No",
     replace(BAR, estimators=()), {"drawn": None}),
    ("At t = 0.35 s the displacement is 5.3 % wrong; transport is not valid here. 1.3 mm", BAR,
     {"not_valid": {"transport": "not valid here: it rains"}}),
    ("Nothing is known of the error of the displacement. ", replace(BAR, effects=("estimate",), estimators=()),
     {"drawn": None})],
    ids=["plays", "back", "lost", "no truth", "no estimate", "none that holds", "neither"])
def test_a_run_is_told_of_its_moment_and_what_is_not_known_is_not_told(begins, scene, changes):
    """That it is lost or unstable comes first."""
    assert said(scene, **changes).startswith(begins)
    assert frame_headline(None, None, None, "x", None) == HeadlineWithFacts.from_template(WAITING)


def test_sentences_come_calmly():
    """One is not said again, and another one not at once: it is heard later, as it is by then."""
    class Html:
        content = property(None, lambda _, text: heard.append((re.search('sentence="(.*?)"', text)[1],
                                                               int(re.search("aloud='(.*?)'", text)[1]))))

    heard, now = [], 0.0
    speaker = HeadlinePanel(SimpleNamespace(add_html=lambda _: Html()), lambda: now)
    for sentence, now in (("one", 5.0), ("two", 5.0 + 0.9 * SAY_SECONDS), ("three", 5.0 + SAY_SECONDS),  # noqa: B007
                          ("three", 5.0 + 3 * SAY_SECONDS)):
        speaker.show(HeadlineWithFacts.from_template(sentence))
    assert heard == [("One.", 0), ("Three.", 0)]
    speaker.show(HeadlineWithFacts((("", "paused"),), moment="another"))  # said at once, and read aloud
    assert heard[2:] == [("Paused.", 1)]
    speaker.show(HeadlineWithFacts((("", "a click's answer"),), moment="another"), is_immediate=True)
    assert heard[3:] == [("A click&#x27;s answer.", 2)]


def test_a_second_run_is_compared_by_its_relative_true_error():
    """Nothing is said where either is unknown."""
    assert compare_errors(0.064, 0.003, "B-spline at the same settings") == \
        "21 times as wrong as B-spline at the same settings"
    assert compare_errors(0.003, 0.006, "the pinned run") == "the pinned run is 2 times as wrong"
    assert compare_errors(np.nan, 0.1, "") == compare_errors(0.1, np.nan, "") == compare_errors(0.1, 0.0, "") == ""


def test_shares_have_two_digits_and_no_exponents():
    shares = {0.0: "0 %", 3e-6: "0.0003 %", 0.00286: "0.29 %", 0.0642: "6.4 %", 0.0999: "10 %", 0.534: "53 %",
              23.0: "2,300 %", 1e6: "1 × 10⁸ %"}
    assert {share: per_cent(share) for share in shares} == shares
