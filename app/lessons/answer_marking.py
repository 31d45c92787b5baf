"""Marking of answers: whether one is right is computed from runs each time, never stored."""

import functools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from app.language.translation import tr
from app.lessons import lesson as lesson_format
from app.lessons.claims import ClaimError, decide_claim, evaluate_expression, format_value
from app.lessons.interval_bets import BY_ROUND, OWN, PATH, Bettor, Ends, IntervalBet, earlier_bet_steps
from app.lessons.lesson import CHOICE, DRAG, INTERVAL, NUMBER, TEXT, Lesson, Numbers, Question, Step, fill_numbers
from app.lessons.lesson_runs import RunCache
from app.names_and_units import with_unit

LONGEST = 500  # characters of a text
MOST = 1e300
BARE, DIGITS = ("m", "m/s", "m/s²", "Pa", "N", "s"), 4
TOLD_AFTER = 3  # attempts, after which the right answer is shown


@dataclass(frozen=True)
class AnswerMark:
    """Mark of an answer: whether it is ``right`` (None: free text, not marked), the right answer as text in
    ``expected``, and the interval with the true value in ``bet`` if the question asks for one."""

    right: bool | None
    expected: str
    bet: IntervalBet | None = None

    @property
    def points(self) -> float:
        """Points of the answer: 1 or 0; those of an interval fall with its width and miss (:attr:`Bet.points`)."""
        return self.bet.points if self.bet else float(bool(self.right))


@dataclass(frozen=True)
class RightAnswer:
    """Right answer in words, and of a choice the right ``options``, from 1, else the value, a number or a word."""

    text: str
    options: tuple[int, ...] = ()
    value: float | str = 0.0


def mark_answer(lesson: Lesson, step: Step, answer: Any, numbers: Numbers, outcomes: RunCache) -> AnswerMark:
    """Returns the mark of a valid answer to a step's question: text, option counted from 1, number or (low, high).
    ``numbers`` are the student's variant; ``outcomes`` runs scenes as needed. Raises RunFailed and ClaimError."""
    if step.asked_question.kind == TEXT:
        return AnswerMark(None, "")
    found = right_answer(lesson, step, numbers, outcomes)
    right_or_not = is_right(step.asked_question, answer, found)
    if step.asked_question.kind != INTERVAL:
        return AnswerMark(right_or_not, found.text)
    low, high = map(float, answer)
    return AnswerMark(right_or_not, found.text, IntervalBet(low, high, float(found.value), step.asked_question.level))


def right_answer(lesson: Lesson, step: Step, numbers: Numbers, outcomes: RunCache) -> RightAnswer:
    """Returns the right answer to a question with one, for a variant's ``numbers``; raises as :func:`mark_answer`."""
    asked = step.asked_question
    texts = answer_expressions(asked, numbers)
    scope = outcomes.scope(lesson, step, numbers, texts)
    if asked.kind == CHOICE:
        options = (asked.correct,) if asked.correct is not None else \
            tuple(k for k, claim in enumerate(texts, 1) if decide_claim(claim, scope).holds)
        told = functools.reduce(lambda one, other: tr("{one} or {other}", one=one, other=other),
                                [fill_numbers(asked.options[k - 1], numbers) for k in options] or [""])
        return RightAnswer(told, options)
    expected = evaluate_expression(texts[-1], scope)
    if asked.kind == INTERVAL and (isinstance(expected, str) or expected <= 0):
        raise ClaimError(f"{texts[-1]} is {format_value(expected)}: intervals are bets on a size; ask for one above 0")
    told = format_in_unit(asked, expected)
    if asked.kind != INTERVAL and not isinstance(expected, str):
        told += f" (± {100 * asked.tolerance:g} %)"
    return RightAnswer(told, value=expected)


def answer_expressions(asked: Question, numbers: Numbers) -> list[str]:
    """Returns the claims of a question's options, or one expression for its value, with these numbers filled in."""
    return [fill_numbers(text, numbers) for text in (*asked.holds, asked.expected) if text]


def format_in_unit(asked: Question, value: float | str) -> str:
    """Formats a value in the question's unit with that unit; SI units get a prefix where it is shorter."""
    if asked.unit in BARE and not isinstance(value, str):
        return with_unit(value, asked.unit, DIGITS)
    return f"{format_value(value)} {asked.unit}".strip()


def is_right(asked: Question, answer: Any, right: RightAnswer) -> bool:
    """Whether an answer is the right option or word, within the tolerance, or an interval that contains the value."""
    if asked.kind == CHOICE:
        return answer in right.options
    if isinstance(right.value, str):
        return answer == right.value
    if asked.kind == INTERVAL:
        low, high = answer
        return low <= right.value <= high
    return abs(answer - right.value) <= asked.tolerance * abs(right.value)


def why_invalid(asked: Question, answer: Any) -> str:
    """Returns why a decoded JSON value is no valid answer to a question, as a sentence for the student; "" if it is."""
    if asked.kind == TEXT:
        fits = isinstance(answer, str) and 0 < len(answer.strip()) <= LONGEST
        return "" if fits else tr("Please write one to {most} characters.", most=LONGEST)
    if asked.kind == CHOICE:
        fits = isinstance(answer, int) and not isinstance(answer, bool) and 1 <= answer <= len(asked.options)
        return "" if fits else tr("Please choose one of the answers.")
    if asked.kind == INTERVAL:
        if not (isinstance(answer, (list, tuple)) and len(answer) == 2 and all(map(_is_real, answer))):
            return tr("Please give two numbers, the least and the most.")
        if answer[0] > answer[1]:
            return tr("The first number must not be above the second.")
        return "" if answer[0] > 0 else \
            tr("Please give two numbers above 0: bets are scored by factors, so 0 is not possible.")
    assert asked.kind in (NUMBER, DRAG)
    return "" if _is_real(answer) else tr("Please give a number.")


def format_answer(asked: Question, answer: Any) -> str:
    """Returns a valid answer in words, with the unit; free text is returned as typed, not escaped for html."""
    if asked.kind == CHOICE:
        return asked.options[answer - 1]
    if asked.kind == INTERVAL:
        low, high = (format_in_unit(asked, float(end)) for end in answer)
        return tr("{low} to {high}", low=low, high=high)
    return answer if asked.kind == TEXT else format_in_unit(asked, float(answer))


def _is_real(number: Any) -> bool:
    return isinstance(number, (int, float)) and not isinstance(number, bool) and abs(number) < MOST


def bettors_of_step(lesson: Lesson, step: Step, given: Mapping[str, Sequence[float]], numbers: Numbers,
                    outcomes: RunCache) -> list[Bettor]:
    """Returns the student's and the judges' bets that a step compares, empty without earlier bets. ``given`` maps the
    key of each answered step that asked for a bet to (low, high). Runs scenes, and raises as :func:`mark_answer`."""
    steps = [other for other in earlier_bet_steps(lesson, step) if other.key in given]
    truths = [float(right_answer(lesson, other, numbers, outcomes).value) for other in steps]
    found = []
    for name in step.bets if steps else ():
        ends = [given[other.key] if name in OWN else judge_ends(lesson, other, name, numbers, outcomes)
                for other in steps]
        bets = [None if pair is None else IntervalBet(float(pair[0]), float(pair[1]), truth, other.asked_question.level)
                for other, truth, pair in zip(steps, truths, ends, strict=True)]
        if name == BY_ROUND:  # a student's bets by rounds, each of which ends with an explanation
            explained = [sum(other.kind == lesson_format.EXPLAIN for other in lesson.steps[:lesson.steps.index(step)])
                         for step in steps]
            for number, one in enumerate(sorted(set(explained)), 1):
                own = tuple(bet for bet, before in zip(bets, explained, strict=True) if before == one)
                found.append(Bettor(name, own, number))
        else:
            found.append(Bettor(name, tuple(bets)))
    return found


def judge_ends(lesson: Lesson, step: Step, judge: str, numbers: Numbers, outcomes: RunCache) -> Ends | None:
    """Returns a judge's bet (low, high) on the answer to a step, in the SI unit of the error, or None for no bet."""
    path = PATH.fullmatch(step.asked_question.expected)
    assert path is not None  # has been checked
    run = lesson.runs[path["run"] or lesson.main_run(step)]
    return outcomes.judge_bets(fill_numbers(run.texts[0], numbers))[path["quantity"]][judge]
