"""Whether an answer is right: derived from the runs each time, never kept."""

from dataclasses import dataclass
from typing import Any

from app.lessons.bets import Bet
from app.lessons.claims import ClaimError, decide, said, value
from app.lessons.lesson import CHOICE, DRAG, INTERVAL, NUMBER, TEXT, Lesson, Numbers, Question, Step, filled
from app.lessons.outcomes import Outcomes
from app.words import with_unit

LONGEST = 500  # characters of a text
MOST = 1e300
BARE, DIGITS = ("m", "m/s", "m/s²", "Pa", "N", "s"), 4
TOLD_AFTER = 3  # attempts, after which the right answer is shown


@dataclass(frozen=True)
class AnswerMark:
    """``right`` is None for an answer that nobody marks; ``expected`` says what is right, in words. An interval, which
    is right where it holds what came out, is a ``bet`` as well."""

    right: bool | None
    expected: str
    bet: Bet | None = None

    @property
    def points(self) -> float:
        """What the answer counts: 1 or 0, and an interval by its score, so that width costs (:attr:`Bet.points`)."""
        return self.bet.points if self.bet else float(bool(self.right))


@dataclass(frozen=True)
class Right:
    """What is right, in words as it is ``told``: of a choice the ``options``, counted from 1, else the ``value``."""

    told: str
    options: tuple[int, ...] = ()
    value: float | str = 0.0


def mark(lesson: Lesson, step: Step, answer: Any, numbers: Numbers, outcomes: Outcomes) -> AnswerMark:
    """The mark of an answer that fits the step's question; runs what it needs.

    Raises :class:`~app.lessons.outcomes.RunFailed` and :class:`~app.lessons.claims.ClaimError`.
    """
    if step.asked.kind == TEXT:
        return AnswerMark(None, "")
    found = right(lesson, step, numbers, outcomes)
    right_or_not = fits(step.asked, answer, found)
    if step.asked.kind != INTERVAL:
        return AnswerMark(right_or_not, found.told)
    low, high = map(float, answer)
    return AnswerMark(right_or_not, found.told, Bet(low, high, float(found.value), step.asked.level))


def right(lesson: Lesson, step: Step, numbers: Numbers, outcomes: Outcomes) -> Right:
    """What is right in a step's question, which is no free text; runs what it needs, and raises as :func:`mark`."""
    asked = step.asked
    texts = expressions(asked, numbers)
    scope = outcomes.scope(lesson, step, numbers, texts)
    if asked.kind == CHOICE:
        options = (asked.correct,) if asked.correct is not None else \
            tuple(k for k, claim in enumerate(texts, 1) if decide(claim, scope).holds)
        return Right(" or ".join(filled(asked.options[k - 1], numbers) for k in options), options)
    expected = value(texts[-1], scope)
    if asked.kind == INTERVAL and (isinstance(expected, str) or expected <= 0):
        raise ClaimError(f"{texts[-1]} is {said(expected)}: intervals are bets on a size; ask for one above 0")
    told = in_unit(asked, expected)
    if asked.kind != INTERVAL and not isinstance(expected, str):
        told += f" (± {100 * asked.tolerance:g} %)"
    return Right(told, value=expected)


def expressions(asked: Question, numbers: Numbers) -> list[str]:
    """The claims of a question's options, or what it expects, with these numbers."""
    return [filled(text, numbers) for text in (*asked.holds, asked.expected) if text]


def in_unit(asked: Question, found: float | str) -> str:
    """A value in words, with the question's unit; as the page writes it, with a prefix, where that has none."""
    if asked.unit in BARE and not isinstance(found, str):
        return with_unit(found, asked.unit, DIGITS)
    return f"{said(found)} {asked.unit}".strip()


def fits(asked: Question, answer: Any, found: Right) -> bool:
    """Whether an answer to a question is right, or an interval holds what came out."""
    if asked.kind == CHOICE:
        return answer in found.options
    if isinstance(found.value, str):
        return answer == found.value
    if asked.kind == INTERVAL:
        low, high = answer
        return low <= found.value <= high
    return abs(answer - found.value) <= asked.tolerance * abs(found.value)


def trouble(asked: Question, answer: Any) -> str:
    """Why something is no answer to a question, in words; "" where it is one."""
    if asked.kind == TEXT:
        fits = isinstance(answer, str) and 0 < len(answer.strip()) <= LONGEST
        return "" if fits else f"write one to {LONGEST} characters"
    if asked.kind == CHOICE:
        fits = isinstance(answer, int) and not isinstance(answer, bool) and 1 <= answer <= len(asked.options)
        return "" if fits else "choose one of the answers"
    if asked.kind == INTERVAL:
        if not (isinstance(answer, (list, tuple)) and len(answer) == 2 and all(map(_is_real, answer))):
            return "give two numbers, the least and the most"
        if answer[0] > answer[1]:
            return "the first number must not be above the second"
        return "" if answer[0] > 0 else "give two numbers above 0: a bet is scored by factors, and 0 is infinitely far"
    assert asked.kind in (NUMBER, DRAG)
    return "" if _is_real(answer) else "give a number"


def shown(asked: Question, answer: Any) -> str:
    """An answer in words; what a visitor wrote stays as it is and must be escaped."""
    if asked.kind == CHOICE:
        return asked.options[answer - 1]
    if asked.kind == INTERVAL:
        return " to ".join(in_unit(asked, float(end)) for end in answer)
    return answer if asked.kind == TEXT else in_unit(asked, float(answer))


def _is_real(number: Any) -> bool:
    return isinstance(number, (int, float)) and not isinstance(number, bool) and abs(number) < MOST
