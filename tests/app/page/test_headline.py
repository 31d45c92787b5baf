"""The sentence that says what is seen: from the numbers of a frame, whatever is on the stage and whatever is not."""

import re
from dataclasses import replace
from itertools import product
from types import SimpleNamespace

import numpy as np
import pytest

from app.frame.error_view_captions import NONE_CHOSEN, UNKNOWN, frame_error_view
from app.frame.headline import HeadlineWithFacts
from app.frame.recent_crossings import WINDOW
from app.frame.stage import NOTHING
from app.names_and_units import per_cent
from app.page.headline_panel import SAY_SECONDS, WAITING, HeadlinePanel, compare_with_pinned, frame_headline
from app.page.stage.worst_region import WorstRegions
from app.problems.views import VIEWS
from solvers.scene.error_causes import CAUSES, FIELDS
from solvers.solver.soundness import LOST, UNSTABLE
from tests.app.frame.test_view import BAR, arrays_of, report_of

ERROR = np.full(20, 0.001)
ERROR[6] = 0.004  # the worst place, X = 0.325


SERIES = {"time": [0.0, 0.35], "error_x": [0.001, 0.004], "transport/estimate_x": [0.0005, 0.0017],
          "transport/index_x": [0.5, 0.44]}


def told(scene=BAR, drawn="transport", series=SERIES, crossed=(), ago=0.0, **changes):
    """What is said of a frame of the bar whose estimate is half the error; ``crossed`` steps ago."""
    report, arrays = replace(report_of(scene), time=0.35, **changes), arrays_of(ERROR / 2, ERROR)
    arrays.steps_since_crossing[:len(crossed)] = crossed
    view, worst = frame_error_view(report, arrays, "x", drawn, False), WorstRegions()
    worst.find(report, arrays, view, "x")
    return frame_headline(report, arrays, view, worst, {name: np.array(v) for name, v in series.items()}, "x", drawn,
                          ago)


def said(*given, **changes):
    return str(told(*given, **changes))


def test_how_wrong_comes_first_then_whether_it_is_known_then_where():
    """Of a run that plays both are of all its time so far: the mean error over the amplitude, and the index."""
    assert said() == ("So far the displacement is 10 % wrong; transport finds 44 % of it. 2.5 mm of 25 mm at most. "
                      "Worst at X = 0.30–0.35 m. No particle crossed a cell boundary in the last 0.05 s.")
    assert "; transport estimates 1.30 times as much. " in said(series=SERIES | {"transport/index_x": [1.0, 1.3]})
    assert "; transport finds 100 % of it. " in said(series=SERIES | {"transport/index_x": [1.0, 1.004]})


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
        "10 %": "number", "wrong": "truth", "transport": "estimate", "44 %": "figure"}
    assert told(status=LOST, since=0.2).spans[0] == ("bad", "The run is lost from t = 0.2 s on")
    assert said(status=UNSTABLE, playing=False) == \
        "The run went unstable and has stopped at t = 0.35 s. This is its last picture."
    assert " ".join(["".join(text for _, text in told().spans), *told().fact_sentences]) == said()


@pytest.mark.parametrize(("beyond", "who"), [(1, "2 particles"), (0, "3 particles")])
def test_crossings_are_those_of_the_last_twentieth_of_a_period(beyond, who):
    assert "1 particle crossed" in said(crossed=[3])
    assert "crossed" not in said(replace(BAR, effects=("truth", "estimate")))
    steps = WINDOW * BAR.period / BAR.time_step
    assert f" {who} crossed a cell boundary in the last 0.05 s." in said(crossed=[0, 1, int(steps) + beyond])


@pytest.mark.parametrize(("begins", "given", "changes"), [
    ("At t = 0.35 s the displacement is 5.3 % wrong; transport finds 50 % of it. ", {}, {"playing": False}),
    ("0.25 periods back the displacement is 5.3 % wrong; transport", {}, {"playing": False, "ago": 0.25}),
    ("The run is lost from t = 0.2 s on: the displacement is 5.3 % wrong; transport finds 50 % ", {},
     {"status": LOST, "since": 0.2}),
    (f"So far transport estimates that the displacement is 4.4 % wrong. 1.1 mm of 25 mm at most. {UNKNOWN[:1].upper()}"
     f"{UNKNOWN[1:]}. Worst at X = 0.30", {"body_force": "two-tone"}, {"series": SERIES | {"error_x": [np.nan] * 2}}),
    (f"So far the displacement is 10 % wrong; {NONE_CHOSEN}. 2.5 mm of 25 mm at most. Worst at X", {"estimators": ()},
     {"drawn": None}),
    ("So far the displacement is 10 % wrong; transport is not valid here. 2.5 mm", {},
     {"not_valid": {"transport": "not valid here: it rains"}}),
    ("Nothing is known of the error of the displacement. ", {"effects": ("estimate",), "estimators": ()},
     {"drawn": None}),
    ("So far no error of the displacement has been measured. ", {}, {"series": {}}),
    ("So far no error of the displacement has ", {}, {"series": SERIES | {"transport/index_x": [np.nan]}})],
    ids=["stands", "back", "lost", "no truth", "no estimate", "none that holds", "neither", "no sample yet",
         "no index yet"])
def test_a_run_that_stands_is_told_of_its_moment_and_what_is_not_known_is_not_told(begins, given, changes):
    """That it is lost or unstable comes first. Without truth the worst place is that of the estimate."""
    assert said(replace(BAR, **given), **changes).startswith(begins)
    assert frame_headline(None, None, None, WorstRegions(), {}, "x", None) == HeadlineWithFacts.from_template(WAITING)


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


def test_a_pinned_run_is_compared_by_its_true_error():
    """Over the periods that both have; nothing is said where either is unknown."""
    live, pinned = ({"time": np.array(t), "error_v": np.array(v)} for t, v in (
        ([0.0, 0.5], [1.0, 3.0]), ([0.0, 0.5, 1.0], [2.0, 6.0, 40.0])))
    scenes = BAR, replace(BAR, method="bspline")
    assert compare_with_pinned(live, pinned, "v", scenes) == "the pinned run, B-spline, is 2 times as wrong"
    assert compare_with_pinned(pinned, live, "v", scenes) == "2 times as wrong as the pinned run, B-spline"
    for unknown in ({}, {"error_v": np.array([np.nan, 1.0])}, {"error_v": np.zeros(2)}, {"error_v": np.zeros(0)}):
        assert compare_with_pinned(unknown, live, "v", scenes) == compare_with_pinned(live, unknown, "v", scenes) == ""


def test_shares_have_two_digits_and_no_exponents():
    shares = {0.0: "0 %", 3e-6: "0.0003 %", 0.00286: "0.29 %", 0.0642: "6.4 %", 0.0999: "10 %", 0.534: "53 %",
              23.0: "2,300 %", 1e6: "1 × 10⁸ %"}
    assert {share: per_cent(share) for share in shares} == shares


def test_who_made_most_of_the_error_is_a_fact():
    """Of a run whose error is divided; after the size, before the place."""
    scene = replace(BAR, effects=(*BAR.effects, "budget"))
    series = SERIES | {f"budget/{kind}_{field}_{cause}": [0.0, 0.0]
                       for kind, field, cause in product(("part", "size"), FIELDS, CAUSES)}
    series |= {f"budget/error_{field}": [0.0, 0.004] for field in FIELDS}
    series |= {"budget/part_x_crossings": [0.0, 0.0035], "budget/part_x_coarse_grid": [0.0, 0.0005],
               "budget/size_x_crossings": [0.0, 0.0035], "budget/size_x_coarse_grid": [0.0, 0.0005]}
    fact = "2.5 mm of 25 mm at most. Crossings made 88 % of the error of x. Worst at X = 0.30"
    assert fact in said(scene, series=series)
    assert "made" not in said(series=series)
    assert "made" not in said(scene, series=series | {"budget/size_x_crossings": [0.0, 0.05]})
