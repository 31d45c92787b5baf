"""Bets on the page: whose lines stand there, what they say, and when they are asked for."""

from __future__ import annotations

import re

from app.lessons import catalogue
from app.lessons.answer_marking import AnswerMark
from app.lessons.interval_bets import YOURS, Bettor, IntervalBet
from app.lessons.lesson import EXPLAIN, PREDICT, Step
from app.lessons.student_progress import RecordedAnswer
from app.page.features.lesson.answer_marking_queue import upcoming_bets_step
from app.page.features.lesson.step_html import answers_table_html, bets_html


def test_a_picture_has_a_line_for_each_bet_and_says_it_in_words():
    """A bet that holds crosses the middle, where the truth is; one that was not made has no line."""
    html = bets_html([Bettor(YOURS, (IntervalBet(1, 100, 10), IntervalBet(20, 40, 10))),
                      Bettor("two-grid", (None, IntervalBet(9, 11, 10)))])
    assert re.findall(r"aria-label='([^']*)'", html) == [
        "Your bets: 1 of 2 contain the truth, mean score 2.66",
        "two-grid: 1 of 1 contain the truth, 1 without a bet, mean score 0.09"]
    assert re.findall(r"class='lab-(held|missed)' x1='([^%]*)%' x2='([^%]*)%'", html) == [
        ("held", "0.00", "100.00"), ("missed", "65.05", "80.10"), ("held", "47.71", "52.07")]
    assert "÷ 10" in html and "× 10" in html and "80 of 100 should contain it" in html
    assert bets_html([]) == ""
    assert bets_html("could not be <b>") == "<p class='lab-bets-later'>could not be &lt;b&gt;</p>"


def test_what_came_out_has_a_bets_score_beside_it():
    lesson = catalogue.load_lesson("10-how-sure-are-you")
    step = next(step for step in lesson.steps if step.question)
    mark = AnswerMark(True, "44.56 nm", IntervalBet(2e-8, 2e-7, 4.456e-8))
    html = answers_table_html(lesson, [step], {step.key: RecordedAnswer([2e-8, 2e-7], [2e-8, 2e-7], 1, 1.0)},
                              {step.key: mark}, {})
    assert "<td>20 nm to 200 nm</td><td>44.56 nm; score 1.00</td>" in html


def test_bets_are_asked_for_from_the_run_on():
    """So that they are there when they are explained; never where somebody still predicts."""
    lesson = catalogue.load_lesson("10-how-sure-are-you")

    def ends(step: Step) -> Step:
        return next(other for other in lesson.steps[lesson.steps.index(step):] if other.kind == EXPLAIN)

    assert [upcoming_bets_step(lesson, step) for step in lesson.steps] == [
        None if step.kind == PREDICT else ends(step) for step in lesson.steps]
    other = catalogue.load_lesson("09-four-judges")
    assert {upcoming_bets_step(other, step) for step in other.steps} == {None}
