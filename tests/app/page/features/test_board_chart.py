"""What a class has said, drawn: bars, dots and lines stand where they should, and nothing of it needs colours."""

import re

import pytest

from app.lessons.answer_marking import RightAnswer
from app.lessons.lesson import CHOICE, DRAG, INTERVAL, NUMBER, Question
from app.page.features.board.chart import answer_chart, answer_options, axis_for, count_right_answers

OPTIONS = ("It <grows>", "It falls to {A}", "Neither")


def asked(kind, **fields):
    return Question(kind, 1, **fields)


@pytest.mark.parametrize("values, always", [
    ([1.0], []), ([0.0], []), ([-3.0, -3.0], []), ([1.0, 2.0, 3.0], [2.5]), ([1e-9, 1e9], []),
    ([1, 10, 100, 1000], [5e4]), ([1.0] * 20 + [1e300], []),
    ([-1e300, 1e300], [0.0]), ([1.0, 100.0, 1e4], [-1.0]), ([0.0, 0.0, 1e-12], [3.0])])
def test_an_axis_has_most_answers_and_what_must_be_on_it(values, always):
    """Its ticks are few, round and within; places grow with the values."""
    axis = axis_for(values, always)
    assert all(axis.beyond(value) == 0 for value in always)
    inside = [value for value in values if axis.beyond(value) == 0]
    assert len(inside) >= 0.5 * len(values)
    places = [axis.position(value) for value in sorted(values)]
    assert places == sorted(places) and all(0 <= place <= 1 for place in places)
    assert len(axis.ticks) <= 7 and all(axis.beyond(tick) == 0 for tick in axis.ticks)


def test_one_odd_answer_does_not_squeeze_the_others():
    values = [1.0, 1.2, 1.4, 1.6, 1.8, 2.0, 2.1, 2.2, 2.3, 2.4, 6969.0]
    axis = axis_for(values)
    assert axis.position(2.4) - axis.position(1.0) > 0.3 and axis.beyond(6969.0) == 1
    assert "1 further to the right" in answer_chart(asked(NUMBER, unit="mm"), values, {}, None)


def test_decades_have_the_same_room_where_answers_span_many():
    axis = axis_for([0.01, 0.1, 1.0, 10.0])
    assert axis.logarithmic and axis.position(0.1) - axis.position(0.01) == pytest.approx(
        axis.position(10) - axis.position(1)
    )
    assert not axis_for([1.0, 2.0, 5.0]).logarithmic and not axis_for([-1.0, 0.0, 1e4]).logarithmic


def test_bars_have_their_counts_and_what_came_out_a_sign():
    before = answer_chart(asked(CHOICE, options=OPTIONS), [1, 1, 2], {"A": 7}, None)
    assert re.findall(r"<b>(\d)</b>", before) == ["2", "1", "0"] and "came out" not in before
    assert "It &lt;grows&gt;" in before and "It falls to 7" in before
    assert [round(float(part), 2) for part in re.findall(r"--part: ([\d.]+)", before)] == [0.67, 0.33, 0]
    after = answer_chart(asked(CHOICE, options=OPTIONS), [1, 1, 2], {"A": 7}, RightAnswer("It falls to 7", (2,)))
    assert after.count("✓ this came out") == 1
    assert after.index("falls to 7") < after.index("came out") < after.index("Neither")
    assert "<i" not in answer_options(asked(CHOICE, options=OPTIONS), {"A": 7})


@pytest.mark.parametrize("kind", [NUMBER, DRAG])
def test_numbers_are_dots_and_what_is_right_a_band(kind):
    """As many dots as answers, above each other where they are the same."""
    question = asked(kind, unit="m", tolerance=0.1)
    before = answer_chart(question, [0.001, 0.001, 0.002], {}, None)
    assert before.count("<i></i>") == 3 and "--most: 2" in before and "came out" not in before
    after = answer_chart(question, [0.001, 0.001, 0.002], {}, RightAnswer("", value=0.002))
    band = re.search(r"lab-band' style='left: ([\d.]+)%; width: ([\d.]+)%", after)
    dots = [float(left) for left in re.findall(r"<div style='left: ([\d.]+)%", after)]
    assert "2 mm came out" in after and dots[0] < float(band[1]) < dots[1] + 3 < sum(map(float, band.groups())) + 6
    assert "1 mm; 1 mm; 2 mm" in after  # for those who hear it
    assert count_right_answers(question, [0.001, 0.0019, 0.0021], RightAnswer("", value=0.002)) == 2


def test_intervals_are_lines_and_those_that_hold_what_came_out_look_different():
    question, given = asked(INTERVAL, unit="µm"), [[1.0, 2.0], [1.5, 4.0], [3.0, 5.0]]
    before = answer_chart(question, given, {}, None)
    spans = [tuple(map(float, span)) for span in re.findall(r"margin-left: ([\d.]+)%; width: ([\d.]+)%", before)]
    assert len(spans) == 3 and spans[0][0] < spans[1][0] < spans[2][0] and spans[1][1] > spans[0][1] > 0
    assert "lab-holds" not in before and "came out" not in before
    found = RightAnswer("", value=3.5)
    after = answer_chart(question, given, {}, found)
    assert after.count("lab-holds") == 2 == count_right_answers(question, given,
                                                                found) and after.count("lab-misses") == 1
    assert "3.5 µm came out" in after


@pytest.mark.parametrize("kind", [CHOICE, NUMBER, DRAG, INTERVAL])
def test_no_answer_at_all_is_no_fault(kind):
    question = asked(kind, options=OPTIONS)
    answer_chart(question, [], {"A": 1}, None)
    assert "came out" in answer_chart(question, [], {"A": 1}, RightAnswer("", (1,), 2.0))
