"""The sentence that says what is seen: from the numbers of a frame, whatever is on the stage and whatever is not."""

from __future__ import annotations

import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from app.frame.silences import NONE_CHOSEN, UNKNOWN
from app.frame.view import look
from app.page.stage.worst import WorstRegions
from app.page.summary import SAY_SECONDS, WAITING, Speaker, compared, summary
from app.page.visit.history import CROSSING_WINDOW
from solvers.solver.soundness import LOST, UNSTABLE
from tests.app.frame.test_view import BAR, arrays_of, report_of

ERROR = np.full(20, 0.1)
ERROR[6] = 0.4  # the worst place, X = 0.325


def said(scene=BAR, drawn="transport", series=None, crossed=(), **changes):
    """The sentence for a frame of the bar whose estimate is half the error; ``crossed`` steps ago."""
    report, arrays = replace(report_of(scene), time=0.35, **changes), arrays_of(ERROR / 2, ERROR)
    arrays.steps_since_crossing[:len(crossed)] = crossed
    view, worst = look(report, arrays, "x", drawn, False), WorstRegions()
    worst.look(report, arrays, view)
    numbers = {"transport/index_x": [0.4, 0.5], "transport/estimate_x": [0.1, 0.0021], "error_x": [0.1, 0.0042]}
    series = numbers if series is None else series
    return summary(report, arrays, view, worst, {name: np.array(v) for name, v in series.items()}, "x", drawn)


def test_estimate_beside_the_truth():
    assert said() == ("The estimate by transport is 0.50 of the true error of displacement x; worst at "
                      "X = 0.30–0.35 m; no particle crossed a cell boundary in the last 0.05 s.")
    assert said(series={"transport/index_x": [1.02]}).startswith("The estimate by transport is 1.02 times the true ")


@pytest.mark.parametrize(("beyond", "who"), [(1, "2 particles"), (0, "3 particles")])
def test_crossings_are_those_of_the_last_twentieth_of_a_period(beyond, who):
    steps = CROSSING_WINDOW * BAR.period / BAR.time_step
    assert f"; {who} crossed a cell boundary in the last 0.05 s." in said(crossed=[0, 1, int(steps) + beyond])


def test_one_particle_and_no_counting():
    assert "1 particle crossed" in said(crossed=[3])
    assert "crossed" not in said(replace(BAR, effects=("truth", "estimate")))


def test_without_truth_the_estimate_is_told():
    """And the worst place is that of the estimate."""
    text = said(replace(BAR, body_force="two-tone"))
    assert text.startswith(f"Transport estimates the error of displacement x at 2.1 mm; {UNKNOWN}; worst at X = 0.30")


def test_without_estimate_the_truth_is_told():
    text = said(replace(BAR, estimators=()), drawn=None)
    assert text.startswith(f"The true error of displacement x is 4.2 mm; {NONE_CHOSEN}; worst at X = 0.30–0.35 m")


def test_an_estimate_that_does_not_hold_is_not_told():
    text = said(not_valid={"transport": "not valid here: it rains"})
    assert text.startswith("The true error of displacement x is 4.2 mm; transport is not valid here; worst at")


def test_with_neither():
    text = said(replace(BAR, effects=("estimate",), estimators=()), drawn=None)
    assert text.startswith("Nothing is known of the error of displacement x: ") and NONE_CHOSEN in text


def test_paused_lost_and_unstable_come_first():
    assert said(playing=False).startswith("Paused at t = 0.35 s: the estimate by transport is 0.50 of")
    assert said(status=LOST, since=0.2).startswith("The run is lost from t = 0.2 s on; the estimate by transport")
    assert said(status=UNSTABLE, playing=False) == \
        "The run went unstable and has stopped at t = 0.35 s; this is its last picture."


def test_before_there_are_numbers():
    assert said(series={}).startswith("No error of displacement x has been measured yet; ")
    assert said(series={"transport/index_x": [np.nan]}).startswith("No error of displacement x has been measured yet; ")
    assert summary(None, None, None, WorstRegions(), {}, "x", None) == WAITING


def test_sentences_come_calmly():
    """One is not said again, and another one not at once: it is heard later, as it is by then."""
    class Html:
        content = property(None, lambda _, text: said.append(re.search('"(.*)"', text)[1]))

    said, now = [], 0.0
    speaker = Speaker(SimpleNamespace(add_html=lambda _: Html()), lambda: now)
    for sentence, now in (("one", 5.0), ("two", 5.0 + 0.9 * SAY_SECONDS), ("three", 5.0 + SAY_SECONDS),  # noqa: B007
                          ("three", 5.0 + 3 * SAY_SECONDS)):
        speaker.say(sentence)
    assert said == ["one", "three"]


def test_a_pinned_run_is_compared_by_its_true_error():
    """Over what is given of both; nothing is said where either is unknown."""
    live, pinned = ({"error_v": np.array(v)} for v in ([1.0, 3.0], [2.0, 6.0, 4.0]))
    assert compared(live, pinned, "v") == "the pinned run's error is 2.00 times this one's"
    assert compared(pinned, live, "v") == "the pinned run's error is 0.50 of this one's"
    for unknown in ({}, {"error_v": np.array([np.nan, 1.0])}, {"error_v": np.zeros(2)}, {"error_v": np.zeros(0)}):
        assert compared(unknown, live, "v") == compared(live, unknown, "v") == ""
